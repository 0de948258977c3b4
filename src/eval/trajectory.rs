//! A trajectory against the true one, with the same numbers as evo (Grupp 2017).

use crate::{geometry::Pose, time::Stamp};
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use serde::Serialize;
use thiserror::Error;

/// Poses with stamps farther apart than this do not belong together (s).
pub const MAX_STAMP_DISTANCE_S: f64 = 0.02;

/// Statistics of an error over a trajectory.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Statistics {
    /// Root of the mean square.
    pub rmse: f64,
    /// Mean.
    pub mean: f64,
    /// Median; the mean of the two in the middle of an even number.
    pub median: f64,
    /// Largest.
    pub max: f64,
}

/// How good a trajectory is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TrajectoryScores {
    /// Pairs of poses.
    pub poses: usize,
    /// Distance between positions as they are (m).
    pub ate_m: Statistics,
    /// Distance between positions after the best rigid alignment (m).
    pub aligned_ate_m: Statistics,
    /// Distance between the steps from one pose to the next (m).
    pub rpe_m: Statistics,
    /// Angle between the steps from one pose to the next (deg).
    pub rpe_deg: Statistics,
}

/// Why a trajectory cannot be compared.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum TrajectoryError {
    /// The stamps do not fit.
    #[error(
        "only {matched} of {poses} poses have a true one within 20 ms; at least 2 are needed: \
         do both trajectories have the same clock?"
    )]
    TooFewPairs {
        /// Pairs.
        matched: usize,
        /// Poses of the trajectory under test.
        poses: usize,
    },
}

/// Compares poses `map_from_base` with the true ones, both in the order of their stamps.
///
/// # Errors
/// When fewer than two poses have a true one.
pub fn evaluate_trajectory(
    estimate: &[(Stamp, Pose)],
    truth: &[(Stamp, Pose)],
) -> Result<TrajectoryScores, TrajectoryError> {
    let pairs = paired(estimate, truth);
    if pairs.len() < 2 {
        let (matched, poses) = (pairs.len(), estimate.len());
        return Err(TrajectoryError::TooFewPairs { matched, poses });
    }
    let truth_from_map = aligned(&pairs);
    let distances = |correction: &Pose| {
        let between = pairs.iter().map(|(estimate, truth)| {
            (correction * estimate).translation.vector - truth.translation.vector
        });
        Statistics::of(between.map(|d| d.norm()).collect())
    };
    let steps = pairs.windows(2).map(|pair| {
        let [(from, true_from), (to, true_to)] = [pair[0], pair[1]];
        (true_from.inverse() * true_to).inverse() * (from.inverse() * to)
    });
    let steps: Vec<Pose> = steps.collect();
    Ok(TrajectoryScores {
        poses: pairs.len(),
        ate_m: distances(&Pose::identity()),
        aligned_ate_m: distances(&truth_from_map),
        rpe_m: Statistics::of(steps.iter().map(|s| s.translation.vector.norm()).collect()),
        rpe_deg: Statistics::of(steps.iter().map(|s| s.rotation.angle().to_degrees()).collect()),
    })
}

/// Each estimated pose with the true one of the nearest stamp, if that is near enough.
fn paired(estimate: &[(Stamp, Pose)], truth: &[(Stamp, Pose)]) -> Vec<(Pose, Pose)> {
    let nearest = |stamp: Stamp| {
        let after = truth.partition_point(|(at, _)| *at < stamp);
        let around = &truth[after.saturating_sub(1)..(after + 1).min(truth.len())];
        let distance = |at: Stamp| at.seconds_since(stamp).abs();
        let (at, pose) = around.iter().min_by(|a, b| distance(a.0).total_cmp(&distance(b.0)))?;
        (distance(*at) <= MAX_STAMP_DISTANCE_S).then_some(*pose)
    };
    estimate.iter().filter_map(|(stamp, pose)| Some((*pose, nearest(*stamp)?))).collect()
}

/// The rigid transform that takes the first positions of the pairs nearest to the second ones.
///
/// Umeyama 1991, without scale; where positions lie on a line, any of the best transforms.
pub fn aligned(pairs: &[(Pose, Pose)]) -> Pose {
    let count = pairs.len().max(1) as f64;
    let center =
        |of: fn(&(Pose, Pose)) -> Vector3<f64>| pairs.iter().map(of).sum::<Vector3<f64>>() / count;
    let from_center = center(|pair| pair.0.translation.vector);
    let to_center = center(|pair| pair.1.translation.vector);
    let covariance: Matrix3<f64> = pairs
        .iter()
        .map(|(from, to)| {
            (to.translation.vector - to_center)
                * (from.translation.vector - from_center).transpose()
        })
        .sum();
    let svd = covariance.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else { return Pose::identity() };
    let mut signs = Vector3::repeat(1.0);
    // A reflection may fit better still; the direction of the smallest singular value pays for a rotation.
    signs[svd.singular_values.imin()] = (u.determinant() * v_t.determinant()).signum();
    let rotation = Rotation3::from_matrix_unchecked(u * Matrix3::from_diagonal(&signs) * v_t);
    let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
    Isometry3::from_parts(Translation3::from(to_center - rotation * from_center), rotation)
}

impl Statistics {
    /// Of at least one value.
    fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let count = values.len();
        let mean = |value: fn(&f64) -> f64| values.iter().map(value).sum::<f64>() / count as f64;
        Self {
            rmse: mean(|v| v * v).sqrt(),
            mean: mean(|v| *v),
            median: 0.5 * (values[(count - 1) / 2] + values[count / 2]),
            max: values[count - 1],
        }
    }
}
