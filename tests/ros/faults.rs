//! What goes wrong is named in one log line and in diagnostics; then work goes on.

use crate::processes::{BAG, BAG_TOPICS, Running, Stage, now, succeeded};
use std::time::Duration;

/// A sentence of the log, and a part of it that says which.
const FAULTS: [(&str, &str); 7] = [
    ("no publisher", "nobody publishes /detections (detections, vision_msgs/msg/Detection2DArray)"),
    ("wrong type", "/detections is published as sensor_msgs/msg/CameraInfo, but detections needs"),
    ("malformed CDR", "/depth/image: the bytes are not a sensor_msgs/msg/Image"),
    (
        "incompatible QoS",
        "the quality of service of /rgb/camera_info does not match: camera_info asks for reliable",
    ),
    (
        "wrong size",
        "/depth/image: an image of 4x4 in 16UC1 with 8 bytes a row does not fit 7 bytes",
    ),
    ("time back", "the stamps of /odom went back by 90.0 s"),
    ("silent publisher", "/odom (odometry) has a publisher, but nothing comes"),
];

#[test]
fn faults_of_publishers_are_named_once_and_in_diagnostics() {
    let stage = Stage::new();
    let mut args = vec!["-p", "qos.camera_info:=reliable"];
    let named = [
        "topics.rgb:=''",
        "topics.depth:=depth/image",
        "topics.camera_info:=rgb/camera_info",
        "topics.depth_camera_info:=''",
        "topics.odometry:=odom",
        "topics.detections:=detections",
    ];
    args.extend(named.iter().flat_map(|topic| ["-p", topic]));
    let node = stage.node(&args);
    node.wait_for("runs in domain");
    let _malformed = stage.start(stage.peer("cyclone_malformed.py", &[]), "malformed");
    let sentences = FAULTS.map(|(_, words)| words);
    let peer = stage.peer("rclpy_faults.py", &sentences).output().unwrap();
    succeeded(&peer, &node);
    let log = node.log();
    for (fault, words) in FAULTS {
        let lines = log.lines().filter(|l| l.contains(words) && l.contains("WARN"));
        assert_eq!(lines.count(), 1, "{fault}: `{words}` in\n{log}");
    }
}

#[test]
fn work_resumes_when_transforms_come_and_a_second_node_of_the_name_is_named() {
    let stage = Stage::new();
    let node = stage.node(&BAG_TOPICS);
    node.wait_for("runs in domain");
    let mut twin = stage.node_as("twin", &BAG_TOPICS);
    in_diagnostics(&stage, &node, &["another node is called /ellipsoid_slam too"]);
    twin.stop("TERM");
    node.wait_for("no longer: another node");

    let without = "/odom,/camera/aligned_depth_to_color/image_raw/compressedDepth,/camera/color/camera_info,/detections";
    let play = ["play", BAG, "--rate", "4", "--wait", "60", "--topics", without];
    succeeded(&stage.program(&play).output().unwrap(), &node);
    in_diagnostics(&stage, &node, &["no transform connects"]);
    // The same time once more, now with transforms: the bag is started again.
    succeeded(
        &stage.program(&["play", BAG, "--rate", "2", "--wait", "60"]).output().unwrap(),
        &node,
    );
    node.wait_for("went back by");
    in_diagnostics(&stage, &node, &["objects=1"]);
}

#[test]
fn images_of_another_size_are_named_and_a_killed_publisher_may_come_back() {
    let stage = Stage::new();
    let mut args = vec!["-r", "rgb/camera_info:=/another/camera_info"];
    args.extend(BAG_TOPICS);
    let node = stage.node(&args);
    node.wait_for("runs in domain");
    let play = || stage.program(&["play", BAG, "--loop", "--wait", "60"]);
    let mut player = stage.start(play(), "player");
    let frame = "camera_color_optical_frame";
    let named = "the depth image is 640x480, the camera info says 8x6";
    in_diagnostics(&stage, &node, &[named, "--calibration", "8", "6", frame]);
    player.stop("KILL");
    let silent = "/odom (odometry) has a publisher, but nothing comes";
    node.wait_for(silent);
    let _again = stage.start(play(), "player_again");
    node.wait_for(&format!("no longer: {silent}"));
}

#[test]
fn an_interrupted_node_leaves_the_graph_at_once() {
    let stage = Stage::new();
    let mut node = stage.node(&[]);
    let peer = stage.start(stage.peer("rclpy_graph.py", &[]), "peer");
    peer.wait_for("it is there");
    assert!(node.stop("INT").success(), "{}", node.log());
    let left = now();
    peer.wait_for("it is gone");
    // Others forget one that says no goodbye after ten seconds at the earliest.
    assert!(left.elapsed() < Duration::from_secs(5), "{:?}", left.elapsed());
}

#[cfg(not(feature = "zenoh"))]
#[test]
fn zenoh_in_a_program_without_it_is_named() {
    let stage = Stage::new();
    for command in [&["node"][..], &["play", BAG]] {
        let asked = stage.program(command).env("RMW_IMPLEMENTATION", "rmw_zenoh_cpp").output();
        let asked = asked.unwrap();
        assert_eq!(asked.status.code(), Some(1));
        let said = String::from_utf8_lossy(&asked.stderr);
        assert!(said.contains("built without it: build it with `--features zenoh`"), "{said}");
    }
}

/// Waits until diagnostics have had all of this.
pub(crate) fn in_diagnostics(stage: &Stage, node: &Running, arguments: &[&str]) {
    let peer = stage.peer("rclpy_diagnostics.py", arguments).output().unwrap();
    succeeded(&peer, node);
}
