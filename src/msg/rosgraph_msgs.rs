//! The ROS package `rosgraph_msgs`.

use crate::msg::{Message, builtin_interfaces::Time};
use serde::{Deserialize, Serialize};

/// The time of a simulation or of a bag that is played.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Clock {
    /// Now.
    pub clock: Time,
}

impl Message for Clock {
    const TYPE: &'static str = "rosgraph_msgs/msg/Clock";
}
