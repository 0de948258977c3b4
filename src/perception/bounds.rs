//! The upright box round some points.

use nalgebra::{Point3, Vector3};

/// The axis-aligned box round points of the level frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl Bounds {
    /// Of all points; of none, a box that is everything's outside.
    pub(super) fn of(points: impl Iterator<Item = Point3<f64>>) -> Self {
        let nothing = Self { low: Vector3::repeat(f64::MAX), high: Vector3::repeat(f64::MIN) };
        points.fold(nothing, |b, p| Self { low: b.low.inf(&p.coords), high: b.high.sup(&p.coords) })
    }

    /// Distance of a point from the box seen from above (m).
    pub(super) fn distance_on_ground_m(&self, point: &Point3<f64>) -> f64 {
        let outside = (self.low - point.coords).sup(&(point.coords - self.high));
        outside.sup(&Vector3::zeros()).xy().norm()
    }

    /// From corner to corner (m).
    pub(super) fn diagonal_m(&self) -> f64 {
        (self.high - self.low).norm()
    }
}
