//! Nonlinear least squares over poses, ellipsoids and walls: variables, noise, robust kernels, factors and an incremental
//! solver.
//!
//! The graph knows numbers, not objects: which factors exist is decided elsewhere. Liao et al. 2020, section V.

mod batch;
mod bayes_tree;
mod changes;
mod descent;
mod elimination;
mod factor;
mod factors;
mod front;
mod incremental;
mod kernel;
mod marginals;
mod node;
mod noise;
mod odometry_noise;
mod ordering;
mod quadratic;
mod settings;
mod slots;
mod substitution;
mod symbolic;
mod variable;

pub use batch::{SolveReport, Stop};
pub use factor::{Factor, Linearization};
pub use factors::{
    BoxError, BoxObservation, BoxSide, EllipsoidObservation, EllipsoidPrior, PosePrior,
    RelativePose, RightAngle, SizePrior, SupportContact, Upright, WallObservation,
};
pub use incremental::{FactorId, Graph, Undetermined, UpdateReport};
pub use kernel::Kernel;
pub use marginals::CovarianceRoot;
pub use noise::{Noise, NoiseError};
pub use odometry_noise::{MotionModel, NotOdometry, StepSource, step_covariance};
pub use settings::SolverSettings;
pub use variable::{Body, EllipsoidId, PoseId, Variable, VariableId, VariableIds, WallId};
