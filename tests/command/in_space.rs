//! A bag with objects that a detector measured in space, and no images.

use crate::run::{run, stderr};
use ellipsoid_slam::{
    geometry::Pose,
    io::BagWriter,
    msg::convert::{detection_3d_array, odometry_message, tf_message},
    perception::Detection3d,
    pipeline::{Detections3dMessage, OdometryMessage, StampedTransform},
    time::Stamp,
};
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use serde_json::Value;
use std::{fs, path::Path};

/// A robot drives 3 m along x past a suitcase at (2, 1.5, 0.25), which its camera sees. The camera is 0.5 m above the base and looks
/// along the base's y, to the left.
fn write_bag(path: &Path, frame: &str) {
    let mut bag = BagWriter::create(path).unwrap();
    let stamp = |index: u32| Stamp::from_secs(1_700_000_000.0 + 0.1 * f64::from(index));
    let axes = [Vector3::x(), -Vector3::z(), Vector3::y()];
    let turned = nalgebra::Rotation3::from_basis_unchecked(&axes);
    let base_from_camera = Pose::from_parts(
        Translation3::new(0.0, 0.0, 0.5),
        UnitQuaternion::from_rotation_matrix(&turned),
    );
    let transform = StampedTransform {
        stamp: stamp(0),
        frame_id: "base_link".into(),
        child_frame_id: "oak_rgb_camera_optical_frame".into(),
        parent_from_child: base_from_camera,
    };
    bag.write("/tf_static", &tf_message(&[transform]), stamp(0)).unwrap();
    for index in 0..30 {
        let odom_from_base = Pose::translation(0.1 * f64::from(index), 0.0, 0.0);
        let reading = OdometryMessage {
            stamp: stamp(index),
            frame_id: "odom".into(),
            child_frame_id: "base_link".into(),
            odom_from_base,
            covariance: None,
        };
        bag.write("/odom", &odometry_message(&reading), stamp(index)).unwrap();
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.3);
        let odom_from_case = Pose::from_parts(Translation3::new(2.0, 1.5, 0.25), turn);
        let pose = (odom_from_base * base_from_camera).inverse() * odom_from_case;
        let extents = Some(Vector3::new(0.6, 0.3, 0.5));
        let names = vec![("suitcase".into(), 0.9)];
        let one = Detection3d::new(frame.into(), pose, extents, names).unwrap();
        let message = Detections3dMessage { stamp: stamp(index), detections: vec![one] };
        let at = stamp(index).shifted(0.05);
        bag.write("/oak/nn/spatial_detections", &detection_3d_array(&message), at).unwrap();
    }
    bag.finish().unwrap();
}

#[test]
fn a_bag_of_detections_in_space_gives_a_map() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (bag, out) = (path("drive.mcap"), path("out"));
    write_bag(Path::new(&bag), "oak_rgb_camera_optical_frame");
    let inspected = run(&["inspect", &bag]);
    let text = String::from_utf8_lossy(&inspected.stdout).into_owned();
    assert!(inspected.status.success(), "{text}{}", stderr(&inspected));
    assert!(text.contains("detections_3d      /oak/nn/spatial_detections (30 messages"), "{text}");
    assert!(text.contains("This bag can be replayed as it is."), "{text}");
    let replayed = run(&["replay", &bag, "--output", &out]);
    assert!(replayed.status.success(), "{}", stderr(&replayed));
    let map = fs::read_to_string(Path::new(&out).join("map.json")).unwrap();
    let map: Value = serde_json::from_str(&map).unwrap();
    let [case] = &map["objects"].as_array().unwrap()[..] else { panic!("{map:#}") };
    assert_eq!(case["label"], "suitcase");
    let at = &case["position"];
    for (number, expected) in at.as_array().unwrap().iter().zip([2.0, 1.5, 0.25]) {
        assert!((number.as_f64().unwrap() - expected).abs() < 0.02, "{case:#}");
    }
    let trajectory = fs::read_to_string(Path::new(&out).join("trajectory.tum")).unwrap();
    assert_eq!(trajectory.lines().count(), 30);
}

#[test]
fn a_frame_that_nothing_connects_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let bag = path("drive.mcap");
    write_bag(Path::new(&bag), "moon");
    let inspected = run(&["inspect", &bag]);
    let text = String::from_utf8_lossy(&inspected.stdout).into_owned();
    assert!(!inspected.status.success() && text.contains("`moon`"), "{text}");
    let replayed = run(&["replay", &bag, "--output", &path("out")]);
    assert!(
        stderr(&replayed).contains("no transform connects \"moon\" to \"base_link\""),
        "{}",
        stderr(&replayed)
    );
}
