//! All settings of the method.

use super::{Detections3dSettings, SyncSettings};
use crate::{
    mapping::{MappingSettings, RelocalisationSettings, SlamSettings},
    perception::{DepthNoise, PerceptionSettings},
};
use serde::{Deserialize, Serialize};

/// All settings of the method, a section a part.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Pairing of messages.
    pub sync: SyncSettings,
    /// The depth sensor.
    pub depth_noise: DepthNoise,
    /// A detector that measures in space.
    pub detections_3d: Detections3dSettings,
    /// Single-frame estimation.
    pub perception: PerceptionSettings,
    /// Association.
    pub mapping: MappingSettings,
    /// The graph of poses and objects.
    pub slam: SlamSettings,
    /// Recognising a place by its objects.
    pub relocalisation: RelocalisationSettings,
}
