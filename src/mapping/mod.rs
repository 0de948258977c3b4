//! Memory: which measurement belongs to which object, and which factors poses and objects give the graph.

mod association;
mod continuation;
mod initial;
mod merging;
mod object;
mod objects;
mod observation;
mod odometry;
mod queries;
mod relocalisation;
mod saved;
mod slam_settings;
mod views;

pub use association::{Association, GateSettings};
pub use continuation::Continuation;
pub use merging::MergeError;
pub use object::{MapObject, ObjectId};
pub use objects::{MappingSettings, ObjectMap, Sighted};
pub use observation::{Measured, Observation, ObservedBox, Sighting};
pub use queries::{Distance, InView, Region};
pub use relocalisation::{
    Constellation, ExpectedPlace, Landmark, NotRelocalised, RelocalisationSettings, Relocalised,
};
pub use saved::{SavedMap, SavedObject};
pub use slam_settings::{BoxOutline, KernelShape, SlamSettings, Weighting};
