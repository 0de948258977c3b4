//! Settings as text: ROS 2 parameter files in, commented ones out.
//!
//! Defaults live in the settings' own types; this layer knows the range and the meaning of each key,
//! and what ROS 2 says on a command line.

mod arguments;
mod detector_settings;
mod ground_settings;
mod keys;
mod node_keys;
mod node_settings;
mod parameters;
mod reference;
mod text;
mod together;
mod values;

pub use arguments::{ArgumentError, LogLevel, RosArguments};
pub use detector_settings::{DetectorSettings, ModelForm};
pub use ground_settings::GroundSettings;
pub use keys::{Key, keys};
pub use node_settings::{
    AUTO, DepthTransport, DetectionsType, LifecycleSettings, MapFileSettings, NodeSettings,
    PublishSettings, Qos, QosSettings, RgbTransport, TopicSettings,
};
pub use parameters::{Parameter, Parameters, key_of};
pub use reference::reference;
pub use text::{ConfigError, parameters_from_yaml, parameters_to_yaml, sections_of};
