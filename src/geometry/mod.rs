//! Pure mathematics of poses, cameras, planes and ellipsoids.
//!
//! Conventions, stated once for the whole project:
//! - A rigid transform is named `a_from_b`: it takes coordinates in `b` to coordinates in `a`.
//! - Tangent vectors list rotation first, then translation: `[rad, rad, rad, m, m, m]`, and perturb on the
//!   right: `pose ⊞ d = pose * exp(d)`.
//! - A camera frame is the optical frame: x right, y down, z forward. Pixel centres have integer coordinates.
//! - Metres, seconds, radians.

mod camera;
mod ellipsoid;
mod face_evidence;
mod ground_grid;
mod outline;
mod overlap;
mod plane;
mod polygon;
mod pose;
mod rect;
mod silhouette;
mod wall;

pub use camera::{Camera, CameraError, Distortion};
pub use ellipsoid::{Ellipsoid, EllipsoidError};
pub use face_evidence::{FaceEvidence, Reach};
pub use ground_grid::GroundGrid;
pub use outline::{Outline, Support};
pub use overlap::{OrientedBox, intersection_over_union, intersection_volume};
pub use plane::Plane;
pub use polygon::{from_segment, points_around, polygon_distance, segments_cross};
pub use pose::{
    Pose, adjoint, exp, interpolate, local, log, log_derivative, pose_from_xyzw, retract,
    rotation_log_derivative, skew, yaw_of,
};
pub use rect::Rect;
pub use silhouette::{ImageSide, NEAR_M, Silhouette, Tangent};
pub use wall::Wall;
