//! One RGB-D frame, no memory: from depth and a box to an ellipsoid with covariance, or the reason why not.
//!
//! Liao et al. 2020, section IV.

mod depth;
mod detection;

pub use depth::{DepthError, DepthImage};
pub use detection::{Detection, DetectionError};
