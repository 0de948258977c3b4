//! Single-frame estimation on depth images of rooms whose geometry is known exactly.

mod cut_and_hidden;
mod detection;
mod ends;
mod fit;
mod glimpses;
mod limits;
mod masks;
mod parts;
mod refusals;
mod registration;
mod shapes;
mod support;
mod symmetry;
mod walls;

use crate::scene::{View, camera, detection};
use ellipsoid_slam::{
    geometry::{Ellipsoid, OrientedBox, intersection_over_union, yaw_of},
    perception::{
        DepthNoise, Detection, EllipsoidMeasurement, Frame, FrameEstimate, PerceptionSettings,
        Rays, Refused, estimate_frame,
    },
};
use nalgebra::{UnitVector3, Vector3};

/// What the view says of one box.
pub(crate) fn estimate_box(
    view: &View,
    label: &str,
    rect: ellipsoid_slam::geometry::Rect,
) -> Result<EllipsoidMeasurement, Refused> {
    let settings = PerceptionSettings::default();
    estimate_with(view, label, rect, &view.up_in_camera(), &settings).objects.remove(0)
}

/// The measurement of a thing whose visible part a perfect detector found.
pub(crate) fn measure(view: &View, label: &str, thing: usize) -> EllipsoidMeasurement {
    estimate_box(view, label, view.box_around(thing)).unwrap()
}

pub(crate) fn estimate_with(
    view: &View,
    label: &str,
    rect: ellipsoid_slam::geometry::Rect,
    up_in_camera: &UnitVector3<f64>,
    settings: &PerceptionSettings,
) -> FrameEstimate {
    let rays = Rays::new(camera());
    let frame = Frame::new(&view.depth, &rays, up_in_camera, DepthNoise::default());
    estimate_frame(&frame, &[detection(label, rect)], settings, &mut ())
}

/// What the view says of several boxes.
pub(crate) fn estimate_all(view: &View, boxes: &[Detection]) -> FrameEstimate {
    let rays = Rays::new(camera());
    let frame = Frame::new(&view.depth, &rays, &view.up_in_camera(), DepthNoise::default());
    estimate_frame(&frame, boxes, &PerceptionSettings::default(), &mut ())
}

/// In the world, with axes named as those of `truth`.
pub(crate) fn in_world(m: &EllipsoidMeasurement, view: &View, truth: &OrientedBox) -> Ellipsoid {
    m.ellipsoid.transformed(&view.world_from_camera).relabelled_towards(yaw_of(&truth.pose))
}

/// How far a measurement is off.
#[derive(Debug)]
pub(crate) struct Off {
    pub(crate) center_m: Vector3<f64>,
    pub(crate) semi_axes_m: Vector3<f64>,
    pub(crate) yaw: f64,
    pub(crate) iou: f64,
}

pub(crate) fn off(m: &EllipsoidMeasurement, view: &View, truth: &OrientedBox) -> Off {
    let e = in_world(m, view, truth);
    let relative = truth.pose.inverse() * e.pose;
    Off {
        center_m: relative.translation.vector,
        semi_axes_m: e.semi_axes - truth.half_extents,
        yaw: yaw_of(&relative),
        iou: intersection_over_union(&(&e).into(), truth),
    }
}

/// Standard deviations of the semi-axes [m] along the object's own x, y, z.
pub(crate) fn size_sigmas(m: &EllipsoidMeasurement) -> Vector3<f64> {
    Vector3::from_fn(|i, _| m.covariance[(6 + i, 6 + i)].sqrt() * m.ellipsoid.semi_axes[i])
}
