//! A node to which nobody named its topics.

use crate::processes::{Stage, succeeded};

/// A RealSense, a detector and two odometries; `=` marks what is to be chosen.
const PUBLISHED: [&str; 9] = [
    "=c:/camera/camera/color/camera_info",
    "i:/camera/camera/color/image_raw",
    "i:/camera/camera/depth/image_rect_raw",
    "c:/camera/camera/depth/camera_info",
    "=i:/camera/camera/aligned_depth_to_color/image_raw",
    "=c:/camera/camera/aligned_depth_to_color/camera_info",
    "=b:/yolo/boxes",
    "o:/odometry/filtered",
    "=o:/odom",
];

#[test]
fn a_node_finds_its_topics_and_says_which() {
    let stage = Stage::new();
    let node = stage.node(&[]);
    node.wait_for(
        "no topic is found for depth, camera_info, detections: name one with `-r depth:=/topic`",
    );
    let peer = stage.peer("cyclone_cameras.py", &PUBLISHED).output().unwrap();
    succeeded(&peer, &node);
    for words in [
        "depth comes from /camera/camera/aligned_depth_to_color/image_raw, rather than \
         /camera/camera/depth/image_rect_raw, which is not aligned to colour",
        "odometry comes from /odom, rather than /odometry/filtered, which is not called odom",
        "detections comes from /yolo/boxes",
    ] {
        node.wait_for(words);
    }
}

#[test]
fn remappings_of_nothing_are_errors_that_list_what_there_is() {
    let stage = Stage::new();
    for (rule, status) in [("depht:=/camera/depth", 2), ("depth_image:=/camera/depth", 2)] {
        let output = stage.program(&["node", "--ros-args", "-r", rule]).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(status), "{said}");
        let name = rule.split(":=").next().unwrap();
        assert!(said.contains(&format!("`-r {name}:=...` remaps nothing")), "{said}");
        assert!(said.contains("depth/image") && said.contains("~/markers"), "{said}");
    }
}

/// A bag without boxes is a robot without a detector node: colour images, depth and the rest are found, and boxes come from a
/// network that gives the same two for every image.
#[cfg(feature = "detector")]
#[test]
fn a_node_with_a_model_needs_no_detector() {
    use crate::{faults::in_diagnostics, onnx::model, processes::BAG};
    let stage = Stage::new();
    let mut boxes = vec![0.0; 10 * 6];
    boxes[..6].copy_from_slice(&[20.0, 20.0, 40.0, 40.0, 0.9, 0.0]);
    let (file, labels) = (stage.path("constant.onnx"), stage.path("labels.txt"));
    std::fs::write(&file, model(&[1, 3, 64, 64], &[(&[1, 10, 6], boxes)])).unwrap();
    std::fs::write(&labels, "monitor\n").unwrap();
    let settings = [format!("detector.model:={file}"), format!("detector.labels:={labels}")];
    let node = stage.node(&settings.iter().flat_map(|s| ["-p", s.as_str()]).collect::<Vec<_>>());
    node.wait_for("boxes are found by a model of the form end_to_end for 64x64");
    let topics = "/camera/color/image_raw/compressed,/camera/color/camera_info,/odom,/tf,/tf_static,\
                  /camera/aligned_depth_to_color/image_raw/compressedDepth";
    let play = ["play", BAG, "--rate", "2", "--wait", "60", "--topics", topics];
    succeeded(&stage.program(&play).output().unwrap(), &node);
    node.wait_for("rgb comes from /camera/color/image_raw/compressed");
    in_diagnostics(&stage, &node, &["keyframes=5"]);
}
