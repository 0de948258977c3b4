//! How good a map and a trajectory are, measured against the truth.
//!
//! Pure: texts and values in, numbers out; whoever has files reads them. Every measure of an object is the same
//! however its axes are named.

mod axes;
mod calibration;
mod ground_truth;
mod id_switches;
mod interval;
mod matching;
mod object_error;
mod objects;
mod trajectory;

pub use calibration::{Calibration, NormalisedError, pose_error};
pub use ground_truth::{GroundTruth, GroundTruthError, TrueObject};
pub use id_switches::IdSwitches;
pub use interval::Interval;
pub use matching::{MATCH_DISTANCE_M, assignment};
pub use object_error::{ObjectError, ROUND_FOOTPRINT, rotation_error_deg, shape_error};
pub use objects::{
    EstimatedObject, FalseObject, MIN_OBSERVATIONS, Match, MissedObject, ObjectScores, evaluate,
    evaluate_identified,
};
pub use trajectory::{
    MAX_STAMP_DISTANCE_S, Statistics, TrajectoryError, TrajectoryScores, aligned,
    evaluate_trajectory,
};
