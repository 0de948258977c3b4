//! What a box says where depth does not suffice.

use super::estimate_with;
use crate::scene::{Scene, View, camera, detection, looking, standing};
use ellipsoid_slam::{
    geometry::{Ellipsoid, Rect},
    perception::{
        DepthNoise, Detection, Frame, FrameEstimate, PerceptionSettings, Rays, Refused,
        estimate_frame,
    },
};
use nalgebra::Vector3;

fn look(view: &View, label: &str, thing: usize) -> FrameEstimate {
    let settings = PerceptionSettings::default();
    estimate_with(view, label, view.box_around(thing), &view.up_in_camera(), &settings)
}

/// A refrigerator of the usual size, farther off than depth is used.
fn far_refrigerator() -> (Scene, usize) {
    let mut scene = Scene::with_floor();
    let thing = scene.add(standing(0.0, [8.0, 2.0, 0.85], [0.325, 0.35, 0.85]));
    (scene, thing)
}

#[test]
fn something_far_away_is_where_a_thing_of_its_class_would_look_so_large() {
    let (scene, thing) = far_refrigerator();
    let view = scene.seen_from(&looking([0.0, 0.0, 1.0], 0.1, 5.0));
    let seen = look(&view, "refrigerator", thing);
    assert!(matches!(seen.objects[0], Err(Refused::TooFewPoints { .. })), "{:?}", seen.objects[0]);
    let glimpse = seen.glimpses[0].as_ref().unwrap();
    let truth = scene.thing(thing);
    let body = glimpse.ellipsoid.transformed(&view.world_from_camera);
    let eye = view.world_from_camera.translation.vector;
    let (ray, off) = (truth.pose.translation.vector - eye, body.center().coords - eye);
    // The direction is good to half a degree, the range is a guess.
    assert!(ray.angle(&off) < 0.01, "{}", ray.angle(&off));
    assert!((off.norm() / ray.norm() - 1.0).abs() < 0.25, "{} m", off.norm());
    assert!((body.semi_axes.z - 0.85).abs() < 0.2, "{}", body.semi_axes);
    // It knows what it does not know: the range. x points away from the camera.
    let away = body.pose.rotation * Vector3::x();
    assert!(away.angle(&Vector3::new(ray.x, ray.y, 0.0)) < 0.01);
    let sigma = |i: usize| glimpse.covariance[(i, i)].sqrt();
    assert!(sigma(3) > 1.0 && sigma(4) < 0.3 && sigma(5) < 0.7, "{}", glimpse.covariance);
    // Were it farther off, it would be larger.
    assert!(glimpse.covariance[(3, 8)] > 0.5 * sigma(3) * sigma(8));
}

#[test]
fn depth_in_the_box_tells_the_range() {
    let mut scene = Scene::with_floor();
    // Six books side by side: their points are one cluster that goes on outside each box.
    let books: Vec<usize> = (0..6)
        .map(|i| {
            let y = 0.17 * f64::from(i) - 0.4;
            scene.add(standing(0.0, [3.0, y, 0.77], [0.12, 0.085, 0.02]))
        })
        .collect();
    scene.add(standing(0.0, [3.2, 0.0, 0.73], [0.5, 0.9, 0.02]));
    let view = scene.seen_with(&looking([0.0, 0.0, 1.2], 0.0, 10.0), Some(1));
    let seen = look(&view, "book", books[2]);
    assert!(seen.objects[0].is_err());
    let glimpse = seen.glimpses[0].as_ref().unwrap();
    let body = glimpse.ellipsoid.transformed(&view.world_from_camera);
    let off = body.center().coords - scene.thing(books[2]).pose.translation.vector;
    assert!(off.norm() < 0.15, "{off}");
    assert!(glimpse.covariance[(3, 3)].sqrt() < 0.6);
}

