//! The ROS package `rtabmap_msgs`, as far as RTAB-Map takes landmarks from others.

use crate::msg::{Message, geometry_msgs::PoseWithCovariance, std_msgs::Header};
use serde::{Deserialize, Serialize};

/// A landmark as it was seen.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LandmarkDetection {
    /// Stamp of the image, and the frame of the pose.
    pub header: Header,
    /// Name of the landmark's frame.
    pub landmark_frame_id: String,
    /// Identity; above zero.
    pub id: i32,
    /// Side of a tag (m); zero if it is none.
    pub size: f32,
    /// Where it was seen. A covariance of zeros is unknown.
    pub pose: PoseWithCovariance,
}

impl Message for LandmarkDetection {
    const TYPE: &'static str = "rtabmap_msgs/msg/LandmarkDetection";
}

/// The landmarks seen in one image.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LandmarkDetections {
    /// Stamp and frame of the image.
    pub header: Header,
    /// The landmarks.
    pub landmarks: Vec<LandmarkDetection>,
}

impl Message for LandmarkDetections {
    const TYPE: &'static str = "rtabmap_msgs/msg/LandmarkDetections";
}
