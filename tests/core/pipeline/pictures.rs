//! A box that stays on a flat wall is a picture of a thing, and no thing.

use super::{Run, at, boxes_with, camera_info, odometry_at, transform};
use crate::scene::{Scene, camera, detection, looking, standing};
use ellipsoid_slam::{
    geometry::{Pose, Rect},
    pipeline::{CameraRole, DepthMessage, Input, Settings},
};
use nalgebra::Point3;

/// What a robot makes of a chair's box in 30 images of a wall 2 m ahead, standing or on its way along the wall.
fn objects(before_wall: Option<[f64; 3]>, is_moving: bool, label: &str) -> usize {
    let mut scene = Scene::with_floor();
    scene.add(standing(0.0, [2.05, 0.0, 1.3], [0.05, 4.0, 1.3]));
    if let Some([x, half, high]) = before_wall {
        scene.add(standing(0.0, [x, 0.0, 0.5 * high], [half, half, 0.5 * high]));
    }
    let base_from_camera = looking([0.0, 0.0, 0.6], 0.0, 0.0);
    let mut run = Run::new(Settings::default());
    run.feed([
        camera_info(CameraRole::Color, "camera", camera()),
        transform(true, 0, ["base_link", "camera"], base_from_camera),
    ]);
    for image in 0..30 {
        let ms = 200 * i64::from(image);
        let aside = if is_moving { 0.4 - 0.027 * f64::from(image) } else { 0.0 };
        let odom_from_base = Pose::translation(0.0, aside, 0.0);
        let view = scene.seen_with(&(odom_from_base * base_from_camera), Some(image as u64));
        let eye = camera();
        // As large as a chair before the wall is, and above the floor.
        let middle = eye.project(&Point3::new(aside, -0.1, 2.0)).unwrap();
        let (u, v) = (middle.x, middle.y);
        let rect = Rect::new(u - 75.0, v - 110.0, u + 75.0, v + 110.0).unwrap();
        let (stamp, frame_id) = (at(ms), "camera".into());
        run.feed([
            odometry_at(ms, odom_from_base),
            Input::Depth(DepthMessage { stamp, frame_id, image: view.depth }),
            boxes_with(ms, vec![detection(label, rect)]),
        ]);
    }
    run.finish();
    run.slam.objects().count()
}

#[test]
fn a_picture_of_a_chair_is_no_chair() {
    assert_eq!(objects(None, false, "chair"), 0, "standing before it");
    assert_eq!(objects(None, true, "chair"), 0, "driving past it");
}

#[test]
fn a_chair_before_the_wall_is_one() {
    assert_eq!(objects(Some([1.7, 0.25, 0.9]), true, "chair"), 1);
}
