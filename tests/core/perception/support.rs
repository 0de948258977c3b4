use crate::scene::{Scene, View, camera, looking, standing};
use ellipsoid_slam::perception::{
    DepthNoise, Frame, Rays, SupportPlane, SupportSettings, find_support_planes,
};
use nalgebra::{UnitQuaternion, UnitVector3, Vector3};

const TABLE_TOP_M: f64 = 0.75;

fn table() -> Scene {
    let mut scene = Scene::with_floor();
    scene.add(standing(0.0, [2.0, 0.0, TABLE_TOP_M - 0.015], [0.5, 0.7, 0.015]));
    scene
}

fn planes_with(view: &View, up_in_camera: &UnitVector3<f64>) -> Vec<SupportPlane> {
    let rays = Rays::new(camera());
    let frame = Frame::new(&view.depth, &rays, up_in_camera, DepthNoise::default());
    find_support_planes(&frame, &SupportSettings::default())
}

/// Heights of the planes below the camera, in the world.
fn heights(view: &View, planes: &[SupportPlane]) -> Vec<f64> {
    let eye = view.world_from_camera.translation.z;
    planes.iter().map(|p| eye - p.plane.offset / p.plane.normal.z).collect()
}

fn assert_floor_and_table(heights: &[f64], tolerance: f64) {
    for expected in [0.0, TABLE_TOP_M] {
        let near = heights.iter().filter(|h| (*h - expected).abs() < tolerance).count();
        assert_eq!(near, 1, "one plane at {expected} among {heights:?}");
    }
    assert_eq!(heights.len(), 2, "{heights:?}");
}

#[test]
fn floor_and_table_top_are_both_found() {
    for (eye, down_deg) in
        [([0.0, 0.0, 1.4], 25.0), ([0.2, 0.3, 1.2], 20.0), ([0.5, -0.4, 1.7], 40.0)]
    {
        let view = table().seen_from(&looking(eye, 0.0, down_deg));
        let planes = planes_with(&view, &view.up_in_camera());
        assert_floor_and_table(&heights(&view, &planes), 0.005);
        for plane in &planes {
            assert!(plane.plane.normal.z > 0.9999 && plane.points > 2000 && plane.rms_m < 0.001);
            assert!(plane.points_in_level().all(|p| plane.height_of(&p).abs() < 0.02));
        }
    }
}

#[test]
fn noise_does_not_hide_them() {
    for seed in 0..3 {
        let view = table().seen_with(&looking([0.0, 0.0, 1.4], 0.0, 25.0), Some(seed));
        let planes = planes_with(&view, &view.up_in_camera());
        assert_floor_and_table(&heights(&view, &planes), 0.01);
    }
}

/// A robot whose camera is hardly above the table: the top is a sliver of some thousand pixels.
#[test]
fn a_table_top_just_below_the_eye_is_found() {
    for seed in [None, Some(1), Some(2)] {
        let view = table().seen_with(&looking([0.8, 0.0, 0.85], 0.0, 15.0), seed);
        let planes = planes_with(&view, &view.up_in_camera());
        assert_floor_and_table(&heights(&view, &planes), 0.01);
    }
}

#[test]
fn walls_and_ceilings_are_no_support() {
    let mut scene = Scene::default();
    scene.add(standing(0.0, [3.1, 0.0, 0.0], [0.1, 5.0, 5.0]));
    scene.add(standing(0.0, [0.0, 0.0, 2.6], [5.0, 5.0, 0.1]));
    let view = scene.seen_from(&looking([0.0, 0.0, 1.4], 0.0, -25.0));
    let found = planes_with(&view, &view.up_in_camera());
    assert!(heights(&view, &found).is_empty(), "{:?}", heights(&view, &found));
}

#[test]
fn an_empty_image_has_no_planes() {
    let view = Scene::default().seen_from(&looking([0.0, 0.0, 1.4], 0.0, 25.0));
    assert!(planes_with(&view, &view.up_in_camera()).is_empty());
}

/// Gravity is known to a few degrees only: planes are found where they are, not where gravity says.
#[test]
fn a_wrong_direction_of_gravity_is_survived() {
    let view = table().seen_from(&looking([0.0, 0.0, 1.4], 0.0, 25.0));
    for axis in [Vector3::x_axis(), Vector3::z_axis(), -Vector3::x_axis()] {
        let wrong =
            UnitQuaternion::from_axis_angle(&axis, 5.0_f64.to_radians()) * view.up_in_camera();
        let planes = planes_with(&view, &wrong);
        assert_eq!(planes.len(), 2, "{:?}", heights(&view, &planes));
        for plane in planes {
            let tilt = plane.plane.normal.z.acos().to_degrees();
            assert!((tilt - 5.0).abs() < 1.0, "tilted by {tilt} against the wrong gravity");
            // How far the eye is above the plane does not depend on gravity.
            let drop = plane.plane.offset;
            let off = (drop - 1.4).abs().min((drop - 1.4 + TABLE_TOP_M).abs());
            assert!(off < 0.01, "the eye is {drop} above it");
        }
    }
}

/// Of a table behind a bench little more than the top is seen, and beside it the seat.
#[test]
fn a_table_does_not_stand_on_the_seat_before_it() {
    let mut scene = Scene::with_floor();
    let top = scene.add(standing(0.0, [2.6, 0.0, 0.72], [0.4, 0.7, 0.02]));
    scene.add(standing(0.0, [1.95, 0.0, 0.23], [0.22, 1.2, 0.23]));
    let view = scene.seen_with(&looking([0.0, 0.0, 1.2], 0.0, 15.0), Some(2));
    let heights = heights(&view, &planes_with(&view, &view.up_in_camera()));
    assert!(heights.iter().any(|height| (height - 0.46).abs() < 0.02), "{heights:?}");
    let m = super::measure(&view, "dining table", top);
    let body = m.ellipsoid.transformed(&view.world_from_camera);
    let bottom = body.center().z - body.semi_axes.z;
    assert!(bottom.abs() < 0.03, "the table's feet are at {bottom} m");
}
