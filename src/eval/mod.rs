//! How good a map and a trajectory are, measured against the truth.
//!
//! Pure: texts and values in, numbers out; whoever has files reads them.

mod ground_truth;

pub use ground_truth::{GroundTruth, GroundTruthError, TrueObject};
