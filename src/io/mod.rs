//! Files: bags in and out, and files that are either whole or not there.

mod atomic;
mod bag_file;
mod bag_folder;
mod bag_input;
mod bag_reader;
mod bag_writer;
mod decode;
mod error;
mod export;
mod found_boxes;
mod inspect;
mod map_file;
mod mcap_file;
mod mcap_scan;
mod sqlite_file;
mod trajectory;
mod tum_camera;
mod tum_folder;
mod unpacked;

pub use atomic::{remove_unfinished, write_atomically, write_atomically_with};
pub use bag_input::{BagInput, InputError, Inputs};
pub use bag_reader::{BagReader, Messages, RawMessage};
pub use bag_writer::BagWriter;
pub use decode::{Decoder, color_message, decode_color};
pub use error::{BagError, BagWarning, Damage, disk_problem};
pub use export::{MapFormat, export_map};
pub use found_boxes::FoundBoxes;
pub use inspect::{
    BagReport, Coverage, FrameLink, Frames, Matching, NO_ODOMETRY, Rhythm, Stream, inspect,
};
pub use map_file::{MapFileError, load_saved_map, map_json, read_map, save_map, save_maps};
pub use trajectory::{TrajectoryError, read_trajectory, trajectory_text};
pub use tum_camera::TumCamera;
pub use tum_folder::{TumError, TumFolder, TumFrame, TumOptions};
