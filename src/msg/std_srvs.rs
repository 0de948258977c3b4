//! The ROS package `std_srvs`, as far as it is used here.

use crate::msg::Service;
use serde::{Deserialize, Serialize};

/// Does something that needs no more words.
#[derive(Clone, Copy, Debug)]
pub struct Trigger;

/// Nothing. The generators of ROS 2 give a type without fields one byte, because IDL knows no empty structures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TriggerRequest {
    /// Always zero.
    pub structure_needs_at_least_one_member: u8,
}

/// What came of it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TriggerResponse {
    /// Whether it was done.
    pub success: bool,
    /// What was done, or why not.
    pub message: String,
}

impl Service for Trigger {
    const TYPE: &'static str = "std_srvs/srv/Trigger";
    type Request = TriggerRequest;
    type Response = TriggerResponse;
}

/// Switches something on or off.
#[derive(Clone, Copy, Debug)]
pub struct SetBool;

/// On or off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SetBoolRequest {
    /// On.
    pub data: bool,
}

/// What came of it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SetBoolResponse {
    /// Whether it was done.
    pub success: bool,
    /// What was done, or why not.
    pub message: String,
}

impl Service for SetBool {
    const TYPE: &'static str = "std_srvs/srv/SetBool";
    type Request = SetBoolRequest;
    type Response = SetBoolResponse;
}
