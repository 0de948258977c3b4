//! Nonlinear least squares over poses and ellipsoids: variables, noise, robust kernels and factors.
//!
//! The graph knows numbers, not objects: which factors exist is decided elsewhere. Liao et al. 2020, section V.

mod factor;
mod factors;
mod kernel;
mod noise;
mod odometry_noise;
mod variable;

pub use factor::{Factor, Linearization};
pub use factors::{
    BoxError, BoxObservation, BoxSide, EllipsoidObservation, EllipsoidPrior, PosePrior,
    RelativePose, SupportContact, Upright,
};
pub use kernel::Kernel;
pub use noise::{Noise, NoiseError};
pub use odometry_noise::{MotionModel, NotOdometry, StepSource, step_covariance};
pub use variable::{EllipsoidId, PoseId, Variable, VariableId, VariableIds};
