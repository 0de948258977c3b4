//! The terms of the cost, a file each.

mod prior;
mod relative_pose;

pub use prior::{EllipsoidPrior, PosePrior};
pub use relative_pose::RelativePose;
