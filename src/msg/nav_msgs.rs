//! The ROS package `nav_msgs`.

use crate::msg::{
    Message,
    geometry_msgs::{PoseStamped, PoseWithCovariance, TwistWithCovariance},
    std_msgs::Header,
};
use serde::{Deserialize, Serialize};

/// Where the base is in the odometry's frame, and how fast it moves.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Odometry {
    /// Stamp and frame.
    pub header: Header,
    /// The child frame.
    pub child_frame_id: String,
    /// The pose.
    pub pose: PoseWithCovariance,
    /// The velocity, in the child frame.
    pub twist: TwistWithCovariance,
}

impl Message for Odometry {
    const TYPE: &'static str = "nav_msgs/msg/Odometry";
}

/// A sequence of poses.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Path {
    /// Stamp and frame.
    pub header: Header,
    /// In order of time.
    pub poses: Vec<PoseStamped>,
}

impl Message for Path {
    const TYPE: &'static str = "nav_msgs/msg/Path";
}
