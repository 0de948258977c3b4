//! Vertical planes.

use super::{Pose, yaw_of};
use nalgebra::{Point2, Point3, Vector2};
use std::f64::consts::PI;

/// A vertical plane without ends, seen from above: a line, one side of which can be seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// A point on it (m). Errors of `heading` turn the wall about it.
    pub point: Point2<f64>,
    /// Direction of the normal, to the side that can be seen, from x to y (rad).
    pub heading: f64,
}

impl Wall {
    /// The normal.
    pub fn normal(&self) -> Vector2<f64> {
        let (sin, cos) = self.heading.sin_cos();
        Vector2::new(cos, sin)
    }

    /// The horizontal direction in it, a quarter turn from the normal.
    pub fn along(&self) -> Vector2<f64> {
        let normal = self.normal();
        Vector2::new(-normal.y, normal.x)
    }

    /// Distance of a point from it, positive on the side that can be seen (m).
    pub fn signed_distance(&self, point: &Point2<f64>) -> f64 {
        self.normal().dot(&(point - self.point))
    }

    /// Turned by the first element (rad) and moved by the second (m), along the normal half-way through the turn: a step
    /// with the other sign leads back.
    #[must_use]
    pub fn retract(&self, delta: &Vector2<f64>) -> Self {
        let half_way = self.turned(0.5 * delta.x);
        let point = self.point + half_way.normal() * delta.y;
        Self { point, heading: self.heading + delta.x }
    }

    /// The step to another wall: `self.retract(self.local(other))` is the same plane.
    pub fn local(&self, other: &Self) -> Vector2<f64> {
        let turn = within_half_a_turn(other.heading - self.heading);
        // Never 0, since half a turn is at most a right angle, and its cosine is rounded.
        let reach = (0.5 * turn).cos();
        Vector2::new(turn, -other.signed_distance(&self.point) / reach)
    }

    /// The same turned about its point (rad).
    #[must_use]
    pub fn turned(&self, angle: f64) -> Self {
        Self { heading: self.heading + angle, ..*self }
    }

    /// The same wall in frame `a`, given in frame `b`; the motion turns about the vertical.
    #[must_use]
    pub fn transformed(&self, a_from_b: &Pose) -> Self {
        let point = a_from_b * Point3::new(self.point.x, self.point.y, 0.0);
        Self { point: point.xy(), heading: self.heading + yaw_of(a_from_b) }
    }
}

/// The same angle between -π and π (rad).
fn within_half_a_turn(angle: f64) -> f64 {
    angle - 2.0 * PI * (angle / (2.0 * PI)).round()
}
