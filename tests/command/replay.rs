//! `replay`: what it finds and what it writes.

use crate::run::{FRAMES, Flaw, replayed, run, stamp, stderr, truth, write_bag};
use serde_json::Value;
use std::fs;

#[test]
fn finds_the_box_where_it_stands() {
    let (_folder, _, out) = replayed(Flaw::None);

    let map: Value =
        serde_json::from_str(&fs::read_to_string(out.join("map.json")).unwrap()).unwrap();
    assert_eq!((&map["version"], &map["frame_id"]), (&1.into(), &"map".into()));
    let objects = map["objects"].as_array().unwrap();
    assert_eq!(objects.len(), 1, "{map:#}");
    let object = &objects[0];
    assert_eq!(object["label"], "suitcase");
    assert_eq!(object["outline"], "cuboid");
    assert_eq!(object["observations"], FRAMES);
    assert_eq!(object["covariance"].as_array().unwrap().len(), 81);
    let (center, half) = truth();
    // Pixels are 1.5 cm wide at this range.
    for axis in 0..3 {
        let position = object["position"][axis].as_f64().unwrap();
        assert!((position - center[axis]).abs() < 0.02, "axis {axis}: {object:#}");
        let semi_axis = object["semi_axes"][axis].as_f64().unwrap();
        assert!((semi_axis - half[axis]).abs() < 0.02, "axis {axis}: {object:#}");
    }
    let trajectory = fs::read_to_string(out.join("trajectory.tum")).unwrap();
    let stamps: Vec<&str> = trajectory.lines().map(|l| l.split(' ').next().unwrap()).collect();
    let expected: Vec<String> = (0..FRAMES).map(|i| stamp(i).to_string()).collect();
    assert_eq!(stamps, expected);
    let timing = fs::read_to_string(out.join("timing.csv")).unwrap();
    assert_eq!(timing.lines().count(), 1 + FRAMES);
}

#[test]
fn the_same_bag_gives_the_same_bytes() {
    let bytes = || {
        let (_folder, _, out) = replayed(Flaw::None);
        ["map.json", "trajectory.tum", "trajectory_live.tum", "result.mcap"]
            .map(|file| fs::read(out.join(file)).unwrap())
    };
    assert!(bytes() == bytes(), "two replays differ");
}

#[test]
fn an_earlier_result_is_kept_unless_forced() {
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("box.mcap");
    write_bag(&bag, Flaw::None);
    let out = folder.path().join("out");
    let args = ["replay", bag.to_str().unwrap(), "--output", out.to_str().unwrap()];
    assert!(run(&args).status.success());
    let first = fs::metadata(out.join("map.json")).unwrap().modified().unwrap();
    let again = run(&args);
    assert_eq!(again.status.code(), Some(2));
    assert!(stderr(&again).contains("--force"), "{}", stderr(&again));
    assert_eq!(fs::metadata(out.join("map.json")).unwrap().modified().unwrap(), first);
    assert!(run(&[&args[..], &["--force"]].concat()).status.success());
}

#[test]
fn a_single_bad_message_is_counted_and_the_rest_used() {
    let (_folder, _, out) = replayed(Flaw::NanPose);
    let summary: Value =
        serde_json::from_str(&fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
    assert_eq!(summary["skipped_messages"]["/odom"]["bad_pose"], 1, "{summary:#}");
    // The pose of that image is interpolated from its neighbours.
    assert_eq!(summary["keyframes"], FRAMES, "{summary:#}");
}
