//! ROS 2's own client library on Fast DDS receives, asks and sets.

use crate::processes::{BAG, BAG_TOPICS, Stage, succeeded};
use std::fs;

#[test]
fn a_played_bag_gives_rclpy_the_objects_of_a_replay() {
    let stage = Stage::new();
    let map = stage.path("map.json");
    let save = format!("map.file:={map}");
    let reliable = ["depth", "camera_info", "odometry", "detections"]
        .map(|topic| format!("qos.{topic}:=reliable"));
    let mut args: Vec<&str> = BAG_TOPICS.to_vec();
    args.extend(["-p", "map.save_on_shutdown:=true", "-p", &save]);
    args.extend(reliable.iter().flat_map(|qos| ["-p", qos.as_str()]));
    let mut node = stage.node(&args);
    node.wait_for("runs in domain");
    let play = stage.program(&["play", BAG, "--rate", "2", "--wait", "60"]).output().unwrap();
    succeeded(&play, &node);
    let markers = stage.path("markers.json");
    let peer = stage.peer("rclpy_peer.py", &[&markers]).output().unwrap();
    succeeded(&peer, &node);
    assert!(node.stop("INT").success(), "{}", node.log());

    let replayed = stage.path("replay");
    let replay = stage.program(&["replay", BAG, "--output", &replayed]).output().unwrap();
    succeeded(&replay, &node);
    let expected = fs::read_to_string(format!("{replayed}/map.json")).unwrap();
    assert_eq!(fs::read_to_string(map).unwrap(), expected, "{}", node.log());
    check_markers(&fs::read_to_string(markers).unwrap(), &expected);
}

/// What rclpy received says the same as the map, but for the last keyframe and the last optimisation, which came later.
fn check_markers(received: &str, map: &str) {
    const LATER_M: f64 = 0.04;
    let received: serde_json::Value = serde_json::from_str(received).unwrap();
    let map: serde_json::Value = serde_json::from_str(map).unwrap();
    let objects = map["objects"].as_array().unwrap();
    let markers = received["ellipsoids"].as_object().unwrap();
    assert!(markers.len() >= 5 && markers.len() <= objects.len(), "{received}");
    for (id, marker) in markers {
        let object = objects.iter().find(|object| object["id"].to_string() == *id).unwrap();
        let numbers = |value: &serde_json::Value| -> Vec<f64> {
            value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
        };
        let near = |a: &[f64], b: &[f64]| {
            assert_eq!(a.len(), b.len());
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < LATER_M), "{id}: {a:?} {b:?}");
        };
        near(&numbers(&marker["position"]), &numbers(&object["position"]));
        let extents: Vec<f64> = numbers(&object["semi_axes"]).iter().map(|a| 2.0 * a).collect();
        near(&numbers(&marker["scale"]), &extents);
        let label = received["labels"][id].as_str().unwrap();
        assert!(label.starts_with(object["label"].as_str().unwrap()), "{label}");
    }
}
