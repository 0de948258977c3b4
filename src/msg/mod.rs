//! Wire types of ROS 2, a file a package, and the only conversions between them and the core.
//!
//! The structs mirror the `.msg` files of Humble and later field by field; `convert` turns them into the core's
//! types, which cannot be wrong, and back.

pub mod builtin_interfaces;
pub mod diagnostic_msgs;
pub mod ellipsoid_slam;
pub mod foxglove_msgs;
pub mod geometry_msgs;
pub mod lifecycle_msgs;
pub mod nav_msgs;
pub mod rosgraph_msgs;
pub mod rtabmap_msgs;
pub mod sensor_msgs;
pub mod std_msgs;
pub mod std_srvs;
pub mod tf2_msgs;
pub mod vision_msgs;
pub mod visualization_msgs;
pub mod yolo_msgs;

pub mod cdr;
pub mod coco;
pub mod convert;
mod schema;
mod skipped;
#[cfg(feature = "zenoh")]
pub mod type_hash;

pub use schema::schema_text;
pub use skipped::{SkipCount, Skipped};

use serde::{Serialize, de::DeserializeOwned};

/// A ROS 2 message type.
pub trait Message: Serialize + DeserializeOwned {
    /// The type's name, `package/msg/Name`.
    const TYPE: &'static str;
}

/// A ROS 2 service type.
pub trait Service: 'static {
    /// The type's name, `package/srv/Name`.
    const TYPE: &'static str;
    /// What a client sends.
    type Request: Serialize + DeserializeOwned + Clone;
    /// What it gets back.
    type Response: Serialize + DeserializeOwned;
}
