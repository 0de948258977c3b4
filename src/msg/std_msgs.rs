//! The ROS package `std_msgs`.

use crate::msg::{Message, builtin_interfaces::Time};
use serde::{Deserialize, Serialize};

/// Stamp and frame of the data that follows.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// When the data holds.
    pub stamp: Time,
    /// The frame the data is given in.
    pub frame_id: String,
}

impl Message for Header {
    const TYPE: &'static str = "std_msgs/msg/Header";
}

/// A colour; each part from 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ColorRGBA {
    /// Red.
    pub r: f32,
    /// Green.
    pub g: f32,
    /// Blue.
    pub b: f32,
    /// Opacity.
    pub a: f32,
}

impl Message for ColorRGBA {
    const TYPE: &'static str = "std_msgs/msg/ColorRGBA";
}
