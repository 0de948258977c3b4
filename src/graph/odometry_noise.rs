//! How sure odometry is of the step between two poses.

use crate::geometry::{Pose, adjoint};
use nalgebra::{Cholesky, Matrix6, Vector6};
use serde::{Deserialize, Serialize};

/// How the uncertainty of a step grows with the way it goes, for robots that drive on a floor.
///
/// It is the covariance where odometry's own is missing or cannot be right, and the yardstick for that.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MotionModel {
    /// Standard deviation along and across the way for every metre (m/m).
    pub position_m_per_m: f64,
    /// The same for every radian turned (m/rad).
    pub position_m_per_rad: f64,
    /// Standard deviation of the heading for every metre (rad/m).
    pub heading_rad_per_m: f64,
    /// The same for every radian turned (rad/rad).
    pub heading_rad_per_rad: f64,
    /// No step is known better than this (m): also the standard deviation of the height.
    pub floor_m: f64,
    /// No step is known better than this (deg): also the standard deviation of roll and pitch.
    pub floor_deg: f64,
    /// Odometry's own standard deviations may be so many times larger or smaller than the model's.
    pub credible_factor: f64,
}

impl Default for MotionModel {
    fn default() -> Self {
        Self {
            position_m_per_m: 0.03,
            position_m_per_rad: 0.01,
            heading_rad_per_m: 0.02,
            heading_rad_per_rad: 0.03,
            floor_m: 0.001,
            floor_deg: 0.1,
            credible_factor: 10.0,
        }
    }
}

/// Where the covariance of a step comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepSource {
    /// From odometry's own covariances.
    Odometry,
    /// From the motion model.
    Model(NotOdometry),
}

/// Why odometry's own covariances are not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotOdometry {
    /// One is missing or all zeros.
    NotFilledIn,
    /// An element is infinite or not a number.
    NotFinite,
    /// The later pose is not as uncertain as the earlier one makes it: they are no sum of independent steps.
    NotASum,
    /// Much smaller than the model's.
    TooSmall,
    /// Much larger than the model's.
    TooLarge,
}

impl NotOdometry {
    /// A short key for counting.
    pub fn reason(&self) -> &'static str {
        match self {
            Self::NotFilledIn => "not_filled_in",
            Self::NotFinite => "not_finite",
            Self::NotASum => "not_a_sum",
            Self::TooSmall => "too_small",
            Self::TooLarge => "too_large",
        }
    }
}

/// The covariance of the step from one pose of odometry to another: of `[rotation, translation]`, a right
/// perturbation of `from^-1 to`.
///
/// A pose comes with the covariance of `geometry_msgs/PoseWithCovariance`: of the absolute pose, translation then
/// rotation, about fixed axes, row-major. If errors of steps are independent and `S` are covariances in our tangent,
/// then `S_to = Ad S_from Ad^T + S_step` with `Ad` the adjoint of `to_from_from`; this is solved for the step. The
/// floors of the model are added in any case.
pub fn step_covariance(
    from: (&Pose, Option<&[f64; 36]>),
    to: (&Pose, Option<&[f64; 36]>),
    model: &MotionModel,
) -> (Matrix6<f64>, StepSource) {
    let step = from.0.inv_mul(to.0);
    let derived = match (from.1, to.1) {
        (Some(before), Some(after)) => derived((from.0, before), (to.0, after), model),
        _ => Err(NotOdometry::NotFilledIn),
    };
    match derived {
        Ok(covariance) => (covariance, StepSource::Odometry),
        Err(why) => (Matrix6::from_diagonal(&model.variances(&step)), StepSource::Model(why)),
    }
}

fn derived(
    from: (&Pose, &[f64; 36]),
    to: (&Pose, &[f64; 36]),
    model: &MotionModel,
) -> Result<Matrix6<f64>, NotOdometry> {
    let all = || from.1.iter().chain(to.1);
    if !all().all(|v| v.is_finite()) {
        return Err(NotOdometry::NotFinite);
    }
    // At its start, odometry may rightly claim to know where it is: the later pose decides.
    if to.1.iter().all(|v| *v == 0.0) {
        return Err(NotOdometry::NotFilledIn);
    }
    let step = from.0.inv_mul(to.0);
    let moved = adjoint(&step.inverse());
    let before = in_own_tangent(from.0, from.1);
    let grown = in_own_tangent(to.0, to.1) - moved * before * moved.transpose();
    let covariance = grown + Matrix6::from_diagonal(&model.floors());
    // Rounding alone makes the difference of two large covariances indefinite: floors are there for that.
    if Cholesky::new(covariance).is_none() {
        return Err(NotOdometry::NotASum);
    }
    model.check(&grown.diagonal(), &step)?;
    Ok(covariance)
}

/// From ROS's order and fixed axes to ours.
fn in_own_tangent(pose: &Pose, ros: &[f64; 36]) -> Matrix6<f64> {
    let own_from_fixed = pose.rotation.inverse().to_rotation_matrix().into_inner();
    let mut change = Matrix6::zeros();
    change.fixed_view_mut::<3, 3>(0, 3).copy_from(&own_from_fixed);
    change.fixed_view_mut::<3, 3>(3, 0).copy_from(&own_from_fixed);
    let covariance = Matrix6::from_row_slice(ros);
    change * (covariance + covariance.transpose()) * 0.5 * change.transpose()
}

impl MotionModel {
    fn floors(&self) -> Vector6<f64> {
        let (turn, shift) = (self.floor_deg.to_radians().powi(2), self.floor_m.powi(2));
        Vector6::new(turn, turn, turn, shift, shift, shift)
    }

    /// Variances of heading (rad^2) and position (m^2) that a step adds to the floors.
    fn planar(&self, step: &Pose) -> (f64, f64) {
        let (way, turn) = (step.translation.vector.norm(), step.rotation.angle());
        let heading = (self.heading_rad_per_m * way).hypot(self.heading_rad_per_rad * turn);
        let position = (self.position_m_per_m * way).hypot(self.position_m_per_rad * turn);
        (heading.powi(2), position.powi(2))
    }

    fn variances(&self, step: &Pose) -> Vector6<f64> {
        let (heading, position) = self.planar(step);
        self.floors() + Vector6::new(0.0, 0.0, heading, position, position, 0.0)
    }

    /// Whether variances of a step, floors not among them, are credible: a covariance that never changes grows by nothing. Roll, pitch and height may be better known than what is in the
    /// plane, and on a robot that does not drive they are as uncertain.
    fn check(&self, variances: &Vector6<f64>, step: &Pose) -> Result<(), NotOdometry> {
        let (heading, position) = self.planar(step);
        let most =
            self.floors() + Vector6::new(heading, heading, heading, position, position, position);
        let factor = self.credible_factor.powi(2);
        if (0..6).any(|i| variances[i] > factor * most[i]) {
            return Err(NotOdometry::TooLarge);
        }
        let least = [(2, heading), (3, position), (4, position)];
        if least.into_iter().any(|(i, usual)| variances[i] < usual / factor) {
            return Err(NotOdometry::TooSmall);
        }
        Ok(())
    }
}
