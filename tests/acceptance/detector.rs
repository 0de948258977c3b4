//! The detector on real images: its boxes are those that the same network gave in another runtime.

use crate::run;
use ellipsoid_slam::{
    io::BagInput,
    perception::Detection,
    pipeline::{DetectionsMessage, Input},
};
use std::{
    env,
    path::{Path, PathBuf},
};

fn boxes(bag: &Path) -> Vec<DetectionsMessage> {
    let input = BagInput::open(bag, &[]).unwrap();
    let of_detector = |input| match input {
        Input::Detections(boxes) => Some(boxes),
        _ => None,
    };
    input.inputs().filter_map(of_detector).collect()
}

fn best_overlap(wanted: &Detection, found: &[Detection]) -> f64 {
    let same_class = found.iter().filter(|other| other.label() == wanted.label());
    same_class.map(|other| other.rect.overlap(&wanted.rect)).fold(0.0, f64::max)
}

#[test]
fn its_boxes_are_those_of_another_runtime() {
    let data = PathBuf::from(env::var("ELLIPSOID_SLAM_DATA").unwrap());
    let model = data.join("../models/yolox_nano.onnx");
    let folder = tempfile::tempdir().unwrap();
    let [recorded, detected] = ["recorded.mcap", "detected.mcap"].map(|n| folder.path().join(n));
    let source = data.join("tum_fr1_rpy");
    run(&["import".as_ref(), "tum".as_ref(), &source, "--output".as_ref(), &recorded]);
    print!(
        "{}",
        run(&[
            "detect".as_ref(),
            &recorded,
            "--model".as_ref(),
            &model,
            "--output".as_ref(),
            &detected
        ])
    );
    let (theirs, ours) = (boxes(&recorded), boxes(&detected));
    assert_eq!(theirs.len(), ours.len());
    let mut overlaps = Vec::new();
    for (theirs, ours) in theirs.iter().zip(&ours) {
        assert_eq!(theirs.stamp, ours.stamp);
        let certain = theirs.detections.iter().filter(|wanted| wanted.probability() > 0.4);
        overlaps.extend(certain.map(|wanted| best_overlap(wanted, &ours.detections)));
    }
    let share = |above: f64| {
        overlaps.iter().filter(|overlap| **overlap > above).count() as f64 / overlaps.len() as f64
    };
    let shares =
        [0.85, 0.9, 0.95].map(|above| format!("{:.1} % above {above}", 100.0 * share(above)));
    println!("  {} boxes, IoU: {}", overlaps.len(), shares.join(", "));
    // Theirs are of the benchmark's images, ours of JPEGs of them: onnxruntime on the same JPEGs has 92 % above 0.95.
    assert!(share(0.9) > 0.99 && share(0.95) > 0.9);
}
