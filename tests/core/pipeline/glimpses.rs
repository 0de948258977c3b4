//! Objects that depth never reaches.

use super::{Run, at, boxes_with, camera_info, odometry_at, transform};
use crate::scene::{Scene, camera, detection, looking, standing};
use ellipsoid_slam::{
    geometry::Pose,
    pipeline::{CameraRole, DepthMessage, Input, Settings},
};
use nalgebra::Vector3;

const PLACE: [f64; 3] = [8.0, 1.0, 0.8];

/// Looks at a thing that stands 8 m off, from places `step_m` apart.
fn drive(label: &str, step_m: f64) -> Run {
    let mut scene = Scene::with_floor();
    // Not quite of the usual size.
    let thing = scene.add(standing(0.4, PLACE, [0.3, 0.3, 0.8]));
    let base_from_camera = looking([0.0, 0.0, 1.0], 0.1, 3.0);
    let mut run = Run::new(Settings::default());
    run.feed([
        camera_info(CameraRole::Color, "camera", camera()),
        transform(true, 0, ["base_link", "camera"], base_from_camera),
    ]);
    for i in 0..10_i32 {
        let (ms, aside) = (200 * i64::from(i), step_m * f64::from(i - 5));
        let odom_from_base = Pose::translation(0.0, aside, 0.0);
        let view = scene.seen_from(&(odom_from_base * base_from_camera));
        let detections = vec![detection(label, view.box_around(thing))];
        let (stamp, frame_id) = (at(ms), "camera".into());
        run.feed([
            odometry_at(ms, odom_from_base),
            Input::Depth(DepthMessage { stamp, frame_id, image: view.depth }),
            boxes_with(ms, detections),
        ]);
    }
    run.finish();
    run
}

#[test]
fn boxes_from_different_places_tell_where_it_stands() {
    let run = drive("refrigerator", 0.4);
    let objects: Vec<_> = run.slam.objects().collect();
    let [object] = objects[..] else { panic!("{} objects", objects.len()) };
    assert!(object.is_glimpsed() && object.label() == "refrigerator");
    let off = object.ellipsoid().center().coords - Vector3::from(PLACE);
    assert!(off.norm() < 0.5, "{off}");
    assert!((object.ellipsoid().semi_axes.z - 0.8).abs() < 0.15);
    let sigma = object.covariance()[(3, 3)].max(object.covariance()[(4, 4)]).sqrt();
    assert!(sigma < 0.5 && off.norm() < 2.5 * sigma, "{off} with {sigma}");
}

#[test]
fn from_one_place_nothing_is_claimed() {
    assert_eq!(drive("tv", 0.01).slam.objects().count(), 0);
}

#[test]
fn from_one_place_the_floor_says_how_far_off_it_is() {
    let run = drive("refrigerator", 0.01);
    let objects: Vec<_> = run.slam.objects().collect();
    let [object] = objects[..] else { panic!("{} objects", objects.len()) };
    let off = object.ellipsoid().center().coords - Vector3::from(PLACE);
    // Half of its depth, which is a guess, and a pixel of its lower side, which is 0.1 m.
    assert!(object.is_glimpsed() && off.norm() < 0.4, "{off}");
}
