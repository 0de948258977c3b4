//! ROS 2's own client library on Fast DDS receives, asks and sets.

use crate::processes::{BAG, BAG_TOPICS, Stage, succeeded};
use ellipsoid_slam::{
    io::BagReader,
    msg::{
        cdr,
        visualization_msgs::{Marker, MarkerArray},
    },
};
use serde_json::{Value, json};
use std::{fs, path::Path};

#[test]
fn a_played_bag_gives_rclpy_the_objects_of_a_replay() {
    let stage = Stage::new();
    let map = stage.path("map.json");
    let save = format!("map.file:={map}");
    let reliable = ["depth", "camera_info", "odometry", "detections"]
        .map(|topic| format!("qos.{topic}:=reliable"));
    let mut args: Vec<&str> = BAG_TOPICS.to_vec();
    args.extend(["-p", "map.save_on_shutdown:=true", "-p", &save, "-p", "publish.costmap:=true"]);
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
    check_markers(&fs::read_to_string(markers).unwrap(), &format!("{replayed}/result.mcap"));
}

/// What rclpy received last is what a replay published at the same time.
pub(crate) fn check_markers(received: &str, result: &str) {
    let received: Value = serde_json::from_str(received).unwrap();
    assert!(received["ellipsoids"].as_object().unwrap().len() >= 5, "{received}");
    let bag = BagReader::open(Path::new(result)).unwrap();
    let published = bag.messages().filter(|message| &*message.topic == "/ellipsoid_slam/markers");
    let published = published.map(|message| summary(&cdr::decode(&message.data).unwrap()));
    let same_time: Vec<Value> = published.filter(|it| it["stamp"] == received["stamp"]).collect();
    assert!(same_time.contains(&received), "{received:#}\n{same_time:#?}");
}

/// As `rclpy_peer.py` writes it.
fn summary(array: &MarkerArray) -> Value {
    let (mut ellipsoids, mut labels, mut stamp) = (json!({}), json!({}), Value::Null);
    for marker in array.markers.iter().filter(|marker| marker.action == Marker::ADD) {
        let id = marker.id.to_string();
        stamp = json!([marker.header.stamp.sec, marker.header.stamp.nanosec]);
        let (p, q, s) = (&marker.pose.position, &marker.pose.orientation, &marker.scale);
        let numbers = [p.x, p.y, p.z, q.x, q.y, q.z, q.w, s.x, s.y, s.z];
        match marker.ns.as_str() {
            "objects" => ellipsoids[id] = numbers.map(|v| format!("{v:.9}")).to_vec().into(),
            "labels" => labels[id] = marker.text.clone().into(),
            _ => (),
        }
    }
    json!({"stamp": stamp, "ellipsoids": ellipsoids, "labels": labels})
}
