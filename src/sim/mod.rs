//! Simulated RGB-D sequences with exact ground truth.

mod desk_scene;
mod desk_things;
mod mesh;
mod random;
mod render;
mod scene;
mod settings;

pub use mesh::{Color, Mesh};
pub use render::{Rendered, Renderer};
pub use scene::{Scene, SceneObject};
pub use settings::{
    CameraSettings, DepthSettings, DetectorSettings, MountSettings, OdometrySettings, SceneKind,
    SettingsError, SimulationSettings, TrajectoryKind,
};
