//! The ROS package `builtin_interfaces`.

use crate::msg::Message;
use serde::{Deserialize, Serialize};

/// A point in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Time {
    /// Whole seconds.
    pub sec: i32,
    /// The rest in nanoseconds, below 10^9.
    pub nanosec: u32,
}

impl Message for Time {
    const TYPE: &'static str = "builtin_interfaces/msg/Time";
}

/// A span of time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Duration {
    /// Whole seconds.
    pub sec: i32,
    /// The rest in nanoseconds, below 10^9.
    pub nanosec: u32,
}

impl Message for Duration {
    const TYPE: &'static str = "builtin_interfaces/msg/Duration";
}
