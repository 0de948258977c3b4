//! What an image may cost: boxes and names beyond a limit are left out, and counted.

use super::{Run, at, boxes_with, camera_info, depth, odometry, odometry_at, transform};
use crate::scene::{Scene, camera, looking, standing};
use cpu_time::ThreadTime;
use ellipsoid_slam::{
    geometry::{Pose, Rect},
    perception::Detection,
    pipeline::{CameraRole, DepthMessage, Input, Settings},
};

fn detection(index: usize, names: usize) -> Detection {
    let x = (index % 12) as f64;
    let rect = Rect::new(x, 1.0, x + 3.0, 9.0).unwrap();
    let probability = 0.9 - 1e-5 * ((index * 7919) % 10_007) as f64;
    let names = (0..names).map(|n| (format!("name {n}"), probability / (n + 1) as f64));
    Detection::new(rect, names.collect()).unwrap()
}

fn run_with(detections: Vec<Detection>) -> Run {
    let mut run = Run::ready();
    run.feed([odometry(0), odometry(200), depth(100), boxes_with(100, detections)]);
    run
}

#[test]
fn the_most_probable_boxes_are_looked_at_in_their_order_and_the_rest_is_counted() {
    let all: Vec<Detection> = (0..2000).map(|index| detection(index, 1)).collect();
    let run = run_with(all.clone());
    let looked: Vec<f64> =
        run.total.keyframes[0].boxes.iter().map(|b| b.detection.probability()).collect();
    let mut best: Vec<f64> = all.iter().map(Detection::probability).collect();
    best.sort_by(|a, b| b.total_cmp(a));
    best.truncate(100);
    let in_order: Vec<f64> =
        all.iter().map(Detection::probability).filter(|p| *p >= best[99]).collect();
    assert_eq!(looked, in_order);
    assert_eq!(run.dropped(), [(100, "too_many_boxes")]);
    assert_eq!(run.total.dropped[0].stamp, at(100));
    assert!(run.total.dropped[0].why.contains("2000 boxes: the 100 most"));
}

#[test]
fn the_most_probable_names_of_a_box_count() {
    let run = run_with(vec![detection(0, 100_000), detection(1, 3)]);
    let boxes = &run.total.keyframes[0].boxes;
    assert_eq!(boxes[0].detection.hypotheses().len(), 10);
    assert_eq!(boxes[0].detection.label(), "name 0");
    assert_eq!(boxes[1].detection.hypotheses().len(), 3);
    assert_eq!(run.dropped(), [(100, "too_many_names")]);
}

/// Seconds an image, of images with so many boxes of so many names, all of one cabinet.
fn cost(boxes: usize, names: usize) -> f64 {
    let mut scene = Scene::with_floor();
    let cabinet = scene.add(standing(-0.4, [2.2, 0.3, 0.35], [0.3, 0.2, 0.35]));
    let base_from_camera = looking([0.0, 0.0, 1.0], 0.1, 20.0);
    let view = scene.seen_with(&base_from_camera, Some(1));
    let rect = view.box_around(cabinet);
    let detections = (0..boxes).map(|index| {
        let [dx, dy] = [7.0, 11.0].map(|turn: f64| 4.0 * (turn * index as f64).sin());
        let near = Rect::new(rect.x_min + dx, rect.y_min + dy, rect.x_max + dx, rect.y_max + dy);
        let probability = 0.4 + 0.1 * (3.0 * index as f64).cos();
        let names = (0..names).map(|n| (format!("name {n}"), probability / (1 + n) as f64));
        Detection::new(near.unwrap(), names.collect()).unwrap()
    });
    let detections: Vec<Detection> = detections.collect();
    let mut run = Run::new(Settings::default());
    run.feed([
        camera_info(CameraRole::Color, "camera", camera()),
        transform(true, 0, ["base_link", "camera"], base_from_camera),
    ]);
    const IMAGES: i64 = 3;
    let inputs = (0..IMAGES).flat_map(|image| {
        let (ms, frame_id) = (100 * image, "camera".into());
        let depth = DepthMessage { stamp: at(ms), frame_id, image: view.depth.clone() };
        let boxes = boxes_with(ms, detections.clone());
        [odometry_at(ms, Pose::identity()), Input::Depth(depth), boxes]
    });
    let inputs: Vec<Input> = inputs.collect();
    let started = ThreadTime::now();
    run.feed(inputs);
    run.finish();
    let seconds = started.elapsed().as_secs_f64() / IMAGES as f64;
    assert_eq!(run.total.keyframes.len(), IMAGES as usize);
    println!("{boxes} boxes of {names} names: {:.0} ms an image", 1e3 * seconds);
    seconds
}

#[test]
fn boxes_and_names_beyond_the_limits_cost_next_to_nothing() {
    let usual = cost(100, 1);
    for (boxes, names) in [(300, 1), (2000, 1), (100, 10), (100, 365), (20, 10_000)] {
        let most = 2.0 * usual + 0.02;
        let seconds = cost(boxes, names);
        assert!(seconds < most, "{boxes} boxes of {names} names: {seconds:.3} s, not {most:.3}");
    }
}
