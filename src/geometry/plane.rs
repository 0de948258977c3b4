//! Planes in three dimensions.

use super::Pose;
use nalgebra::{Point3, Unit, Vector3};

/// The plane of all `x` with `normal · x + offset = 0`; its normal points to the positive side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Unit normal; for a support plane it points up.
    pub normal: Unit<Vector3<f64>>,
    /// `-normal · x` for any `x` on the plane (m).
    pub offset: f64,
}

impl Plane {
    /// The plane through `point` with the given normal.
    pub fn through(point: &Point3<f64>, normal: Unit<Vector3<f64>>) -> Self {
        Self { normal, offset: -normal.dot(&point.coords) }
    }

    /// Distance of `point` from the plane (m), positive on the side of the normal.
    pub fn signed_distance(&self, point: &Point3<f64>) -> f64 {
        self.normal.dot(&point.coords) + self.offset
    }

    /// The mirror image of `point`.
    pub fn mirrored(&self, point: &Point3<f64>) -> Point3<f64> {
        point - self.normal.into_inner() * (2.0 * self.signed_distance(point))
    }

    /// The same plane in frame `a`, given in frame `b`.
    pub fn transformed(&self, a_from_b: &Pose) -> Self {
        let normal = a_from_b.rotation * self.normal;
        Self { normal, offset: self.offset - normal.dot(&a_from_b.translation.vector) }
    }
}
