//! Everything that can arrive. Replay and the live node differ only in who produces these.

use super::Detections3dMessage;
use crate::{
    geometry::{Camera, Pose},
    perception::{DepthImage, Detection, Detection3d, Mask},
    time::Stamp,
};

/// One message, already checked and converted: the core sees no wire format.
#[derive(Clone, Debug)]
pub enum Input {
    /// A depth image.
    Depth(DepthMessage),
    /// Calibration of one of the two cameras.
    Camera(CameraMessage),
    /// Where the odometry says the base is.
    Odometry(OdometryMessage),
    /// Transforms of `/tf` or `/tf_static`.
    Transforms {
        /// Whether they hold for all time.
        is_static: bool,
        /// In the order of the message.
        transforms: Vec<StampedTransform>,
    },
    /// The boxes of one image; an empty list says that the detector looked and found nothing.
    Detections(DetectionsMessage),
    /// Objects that a detector measured in space. They need no images.
    Detections3d(Detections3dMessage),
}

impl Input {
    /// About how much memory it takes (bytes).
    pub fn bytes(&self) -> usize {
        match self {
            Self::Depth(depth) => size_of_val(depth.image.metres()),
            Self::Detections(message) => {
                let of_name = |(name, _): &(String, f64)| 64 + name.len();
                let of_box = |d: &Detection| {
                    let of_mask = d.mask.as_ref().map_or(0, Mask::bytes);
                    let of_names = d.hypotheses().iter().map(of_name).sum::<usize>();
                    size_of::<Detection>() + of_mask + of_names
                };
                message.detections.iter().map(of_box).sum()
            }
            Self::Detections3d(message) => {
                let of_name = |(name, _): &(String, f64)| 64 + name.len();
                let of_box = |d: &Detection3d| {
                    let names: usize = d.hypotheses().iter().map(of_name).sum();
                    size_of::<Detection3d>() + d.frame_id.len() + names
                };
                message.detections.iter().map(of_box).sum()
            }
            Self::Transforms { transforms, .. } => {
                let names = |t: &StampedTransform| t.frame_id.len() + t.child_frame_id.len();
                transforms.iter().map(|t| size_of::<StampedTransform>() + names(t)).sum()
            }
            Self::Camera(_) | Self::Odometry(_) => size_of::<Self>(),
        }
    }
}

/// A depth image with its header.
#[derive(Clone, Debug)]
pub struct DepthMessage {
    /// When it was taken.
    pub stamp: Stamp,
    /// The optical frame it was taken in.
    pub frame_id: String,
    /// Metric depth.
    pub image: DepthImage,
}

/// Which camera a calibration belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraRole {
    /// The colour camera, in whose image the boxes are drawn.
    Color,
    /// The depth camera, where it is another one.
    Depth,
}

/// Calibration with its header.
#[derive(Clone, Debug)]
pub struct CameraMessage {
    /// Which of the two.
    pub role: CameraRole,
    /// When it was sent.
    pub stamp: Stamp,
    /// The camera's optical frame.
    pub frame_id: String,
    /// The calibration; without distortion where the images are rectified.
    pub camera: Camera,
}

/// One reading of the odometry.
#[derive(Clone, Debug)]
pub struct OdometryMessage {
    /// When it holds.
    pub stamp: Stamp,
    /// The odometry's fixed frame.
    pub frame_id: String,
    /// The base frame.
    pub child_frame_id: String,
    /// `odom_from_base`.
    pub odom_from_base: Pose,
    /// Covariance of the absolute pose as in `geometry_msgs/PoseWithCovariance`: translation then rotation about
    /// fixed axes, row-major; nothing where it was not filled in.
    pub covariance: Option<Box<[f64; 36]>>,
}

/// `parent_from_child` at a time.
#[derive(Clone, Debug)]
pub struct StampedTransform {
    /// When it holds.
    pub stamp: Stamp,
    /// Parent frame.
    pub frame_id: String,
    /// Child frame.
    pub child_frame_id: String,
    /// `parent_from_child`.
    pub parent_from_child: Pose,
}

/// The boxes of one image.
#[derive(Clone, Debug)]
pub struct DetectionsMessage {
    /// Stamp of the image they were found in.
    pub stamp: Stamp,
    /// Frame of the image they were found in; may be empty.
    pub frame_id: String,
    /// The boxes.
    pub detections: Vec<Detection>,
}
