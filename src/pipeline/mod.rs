//! From inputs to updates: the page that reads like the paper.

mod input;

pub use input::{
    CameraMessage, CameraRole, DepthMessage, DetectionsMessage, Input, OdometryMessage,
    StampedTransform,
};
