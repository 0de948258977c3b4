//! Files: bags in and out, and files that are either whole or not there.

mod atomic;
#[cfg(feature = "bags")]
mod bag_file;
#[cfg(feature = "bags")]
mod bag_folder;
#[cfg(feature = "bags")]
mod bag_input;
#[cfg(feature = "bags")]
mod bag_reader;
#[cfg(feature = "bags")]
mod bag_writer;
#[cfg(feature = "bags")]
mod decode;
mod error;
#[cfg(feature = "bags")]
mod export;
#[cfg(feature = "bags")]
mod found_boxes;
#[cfg(feature = "bags")]
mod inspect;
mod map_file;
#[cfg(feature = "bags")]
mod mcap_file;
#[cfg(feature = "bags")]
mod mcap_scan;
#[cfg(feature = "bags")]
mod scratch_file;
#[cfg(feature = "bags")]
mod sqlite_file;
mod trajectory;
#[cfg(feature = "bags")]
mod tum_camera;
#[cfg(feature = "bags")]
mod tum_folder;
#[cfg(feature = "bags")]
mod unpacked;

pub use atomic::{remove_unfinished, write_atomically, write_atomically_with};
#[cfg(feature = "bags")]
pub use bag_input::{BagInput, InputError, Inputs};
#[cfg(feature = "bags")]
pub use bag_reader::{BagReader, Messages, RawMessage};
#[cfg(feature = "bags")]
pub use bag_writer::BagWriter;
#[cfg(feature = "bags")]
pub use decode::{Decoder, color_message, decode_color};
pub use error::{BagError, BagWarning, Damage, disk_problem};
#[cfg(feature = "bags")]
pub use export::{MapFormat, export_map};
#[cfg(feature = "bags")]
pub use found_boxes::FoundBoxes;
#[cfg(feature = "bags")]
pub use inspect::{
    BagReport, Coverage, FrameLink, Frames, Matching, NO_ODOMETRY, Rhythm, Stream, inspect,
};
pub use map_file::{MapFileError, load_saved_map, map_json, read_map, save_map, save_maps};
pub use trajectory::{TrajectoryError, read_trajectory, trajectory_text};
#[cfg(feature = "bags")]
pub use tum_camera::TumCamera;
#[cfg(feature = "bags")]
pub use tum_folder::{TumError, TumFolder, TumFrame, TumOptions};
