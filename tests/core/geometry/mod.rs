//! Laws of geometry, and examples worked out by hand to catch a sign that is wrong on both ways.

mod camera;
mod dual_quadric;
mod ellipsoid;
mod ground;
mod outline;
mod overlap;
mod plane;
mod pose;
mod rect;
mod silhouette;
mod wall;

use ellipsoid_slam::geometry::{Ellipsoid, Plane, Pose, Wall};
use nalgebra::{Point3, Translation3, Unit, UnitQuaternion, Vector3};
use proptest::prelude::*;

/// Rounding of a handful of operations on numbers of about ten.
pub(crate) const ROUNDING: f64 = 1e-9;

pub(crate) fn vectors(limit: f64) -> impl Strategy<Value = Vector3<f64>> {
    let side = -limit..limit;
    (side.clone(), side.clone(), side).prop_map(|(x, y, z)| Vector3::new(x, y, z))
}

pub(crate) fn points() -> impl Strategy<Value = Point3<f64>> {
    vectors(5.0).prop_map(Point3::from)
}

/// Rotation angles up to 3.1 rad: at half a turn the logarithm has two values.
pub(crate) fn poses() -> impl Strategy<Value = Pose> {
    (directions(), 0.0..3.1, vectors(5.0)).prop_map(|(axis, angle, shift)| {
        Pose::from_parts(Translation3::from(shift), UnitQuaternion::from_axis_angle(&axis, angle))
    })
}

pub(crate) fn directions() -> impl Strategy<Value = Unit<Vector3<f64>>> {
    vectors(1.0).prop_filter_map("too short for a direction", |v| Unit::try_new(v, 0.1))
}

pub(crate) fn planes() -> impl Strategy<Value = Plane> {
    (directions(), points()).prop_map(|(normal, point)| Plane::through(&point, normal))
}

pub(crate) fn walls() -> impl Strategy<Value = Wall> {
    (-3.1..3.1, points()).prop_map(|(heading, point)| Wall { point: point.xy(), heading })
}

pub(crate) fn semi_axes() -> impl Strategy<Value = Vector3<f64>> {
    let side = 0.02..2.0;
    (side.clone(), side.clone(), side).prop_map(|(x, y, z)| Vector3::new(x, y, z))
}

pub(crate) fn ellipsoids() -> impl Strategy<Value = Ellipsoid> {
    (poses(), semi_axes()).prop_map(|(pose, semi_axes)| Ellipsoid::new(pose, semi_axes))
}

/// Upright ellipsoids, as objects are.
pub(crate) fn upright_ellipsoids() -> impl Strategy<Value = Ellipsoid> {
    (-3.1..3.1, vectors(5.0), semi_axes())
        .prop_map(|(yaw, center, semi_axes)| Ellipsoid::new(upright_pose(yaw, center), semi_axes))
}

pub(crate) fn upright_pose(yaw: f64, center: Vector3<f64>) -> Pose {
    let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
    Pose::from_parts(Translation3::from(center), rotation)
}

pub(crate) fn pose_distance(a: &Pose, b: &Pose) -> f64 {
    a.rotation.angle_to(&b.rotation) + (a.translation.vector - b.translation.vector).norm()
}
