//! Memory: which measurement belongs to which object, and which factors poses and objects give the graph.

mod approach;
mod assignment;
mod association;
mod beginning;
mod company;
mod continuation;
mod displacement;
mod editing;
mod existence;
mod gate;
mod glimpsed;
mod index;
mod initial;
mod labels;
mod life;
mod looks;
mod loop_closing;
mod merging;
mod notice;
mod object;
mod objects;
mod observation;
mod odometry;
mod queries;
mod relocalisation;
mod saved;
mod slam_settings;
mod ties;
mod usual_size;
mod views;
mod visibility;
mod walls;

pub use approach::{ApproachSettings, NoApproach, Surroundings};
pub use association::Association;
pub use continuation::Continuation;
pub use editing::{BadName, Edit, EditError, NewObject, checked_name};
pub use existence::{LifeSettings, ObjectState};
pub use gate::GateSettings;
pub use labels::{LabelSettings, proper_belief};
pub use life::ObjectChange;
pub use merging::MergeError;
pub use notice::Notice;
pub use object::{MapObject, ObjectId};
pub use objects::{MappingSettings, ObjectMap, Sighted};
pub use observation::{Hints, Measured, Observation, ObservedBox, Sighting};
pub use queries::{Distance, InView, Queries, Region, footprint_of};
pub use relocalisation::{
    Constellation, ExpectedPlace, Landmark, NotRelocalised, RelocalisationSettings, Relocalised,
};
pub use saved::{SavedMap, SavedObject};
pub use slam_settings::{BoxOutline, KernelShape, SlamSettings, Weighting};
pub use visibility::View;
pub use walls::WallSighting;
