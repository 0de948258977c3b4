//! From inputs to updates: the page that reads like the paper.

mod camera_pose;
mod front_end;
mod history;
mod in_space;
mod input;
mod maps;
mod mount;
mod observations;
mod odometry;
mod placement;
mod rgbd_frame;
mod settings;
mod slam;
mod stamp_offset;
mod start_pose;
mod sync;
mod sync_3d;
mod transforms;

pub use camera_pose::{CameraPose, NoCameraPose};
pub use front_end::{FrontEnd, Perceived};
pub use in_space::{Detections3dMessage, Detections3dSettings};
pub use input::{
    CameraMessage, CameraRole, DepthMessage, DetectionsMessage, Input, OdometryMessage,
    StampedTransform,
};
pub use maps::{LOCAL_MAP, MapsToSave, SET_ASIDE_MAP};
pub use placement::Calibration;
pub use rgbd_frame::{FrameError, RgbdFrame};
pub use settings::Settings;
pub use slam::{BoxResult, FramePose, Keyframe, Keyframe3d, ObjectSlam, Update};
pub use start_pose::{NoStartPose, StartPose};
pub use sync::{Dropped, SyncSettings};
pub use transforms::MAX_FRAMES;
