//! The ROS package `diagnostic_msgs`.

use crate::msg::{Message, std_msgs::Header};
use serde::{Deserialize, Serialize};

/// A value with its name.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KeyValue {
    /// The name.
    pub key: String,
    /// The value as text.
    pub value: String,
}

impl Message for KeyValue {
    const TYPE: &'static str = "diagnostic_msgs/msg/KeyValue";
}

/// How one part of the robot does.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DiagnosticStatus {
    /// One of the constants.
    pub level: u8,
    /// Which part.
    pub name: String,
    /// How it does, in a sentence.
    pub message: String,
    /// Which device; may be empty.
    pub hardware_id: String,
    /// Figures.
    pub values: Vec<KeyValue>,
}

impl Message for DiagnosticStatus {
    const TYPE: &'static str = "diagnostic_msgs/msg/DiagnosticStatus";
}

/// How several parts do.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DiagnosticArray {
    /// Stamp.
    pub header: Header,
    /// The parts.
    pub status: Vec<DiagnosticStatus>,
}

impl Message for DiagnosticArray {
    const TYPE: &'static str = "diagnostic_msgs/msg/DiagnosticArray";
}

impl DiagnosticStatus {
    /// `level` when all is well.
    pub const OK: u8 = 0;
    /// `level` when something should be looked at.
    pub const WARN: u8 = 1;
    /// `level` when something does not work.
    pub const ERROR: u8 = 2;
    /// `level` when nothing has been heard.
    pub const STALE: u8 = 3;
}
