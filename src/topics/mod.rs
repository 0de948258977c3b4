//! Which topic is used for what: the same for bags and for the live node.

mod candidates;
mod choice;
mod error;
mod given;
mod names;
mod role;
mod roles;

pub use choice::{Choice, Passed, choose};
pub use error::RoleError;
pub use given::{Remap, given_by, given_names, given_to_node};
pub use role::Role;
pub use roles::{Assigned, Roles};

use serde::Serialize;

/// A topic of a bag, or one that somebody publishes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Topic {
    /// Name.
    pub name: String,
    /// Type, such as `sensor_msgs/msg/Image`.
    pub type_name: String,
    /// How messages are encoded; ROS 2 writes `cdr`.
    pub encoding: String,
    /// Number of messages.
    pub messages: u64,
    /// Of images, as far as it is known: the `encoding` of an `Image`, the `format` of a `CompressedImage`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub format: Option<String>,
}
