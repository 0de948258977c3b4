//! A whole run past a table, with real depth images.

use super::{Run, at, boxes_with, camera_info, odometry_at, transform};
use crate::scene::{Scene, camera, detection, looking, standing};
use ellipsoid_slam::{
    geometry::{Pose, intersection_over_union},
    mapping::MapObject,
    pipeline::{CameraRole, DepthMessage, Input, Settings},
};
use nalgebra::Vector3;

struct Passage {
    run: Run,
    scene: Scene,
    keyboard: usize,
    cabinet: usize,
}

/// Past a table with a keyboard and a cabinet on the floor, looking to the left and down.
fn passage() -> Passage {
    let mut scene = Scene::with_floor();
    scene.add(standing(0.0, [0.8, 1.5, 0.735], [0.6, 0.35, 0.015]));
    let keyboard = scene.add(standing(0.2, [0.7, 1.4, 0.765], [0.22, 0.075, 0.015]));
    let cabinet = scene.add(standing(-0.4, [2.2, 1.7, 0.35], [0.3, 0.2, 0.35]));
    let base_from_camera = looking([0.0, 0.0, 1.3], 1.3, 30.0);
    let mut run = Run::new(Settings::default());
    run.feed([
        camera_info(CameraRole::Color, "camera", camera()),
        transform(true, 0, ["base_link", "camera"], base_from_camera),
    ]);
    for i in 0..9 {
        let ms = 200 * i64::from(i);
        let odom_from_base = Pose::translation(0.2 * f64::from(i), 0.0, 0.0);
        let seed = Some(i as u64);
        let view = scene.seen_with(&(odom_from_base * base_from_camera), seed);
        let mut detections = Vec::new();
        for (label, thing) in [("keyboard", keyboard), ("cabinet", cabinet)] {
            detections.extend(view.try_box_around(thing).map(|rect| detection(label, rect)));
        }
        run.feed([
            odometry_at(ms, odom_from_base),
            Input::Depth(DepthMessage {
                stamp: at(ms),
                frame_id: "camera".into(),
                image: view.depth,
            }),
            boxes_with(ms, detections),
        ]);
    }
    run.finish();
    Passage { run, scene, keyboard, cabinet }
}

#[test]
fn a_drive_past_two_things_gives_a_map_of_two() {
    let passage = passage();
    let objects: Vec<&MapObject> = passage.run.slam.objects().collect();
    let mut labels: Vec<&str> = objects.iter().map(|o| o.label()).collect();
    labels.sort_unstable();
    assert_eq!(labels, ["cabinet", "keyboard"]);
    for object in objects {
        let (thing, enough, below) = match object.label() {
            // A centimetre more or less in 3 cm of height is half of the volume.
            "keyboard" => (passage.keyboard, 0.45, 0.75),
            _ => (passage.cabinet, 0.75, 0.0),
        };
        let truth = passage.scene.thing(thing);
        let iou = intersection_over_union(&(&object.ellipsoid()).into(), truth);
        assert!(iou > enough, "{}: IoU {iou}", object.label());
        let support = object.support_height_m.unwrap();
        assert!((support - below).abs() < 0.015, "{} stands at {support}", object.label());
        let up = object.ellipsoid().pose.rotation * Vector3::z();
        assert!((up - Vector3::z()).norm() < 1e-9, "upright");
        let s = object.ellipsoid().semi_axes;
        assert!(s.x >= s.y, "the longer axis comes first");
    }
}

#[test]
fn two_runs_are_the_same_bit_by_bit() {
    let text =
        |p: &Passage| format!("{:?}{:?}", p.run.total, p.run.slam.objects().collect::<Vec<_>>());
    assert_eq!(text(&passage()), text(&passage()));
}
