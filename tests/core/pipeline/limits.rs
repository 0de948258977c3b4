//! What an image may cost: boxes and names beyond a limit are left out, and counted.

use super::{Run, at, boxes_with, depth, odometry};
use ellipsoid_slam::{geometry::Rect, perception::Detection};

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
