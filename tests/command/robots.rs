//! The configurations that are shipped, each with a drive of its robot: its topics, frames, sizes and noise.

use crate::run::{run, stderr};
use serde_json::Value;
use std::{fs, path::Path};

const FRAMES: u64 = 16;

/// Drives through the home and maps what it sees; gives the summary and how the map compares with the truth.
fn mapped(robot: &str) -> (Value, Value) {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let succeeds = |args: &[&str]| {
        let output = run(args);
        assert!(output.status.success(), "{}", stderr(&output));
        output.stdout
    };
    let (bag, out, truth) = (path("drive.mcap"), path("out"), path("drive.gt.json"));
    let (frames, config) = (FRAMES.to_string(), format!("config/{robot}.yaml"));
    // Drivers send images as they are.
    let drive = ["--scene", "home", "--trajectory", "forward", "--seed", "17", "--raw"];
    let robot = ["--robot", robot, "--frames", &frames, "--output", &bag];
    succeeds(&[&["simulate"], &drive[..], &robot[..]].concat());
    succeeds(&["replay", &bag, "--config", &config, "--output", &out, "--no-report"]);
    let scores = succeeds(&["eval", &out, "--ground-truth", &truth, "--json"]);
    let summary = fs::read_to_string(Path::new(&out).join("summary.json")).unwrap();
    let scores: Value = serde_json::from_slice(&scores).unwrap();
    (serde_json::from_str(&summary).unwrap(), scores["objects"].clone())
}

/// The topics are those that the configuration names, all images are used, and what was seen is found.
fn check(robot: &str, recall: f64, most_m: f64) {
    let (summary, scores) = mapped(robot);
    let path = format!("{}/config/{robot}.yaml", env!("CARGO_MANIFEST_DIR"));
    let config = fs::read_to_string(path).unwrap();
    for role in ["rgb", "depth", "camera_info", "detections", "odometry"] {
        let topic = summary["topics"][role].as_str().unwrap();
        let named = format!("{role}: {topic}");
        assert!(config.lines().any(|line| line.trim_start() == named), "{named}");
    }
    assert_eq!(summary["keyframes"], FRAMES, "{summary:#}");
    println!("{robot}: recall {}, centres {} m off", scores["recall"], scores["translation_m"]);
    assert!(scores["recall"].as_f64().unwrap() >= recall, "{scores:#}");
    assert!(scores["precision"].as_f64().unwrap() >= 0.7, "{scores:#}");
    assert!(scores["translation_m"].as_f64().unwrap() < most_m, "{scores:#}");
}

#[test]
fn a_turtlebot4_with_depth_of_another_size_than_colour_gives_a_map() {
    check("turtlebot4", 0.8, 0.35);
}

#[test]
fn a_realsense_gives_a_map() {
    check("realsense", 0.8, 0.2);
}

#[test]
fn a_kinect_gives_a_map() {
    check("kinect", 0.8, 0.2);
}
