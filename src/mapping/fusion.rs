//! Fusion of the measurements of one object by their information.
//!
//! The state is linear in what is measured: heading, centre and semi-axes. So a face that one view could only guess
//! moves centre and size together when another view sees it.

use crate::geometry::{Ellipsoid, Pose, yaw_of};
use nalgebra::{Cholesky, SMatrix, SVector, Translation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// How measurements are fused.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FusionSettings {
    /// Mahalanobis distance from which a measurement loses weight (Huber).
    pub huber: f64,
    /// Errors of similar views are correlated: no position is known better than this (m), however many views.
    pub min_position_sigma_m: f64,
    /// The same for semi-axes (m).
    pub min_size_sigma_m: f64,
    /// The same for the heading (deg).
    pub min_heading_sigma_deg: f64,
}

impl Default for FusionSettings {
    fn default() -> Self {
        Self {
            huber: 3.0,
            min_position_sigma_m: 0.005,
            min_size_sigma_m: 0.005,
            min_heading_sigma_deg: 0.5,
        }
    }
}

/// Heading (rad), centre in the object's frame (m), semi-axes (m).
type State = SVector<f64, 7>;
type StateCovariance = SMatrix<f64, 7, 7>;

/// An upright ellipsoid with its covariance.
#[derive(Clone, Debug)]
pub(super) struct Estimate {
    ellipsoid: Ellipsoid,
    /// Of heading, centre in the object's frame and semi-axes.
    covariance: StateCovariance,
    /// Of roll and pitch (rad^2), which are not estimated.
    tilt_variance: f64,
}

impl Estimate {
    /// From a first measurement in the map frame with its covariance of `[rotation, translation, log semi-axes]`.
    pub(super) fn new(measured: &Ellipsoid, covariance: &SMatrix<f64, 9, 9>) -> Self {
        Self {
            ellipsoid: upright(measured),
            covariance: linear_covariance(covariance, &measured.semi_axes),
            tilt_variance: covariance[(0, 0)],
        }
    }

    pub(super) fn ellipsoid(&self) -> Ellipsoid {
        self.ellipsoid
    }

    /// Covariance of `[rotation, translation, log semi-axes]` with the axes renamed by `quarters` quarter turns.
    pub(super) fn covariance(&self, quarters: i64) -> SMatrix<f64, 9, 9> {
        let swapped = quarters % 2 != 0;
        let s = self.ellipsoid.semi_axes;
        // Row i of the result is `sign * scale` times row `from` of the state.
        let (x, y, sign) = if swapped { (1, 0, -1.0) } else { (0, 1, 1.0) };
        let rows = [
            (2, 0, 1.0),
            (3, 1 + x, 1.0),
            (4, 1 + y, sign),
            (5, 3, 1.0),
            (6, 4 + x, 1.0 / s[x]),
            (7, 4 + y, 1.0 / s[y]),
            (8, 6, 1.0 / s.z),
        ];
        let mut out = SMatrix::<f64, 9, 9>::zeros();
        out[(0, 0)] = self.tilt_variance;
        out[(1, 1)] = self.tilt_variance;
        for (i, from_i, scale_i) in rows {
            for (j, from_j, scale_j) in rows {
                out[(i, j)] = self.covariance[(from_i, from_j)] * scale_i * scale_j;
            }
        }
        out
    }

    /// Joins a measurement in the map frame (Kalman 1960). Whatever its axes are called, the names nearest to the
    /// estimate's are used.
    pub(super) fn update(
        &mut self,
        measured: &Ellipsoid,
        covariance: &SMatrix<f64, 9, 9>,
        settings: &FusionSettings,
    ) {
        let quarters = measured.quarters_towards(yaw_of(&self.ellipsoid.pose));
        let renamed = upright(measured).quarter_turned(quarters);
        let innovation = difference(&self.ellipsoid, &renamed);
        let noise = turned(&linear_covariance(covariance, &measured.semi_axes), quarters);
        let noise = seen_along(innovation[0], &noise);
        let Some(factor) = Cholesky::new(self.covariance + noise) else { return };
        let mahalanobis = innovation.dot(&factor.solve(&innovation)).max(0.0).sqrt();
        let inflation = (mahalanobis / settings.huber).max(1.0);
        let Some(factor) = Cholesky::new(self.covariance + noise * inflation) else { return };
        let gain = factor.solve(&self.covariance).transpose();
        let step = gain * innovation;
        let left = StateCovariance::identity() - gain;
        // Joseph's form stays symmetric and positive.
        self.covariance = left * self.covariance * left.transpose()
            + gain * (noise * inflation) * gain.transpose();
        self.ellipsoid = moved(&self.ellipsoid, &step);
        self.keep_floor(settings);
    }