#[test]
fn what_the_image_cuts_off_has_the_proportions_of_its_class() {
    let (scene, thing) = far_refrigerator();
    // The left border of the image is `beyond` (rad) to the left of its middle, of which either half is 0.043 wide.
    let at_border = |beyond: f64| {
        let yaw = 2.0_f64.atan2(8.0) + beyond - (319.5_f64 / 525.0).atan();
        let view = scene.seen_from(&looking([0.0, 0.0, 1.0], yaw, 5.0));
        let seen = look(&view, "refrigerator", thing);
        let glimpse = seen.glimpses[0].clone();
        glimpse.map(|glimpse| (glimpse.ellipsoid.transformed(&view.world_from_camera), glimpse))
    };
    let (whole, whole_glimpse) = at_border(0.08).unwrap();
    let (cut, cut_glimpse) = at_border(0.015).unwrap();
    let bearing = |body: &Ellipsoid| body.center().y.atan2(body.center().x) - 0.25_f64.atan();
    assert!(bearing(&whole).abs() < 0.006, "{}", bearing(&whole));
    // The middle of what is left is 0.014 to the right.
    assert!(bearing(&cut).abs() < 0.009, "{}", bearing(&cut));
    assert!(cut_glimpse.covariance[(4, 4)] > 1.5 * whole_glimpse.covariance[(4, 4)]);
    assert!(at_border(-0.02).is_none(), "more than a half is cut off");
}

#[test]
fn what_is_measured_is_not_glimpsed() {
    let mut scene = Scene::with_floor();
    let thing = scene.add(standing(0.3, [2.5, 0.0, 0.4], [0.3, 0.2, 0.4]));
    let view = scene.seen_from(&looking([0.0, 0.0, 1.2], 0.0, 20.0));
    let seen = look(&view, "cabinet", thing);
    assert!(seen.objects[0].is_ok() && seen.glimpses[0].is_none());
    let off = PerceptionSettings { glimpses: false, ..PerceptionSettings::default() };
    let (scene, thing) = far_refrigerator();
    let view = scene.seen_from(&looking([0.0, 0.0, 1.0], 0.1, 5.0));
    let rect = view.box_around(thing);
    let seen = estimate_with(&view, "refrigerator", rect, &view.up_in_camera(), &off);
    assert!(seen.glimpses[0].is_none(), "it was asked not to");
}

#[test]
fn what_stands_before_a_table_is_not_the_table() {
    let mut scene = Scene::with_floor();
    let legs = [(2.65, -0.7), (2.65, 0.7), (3.35, -0.7), (3.35, 0.7)];
    let mut table: Vec<usize> = legs
        .iter()
        .map(|(x, y)| scene.add(standing(0.0, [*x, *y, 0.35], [0.025, 0.025, 0.35])))
        .collect();
    table.push(scene.add(standing(0.0, [3.0, 0.0, 0.72], [0.4, 0.75, 0.02])));
    let suitcase = scene.add(standing(0.0, [2.3, 0.0, 0.3], [0.1, 0.35, 0.3]));
    let view = scene.seen_with(&looking([0.0, 0.0, 0.95], 0.0, 8.0), Some(3));
    let parts = table.iter().map(|part| view.box_around(*part));
    let around = parts.reduce(|a, b| {
        let (low, high) = ((a.x_min.min(b.x_min), a.y_min.min(b.y_min)), a.x_max.max(b.x_max));
        Rect::new(low.0, low.1, high, a.y_max.max(b.y_max)).unwrap()
    });
    let detections = [
        detection("dining table", around.unwrap()),
        detection("suitcase", view.box_around(suitcase)),
    ];
    let rays = Rays::new(camera());
    let frame = Frame::new(&view.depth, &rays, &view.up_in_camera(), DepthNoise::default());
    let off = |detections: &[Detection]| {
        let settings = PerceptionSettings::default();
        let seen = estimate_frame(&frame, detections, &settings, &mut ());
        let body = match (&seen.objects[0], &seen.glimpses[0]) {
            (Ok(measured), _) => measured.ellipsoid,
            (Err(_), glimpse) => glimpse.as_ref().unwrap().ellipsoid,
        };
        let center = body.transformed(&view.world_from_camera).center();
        (center.coords - Vector3::new(3.0, 0.0, 0.37)).xy().norm()
    };
    // By itself, the table is taken for what stands in the middle of its box.
    let (alone, beside) = (off(&detections[..1]), off(&detections));
    assert!(beside < 0.3 && beside < alone, "{beside} m, without the suitcase's box {alone} m");
}
