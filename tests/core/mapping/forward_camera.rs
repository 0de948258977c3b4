//! A robot with a camera half a metre up that looks along x, for maps that are fed with made-up depth images.

use ellipsoid_slam::{
    geometry::{Camera, Ellipsoid, Pose, Rect},
    mapping::{ObjectMap, Observation, Sighted, Sighting, View},
    perception::{DepthImage, DepthNoise},
    time::Stamp,
};
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use std::f64::consts::FRAC_PI_2;

pub(crate) fn base_from_camera() -> Pose {
    let rotation = UnitQuaternion::from_euler_angles(-FRAC_PI_2, 0.0, -FRAC_PI_2);
    Pose::from_parts(Translation3::new(0.0, 0.0, 0.5), rotation)
}

/// The image of a body's near face; the body is in the frame of the base, its axes along those of the base.
pub(crate) fn near_face(camera: &Camera, body: &Ellipsoid) -> Rect {
    let camera_from_base = base_from_camera().inverse();
    let half = body.semi_axes;
    let at = |y: f64, z: f64| {
        let near = body.center() + Vector3::new(-half.x, y, z);
        camera.project(&(camera_from_base * near)).unwrap()
    };
    let (low, high) = (at(half.y, half.z), at(-half.y, -half.z));
    Rect::new(low.x, low.y, high.x, high.y).unwrap()
}

/// What a depth camera sees of the near faces of bodies in the frame of the base, before a wall 6 m off, and their boxes: nothing for
/// what is outside of the image.
pub(crate) fn image_of<'a>(
    camera: &Camera,
    bodies: impl Iterator<Item = &'a Ellipsoid>,
) -> (DepthImage, Vec<Option<Rect>>) {
    let (width, height) = (camera.width(), camera.height());
    let mut metres = vec![6.0_f32; (width * height) as usize];
    let mut rects = Vec::new();
    for body in bodies {
        let depth = (body.center().x - body.semi_axes.x) as f32;
        let rect = near_face(camera, body);
        for v in rect.y_min.max(0.0) as u32..(rect.y_max.max(0.0) as u32).min(height) {
            for u in rect.x_min.max(0.0) as u32..(rect.x_max.max(0.0) as u32).min(width) {
                let pixel = &mut metres[(v * width + u) as usize];
                *pixel = pixel.min(depth);
            }
        }
        rects.push(rect.clipped(width, height));
    }
    (DepthImage::new(width, height, metres).unwrap(), rects)
}

/// What one image brings to a map that is not to refuse it.
pub(crate) fn sighted(
    map: &mut ObjectMap,
    (camera, depth): (&Camera, &DepthImage),
    (stamp, odom_from_base): (Stamp, Pose),
    observations: Vec<Observation>,
) -> Sighted {
    let sighted = map.observe(&Sighting {
        stamp,
        odom_from_base,
        odometry_covariance: None,
        observations,
        walls: Vec::new(),
        view: Some(View {
            base_from_camera: base_from_camera(),
            camera,
            depth,
            noise: DepthNoise::default(),
            max_range_m: 5.0,
        }),
    });
    assert_eq!(sighted.refused, None);
    sighted
}