    fn keep_floor(&mut self, settings: &FusionSettings) {
        let floors = [
            settings.min_heading_sigma_deg.to_radians(),
            settings.min_position_sigma_m,
            settings.min_position_sigma_m,
            settings.min_position_sigma_m,
            settings.min_size_sigma_m,
            settings.min_size_sigma_m,
            settings.min_size_sigma_m,
        ];
        for (i, floor) in floors.into_iter().enumerate() {
            let missing = floor * floor - self.covariance[(i, i)];
            self.covariance[(i, i)] += missing.max(0.0);
        }
    }
}

/// `measured - estimate` in the estimate's frame.
fn difference(estimate: &Ellipsoid, measured: &Ellipsoid) -> State {
    let relative = estimate.pose.inverse() * measured.pose;
    let (t, s) = (relative.translation.vector, measured.semi_axes - estimate.semi_axes);
    State::from([yaw_of(&relative), t.x, t.y, t.z, s.x, s.y, s.z])
}

fn moved(estimate: &Ellipsoid, step: &State) -> Ellipsoid {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), step[0]);
    let shift = Translation3::new(step[1], step[2], step[3]);
    let semi_axes = estimate.semi_axes + step.fixed_rows::<3>(4);
    Ellipsoid::new(
        estimate.pose * Pose::from_parts(shift, turn),
        semi_axes.map(|s| s.max(MIN_SEMI_AXIS_M)),
    )
}

/// The same ellipsoid without roll and pitch.
fn upright(ellipsoid: &Ellipsoid) -> Ellipsoid {
    let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw_of(&ellipsoid.pose));
    Ellipsoid {
        pose: Pose::from_parts(ellipsoid.pose.translation, rotation),
        semi_axes: ellipsoid.semi_axes,
    }
}

/// From log semi-axes to semi-axes, without roll and pitch.
fn linear_covariance(covariance: &SMatrix<f64, 9, 9>, semi_axes: &Vector3<f64>) -> StateCovariance {
    let block = covariance.fixed_view::<7, 7>(2, 2);
    let mut scale = State::repeat(1.0);
    scale.fixed_rows_mut::<3>(4).copy_from(semi_axes);
    StateCovariance::from_fn(|i, j| block[(i, j)] * scale[i] * scale[j])
}

/// The covariance after renaming axes by quarter turns: new x is old y, new y is old -x.
fn turned(covariance: &StateCovariance, quarters: i64) -> StateCovariance {
    let mut out = *covariance;
    for _ in 0..quarters.rem_euclid(4) {
        let mut m = StateCovariance::zeros();
        for (to, from, sign) in [
            (0, 0, 1.0),
            (1, 2, 1.0),
            (2, 1, -1.0),
            (3, 3, 1.0),
            (4, 5, 1.0),
            (5, 4, 1.0),
            (6, 6, 1.0),
        ] {
            m[(to, from)] = sign;
        }
        out = m * out * m.transpose();
    }
    out
}

/// The covariance of a measurement in the frame of the estimate, whose heading differs by `turn`: a round object may be
/// measured with any heading, and what was hidden is hidden along the measurement's axes.
fn seen_along(turn: f64, covariance: &StateCovariance) -> StateCovariance {
    let (sin, cos) = turn.sin_cos();
    let mut rotation = StateCovariance::identity();
    (rotation[(1, 1)], rotation[(1, 2)]) = (cos, -sin);
    (rotation[(2, 1)], rotation[(2, 2)]) = (sin, cos);
    rotation * covariance * rotation.transpose()
}

const MIN_SEMI_AXIS_M: f64 = 0.002;
