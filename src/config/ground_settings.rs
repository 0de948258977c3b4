//! Settings of what follows from the map for a robot that drives on the floor.

use serde::{Deserialize, Serialize};

/// What stands in a robot's way, for the costmap and for places before objects.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GroundSettings {
    /// Size of the costmap's cells (m); those of maps of more than a million cells are larger.
    pub cell_m: f64,
    /// How far objects are wider in the costmap than they are (m).
    pub inflation_m: f64,
    /// The robot passes under objects whose lower side is higher above the floor (m).
    pub robot_height_m: f64,
    /// Of the circle that is kept free of objects and walls where a robot is sent (m).
    pub robot_radius_m: f64,
    /// From an object's footprint to where a robot is sent (m).
    pub approach_distance_m: f64,
}

impl Default for GroundSettings {
    fn default() -> Self {
        Self {
            cell_m: 0.05,
            inflation_m: 0.0,
            robot_height_m: 1.5,
            robot_radius_m: 0.25,
            approach_distance_m: 0.6,
        }
    }
}
