//! The ROS package `tf2_msgs`.

use crate::msg::{Message, geometry_msgs::TransformStamped};
use serde::{Deserialize, Serialize};

/// Transforms of `/tf` and `/tf_static`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TFMessage {
    /// The transforms.
    pub transforms: Vec<TransformStamped>,
}

impl Message for TFMessage {
    const TYPE: &'static str = "tf2_msgs/msg/TFMessage";
}
