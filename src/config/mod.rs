//! Settings as text: ROS 2 parameter files in, commented ones out.
//!
//! Defaults live in the settings' own types; this layer knows the range and the meaning of each key.

mod keys;
mod node;
mod text;

pub use keys::{KEYS, Key};
pub use node::{DetectionsType, InputQos, NodeSettings, Qos};
pub use text::{ConfigError, settings_from_yaml, settings_to_yaml};
