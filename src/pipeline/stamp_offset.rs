//! How far the stamps of images are off from those of odometry, learnt from walls while the robot turns.

use crate::{
    geometry::{Pose, yaw_of},
    perception::WallSegment,
};
use nalgebra::{Matrix2, Vector2};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// The offset as a slow state, beside the heading of the walls in odometry's frame.
///
/// Walls are at right angles to each other, so that each tells the same heading modulo a quarter turn. Where stamps are off, walls
/// seem to turn with the robot, by its rate of turn times the offset. That is told from drift by its coming and going with the turn.
#[derive(Clone, Debug)]
pub(super) struct StampOffset {
    /// Heading of the walls in odometry's frame (rad), and how much later than its stamp an image was taken (s).
    state: Vector2<f64>,
    covariance: Matrix2<f64>,
    /// Pose of odometry at the last wall; nothing before the first.
    last: Option<Pose>,
    /// Walls in a row that stood elsewhere.
    strangers: usize,
}

/// An offset and how well it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Offset {
    /// Odometry at stamp + this belongs to the image at stamp (s).
    pub(super) seconds: f64,
    /// Its standard deviation (s).
    pub(super) sigma_s: f64,
}

impl StampOffset {
    /// Stamps of which nothing is known but how far they usually are off (s).
    pub(super) fn new(usual_s: f64) -> Self {
        let covariance = Matrix2::new(0.0, 0.0, 0.0, usual_s.powi(2));
        Self { state: Vector2::zeros(), covariance, last: None, strangers: 0 }
    }

    /// What is known.
    pub(super) fn known(&self) -> Offset {
        Offset { seconds: self.state.y, sigma_s: self.covariance[(1, 1)].sqrt() }
    }

    /// What is to be added to an image's stamp before odometry is asked (s): nothing until it is clear that there is an offset.
    pub(super) fn correction_s(&self) -> f64 {
        let Offset { seconds, sigma_s } = self.known();
        if seconds.abs() > CLEAR_SIGMAS * sigma_s { seconds } else { 0.0 }
    }

    /// Takes the walls of an image that was placed with `used_s` added to its stamp, while the robot turned by `rate` (rad/s).
    pub(super) fn see(
        &mut self,
        walls: &[WallSegment],
        (odom_from_base, base_from_camera): (&Pose, &Pose),
        (used_s, rate): (f64, f64),
    ) {
        let clear = |wall: &&WallSegment| wall.heading_sigma < MAX_SIGMA_RAD;
        let by_sigma =
            |a: &&WallSegment, b: &&WallSegment| a.heading_sigma.total_cmp(&b.heading_sigma);
        let Some(wall) = walls.iter().filter(clear).min_by(by_sigma) else { return };
        let normal = odom_from_base.rotation * (base_from_camera.rotation * wall.normal);
        let heading = normal.y.atan2(normal.x);
        let variance = wall.heading_sigma.powi(2) + CROOKED_RAD.powi(2);
        let Some(last) = self.last.replace(*odom_from_base) else {
            self.begin(heading, variance);
            return;
        };
        let step = last.inverse() * odom_from_base;
        let drift = DRIFT_RAD_PER_ROOT_RAD.powi(2) * yaw_of(&step).abs()
            + DRIFT_RAD_PER_ROOT_M.powi(2) * step.translation.vector.norm();
        self.covariance[(0, 0)] += drift;
        // An image taken later than its stamp shows walls turned back by what odometry does not know of yet.
        let row = Vector2::new(1.0, -rate);
        let expected = self.state.x - rate * (self.state.y - used_s);
        let off = within_quarter(heading - expected);
        let innovation = row.dot(&(self.covariance * row)) + variance;
        if off * off > GATE * innovation {
            self.strangers += 1;
            if self.strangers >= MOVED_AFTER {
                self.begin(heading, variance);
            }
            return;
        }
        self.strangers = 0;
        let gain = self.covariance * row / innovation;
        self.state += gain * off;
        self.covariance -= gain * (row.transpose() * self.covariance);
        self.state.y = self.state.y.clamp(-LARGEST_S, LARGEST_S);
    }

    /// The walls' heading is another one from now on; the offset stays.
    fn begin(&mut self, heading: f64, variance: f64) {
        self.state.x = heading;
        self.strangers = 0;
        self.covariance = Matrix2::from_diagonal(&Vector2::new(variance, self.covariance[(1, 1)]));
    }
}

/// An angle modulo a quarter turn, nearest to zero.
fn within_quarter(angle: f64) -> f64 {
    (angle + FRAC_PI_4).rem_euclid(FRAC_PI_2) - FRAC_PI_4
}

/// An offset is corrected when it is so many standard deviations from none.
const CLEAR_SIGMAS: f64 = 2.0;
/// Walls with a less certain heading say nothing of milliseconds (rad).
const MAX_SIGMA_RAD: f64 = 0.02;
/// Standard deviation of walls from right angles, and of a wall from a plane (rad).
const CROOKED_RAD: f64 = 0.006;
/// How fast odometry's heading drifts: after a turn by one radian, and after one metre (rad).
const DRIFT_RAD_PER_ROOT_RAD: f64 = 0.012;
const DRIFT_RAD_PER_ROOT_M: f64 = 0.006;
/// Squared Mahalanobis distance beyond which a wall is at no right angle to the others.
const GATE: f64 = 12.0;
/// So many of them in a row, and odometry has jumped.
const MOVED_AFTER: usize = 5;
/// Beyond this, stamps are of two clocks, and interpolation is no remedy (s).
const LARGEST_S: f64 = 0.2;
