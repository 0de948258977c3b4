//! A whole run past a table, with real depth images.

use super::{Run, add, at, boxes_with, camera_info, odometry_at, transform};
use crate::scene::{Scene, camera, detection, looking, standing};
use ellipsoid_slam::{
    geometry::{Pose, intersection_over_union},
    mapping::MapObject,
    pipeline::{
        CameraRole, DepthMessage, FrontEnd, Input, ObjectSlam, Perceived, Settings, Update,
    },
};
use nalgebra::Vector3;

/// Past a table with a keyboard and a cabinet on the floor, looking to the left and down.
struct Passage {
    scene: Scene,
    keyboard: usize,
    cabinet: usize,
    inputs: Vec<Input>,
}

impl Passage {
    fn new() -> Self {
        let mut scene = Scene::with_floor();
        scene.add(standing(0.0, [0.8, 1.5, 0.735], [0.6, 0.35, 0.015]));
        let keyboard = scene.add(standing(0.2, [0.7, 1.4, 0.765], [0.22, 0.075, 0.015]));
        let cabinet = scene.add(standing(-0.4, [2.2, 1.7, 0.35], [0.3, 0.2, 0.35]));
        let base_from_camera = looking([0.0, 0.0, 1.3], 1.3, 30.0);
        let mut inputs = vec![
            camera_info(CameraRole::Color, "camera", camera()),
            transform(true, 0, ["base_link", "camera"], base_from_camera),
        ];
        for i in 0..9 {
            let ms = 200 * i64::from(i);
            let odom_from_base = Pose::translation(0.2 * f64::from(i), 0.0, 0.0);
            let view = scene.seen_with(&(odom_from_base * base_from_camera), Some(i as u64));
            let mut detections = Vec::new();
            for (label, thing) in [("keyboard", keyboard), ("cabinet", cabinet)] {
                detections.extend(view.try_box_around(thing).map(|rect| detection(label, rect)));
            }
            let (stamp, frame_id) = (at(ms), "camera".into());
            inputs.extend([
                odometry_at(ms, odom_from_base),
                Input::Depth(DepthMessage { stamp, frame_id, image: view.depth }),
                boxes_with(ms, detections),
            ]);
        }
        Self { scene, keyboard, cabinet, inputs }
    }

    fn run(&self) -> Run {
        let mut run = Run::new(Settings::default());
        run.feed(self.inputs.clone());
        run.finish();
        run
    }
}

#[test]
fn a_drive_past_two_things_gives_a_map_of_two() {
    let passage = Passage::new();
    let run = passage.run();
    let objects: Vec<&MapObject> = run.slam.objects().collect();
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

fn text(total: &Update, slam: &ObjectSlam) -> String {
    format!("{total:?}{:?}", slam.objects().collect::<Vec<_>>())
}

#[test]
fn two_runs_are_the_same_bit_by_bit() {
    let run = || {
        let run = Passage::new().run();
        text(&run.total, &run.slam)
    };
    assert_eq!(run(), run());
}

/// However far ahead of the map: an image never waits for the graph, and nothing else comes out.
#[test]
fn a_front_end_that_runs_ahead_changes_nothing() {
    let passage = Passage::new();
    let mut front_end = FrontEnd::new(Settings::default());
    let mut perceived: Vec<Perceived> =
        passage.inputs.iter().map(|input| front_end.take(input.clone(), &mut ())).collect();
    perceived.push(front_end.finish(&mut ()));

    let mut slam = ObjectSlam::new(Settings::default());
    let mut total = Update::default();
    for perceived in perceived {
        add(&mut total, &slam.join(perceived, &mut ()));
    }
    add(&mut total, &slam.finish(&mut ()));
    let together = passage.run();
    assert_eq!(total.keyframes.len(), 9);
    assert_eq!(text(&total, &slam), text(&together.total, &together.slam));
}

/// As after a reset of the node: calibrations and static transforms are said only once.
#[test]
fn a_front_end_serves_the_next_map_too() {
    let passage = Passage::new();
    let mut front_end = FrontEnd::new(Settings::default());
    let mut of_half = |inputs: &[Input]| {
        let mut slam = ObjectSlam::new(Settings::default());
        let mut total = Update::default();
        for input in inputs {
            add(&mut total, &slam.join(front_end.take(input.clone(), &mut ()), &mut ()));
        }
        (total.keyframes.len(), total.dropped, slam.frames() == ("odom", "base_link"))
    };
    let (first, second) = passage.inputs.split_at(2 + 3 * 4);
    assert_eq!(of_half(first), (4, Vec::new(), true));
    assert_eq!(of_half(second), (5, Vec::new(), true));
}
