//! Memory: which measurement belongs to which object, and what all of them say together.

mod association;
mod fusion;
mod object;
mod objects;

pub use association::{Association, GateSettings};
pub use fusion::FusionSettings;
pub use object::{MapObject, ObjectId};
pub use objects::{MappingSettings, ObjectMap, Observation};
