//! The terms of the cost, a file each.

mod box_observation;
mod ellipsoid_observation;
mod prior;
mod relative_pose;
mod right_angle;
mod size_prior;
mod support_contact;
mod upright;
mod wall_observation;

pub use box_observation::{BoxError, BoxObservation, BoxSide};
pub use ellipsoid_observation::EllipsoidObservation;
pub use prior::{EllipsoidPrior, PosePrior};
pub use relative_pose::RelativePose;
pub use right_angle::RightAngle;
pub use size_prior::SizePrior;
pub use support_contact::SupportContact;
pub use upright::Upright;
pub use wall_observation::WallObservation;
