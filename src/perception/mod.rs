//! One RGB-D frame, no memory: from depth and a box to an ellipsoid with covariance, or the reason why not.
//!
//! Liao et al. 2020, section IV. [`estimate_frame`] is the page that reads like the paper.

mod background;
mod beyond;
mod bounds;
mod claims;
mod classes;
mod clustering;
mod crop;
mod depth;
mod detection;
mod detection_3d;
mod edges;
mod end;
mod estimator;
mod faces;
mod fit;
mod floor;
mod footprint;
mod frame;
mod glimpse;
mod guess;
mod mask;
mod masks;
mod measurement;
mod normal;
mod readings;
mod registration;
mod room;
mod segmentation;
mod side;
mod silhouette;
mod stage;
mod support;
mod symmetry;
mod top;
mod unseen;
mod walls;

pub use classes::{ClassPrior, Classes};
pub use depth::{DepthError, DepthImage};
pub use detection::{Detection, DetectionError};
pub use detection_3d::Detection3d;
pub use estimator::{FitModel, FrameEstimate, PerceptionSettings, estimate_frame};
pub use fit::{FitReport, fit_ellipsoid, fit_probability, residual, retract_upright};
pub use floor::{Floor, find_floor};
pub use frame::{DepthNoise, Frame, Rays, Sight};
pub use glimpse::{Glimpse, UsualSize};
pub use mask::{Mask, MaskError};
pub use measurement::{EllipsoidMeasurement, Probability, Refused};
pub use registration::register_depth;
pub use segmentation::SegmentationSettings;
pub use side::Side;
pub use stage::{Stage, StageObserver};
pub use support::{SupportPlane, SupportSettings, find_support_planes};
pub use symmetry::{SymmetryPlane, SymmetryType};
pub use walls::{WallSegment, WallSettings, find_walls};
