//! Simulated RGB-D sequences with exact ground truth: what real recordings cannot give.
//!
//! A [`Scene`] is drawn from a seed, a trajectory leads through it, and for every frame rays are cast at its
//! triangles. Sensor, detector and odometry then spoil the truth by as much as [`SimulationSettings`] say.
//! Nothing here writes files: whoever wants to keep [`Simulation::frames`] streams them.

mod crowded_scene;
mod desk_scene;
mod desk_things;
mod detector;
mod home_scene;
mod home_things;
mod mesh;
mod odometry;
mod office_scene;
mod presets;
mod random;
mod render;
mod scene;
mod sensor;
mod settings;
mod simulation;
mod trajectory;

pub use detector::{SimulatedDetection, Visible, visible_parts};
pub use mesh::{Color, Mesh};
pub use odometry::OdometryReading;
pub use presets::{DetectorKind, RobotKind, SensorKind};
pub use render::{Rendered, Renderer};
pub use scene::{Scene, SceneObject};
pub use settings::{
    CameraSettings, DepthSettings, DetectorSettings, MountSettings, OdometrySettings, SceneKind,
    SettingsError, SimulationSettings, TrajectoryKind,
};
pub use simulation::{GroundTruth, SimulatedFrame, Simulation, SimulationError, TrueObject};
