//! Objects that a detector measured in space.

use crate::fixtures::header;
use ellipsoid_slam::msg::{
    cdr,
    convert::{detection_3d_array, found_in_space, yolo_found_in_space},
    geometry_msgs::{Point, Pose, Quaternion, Vector3},
    vision_msgs::{
        BoundingBox3D, Detection3D, Detection3DArray, ObjectHypothesis, ObjectHypothesisWithPose,
    },
    yolo_msgs,
};

const NOT_TURNED: Quaternion = Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };

fn pose([x, y, z]: [f64; 3]) -> Pose {
    Pose { position: Point { x, y, z }, orientation: NOT_TURNED }
}

/// A chair at a place with a size.
fn chair(at: [f64; 3], [x, y, z]: [f64; 3]) -> Detection3D {
    let hypothesis = ObjectHypothesis { class_id: "56".into(), score: 0.75 };
    Detection3D {
        results: vec![ObjectHypothesisWithPose { hypothesis, ..Default::default() }],
        bbox: BoundingBox3D { center: pose(at), size: Vector3 { x, y, z } },
        ..Detection3D::default()
    }
}

fn array(detections: Vec<Detection3D>) -> Detection3DArray {
    let message = Detection3DArray { header: header(3, "/camera"), detections };
    cdr::decode(&cdr::encode(&message).unwrap()).unwrap()
}

#[test]
fn a_box_has_its_place_and_full_size_in_the_frame_that_is_named() {
    let mut of_base = chair([1.0, 2.0, 3.0], [0.4, 0.5, 0.6]);
    of_base.header.frame_id = "base_link".into();
    // What was not filled in is not turned.
    of_base.bbox.center.orientation = Quaternion::default();
    let (got, bad) = found_in_space(&array(vec![chair([1.0, 2.0, 3.0], [0.4, 0.5, 0.6]), of_base]));
    assert!(bad.is_empty(), "{bad:?}");
    let frames: Vec<&str> = got.detections.iter().map(|d| d.frame_id.as_str()).collect();
    assert_eq!(frames, ["camera", "base_link"]);
    for one in &got.detections {
        assert_eq!((one.label(), one.probability()), ("chair", 0.75));
        assert_eq!(one.frame_from_object.translation.vector.data.0, [[1.0, 2.0, 3.0]]);
        assert_eq!(one.frame_from_object.rotation.angle(), 0.0);
        assert_eq!(one.extents_m.map(|e| e.data.0), Some([[0.4, 0.5, 0.6]]));
    }
    let (again, bad) = found_in_space(&detection_3d_array(&got));
    assert_eq!((again.detections, again.stamp), (got.detections, got.stamp));
    assert!(bad.is_empty());
}

/// The box in the image, in pixels, is where that in space should be; the place is that of the hypothesis.
#[test]
fn of_depthai_only_the_place_counts() {
    let mut found = chair([320.0, 240.0, 0.0], [90.0, 200.0, 0.01]);
    found.results[0].pose.pose = pose([0.1, -0.2, 2.5]);
    let (got, bad) = found_in_space(&array(vec![found]));
    assert!(bad.is_empty(), "{bad:?}");
    let [one] = &got.detections[..] else { panic!("{got:?}") };
    assert_eq!(one.frame_from_object.translation.vector.data.0, [[0.1, -0.2, 2.5]]);
    assert_eq!(one.extents_m, None);
}

#[test]
fn what_has_no_size_is_a_place() {
    let mut of_hypothesis = chair([0.0; 3], [0.0; 3]);
    of_hypothesis.results[0].pose.pose = pose([1.0, 2.0, 3.0]);
    let (got, _) = found_in_space(&array(vec![chair([1.0, 2.0, 3.0], [0.0; 3]), of_hypothesis]));
    for one in &got.detections {
        assert_eq!(one.frame_from_object.translation.vector.data.0, [[1.0, 2.0, 3.0]]);
        assert_eq!(one.extents_m, None);
    }
    assert_eq!(got.detections.len(), 2);
}

#[test]
fn bad_detections_are_left_out_one_by_one() {
    let (at, size) = ([1.0, 2.0, 3.0], [0.4, 0.5, 0.6]);
    let mut nameless = chair(at, size);
    nameless.results.clear();
    let mut long = chair(at, size);
    long.results[0].hypothesis.class_id = "x".repeat(1000);
    let mut twisted = chair(at, size);
    twisted.bbox.center.orientation.w = f64::NAN;
    let cases = [
        ("bad_place", chair([f64::NAN, 2.0, 3.0], size)),
        ("bad_place", chair([f64::INFINITY, 2.0, 3.0], size)),
        ("bad_place", chair([1e300, 2.0, 3.0], size)),
        ("bad_place", twisted),
        ("bad_extents", chair(at, [0.4, -0.5, 0.6])),
        ("bad_extents", chair(at, [0.4, 0.5, 0.0])),
        ("bad_extents", chair(at, [0.4, f64::NAN, 0.6])),
        ("bad_extents", chair(at, [0.4, 1e300, 0.6])),
        ("no_class", nameless),
        ("long_name", long),
    ];
    let all = cases.iter().map(|(_, bad)| bad.clone()).chain([chair(at, size)]).collect();
    let (got, bad) = found_in_space(&array(all));
    assert_eq!(got.detections.len(), 1);
    let reasons: Vec<_> = bad.iter().map(|why| why.reason()).collect();
    assert_eq!(reasons, cases.iter().map(|(reason, _)| *reason).collect::<Vec<_>>());
    let frameless = Detection3DArray { header: header(3, ""), detections: vec![chair(at, size)] };
    let (_, bad) = found_in_space(&frameless);
    assert_eq!(bad[0].reason(), "no_frame");
}

#[test]
fn boxes_of_yolo_ros_are_read_too() {
    let found = |frame_id: &str| yolo_msgs::Detection {
        class_name: "chair".into(),
        score: 0.5,
        bbox3d: yolo_msgs::BoundingBox3D {
            center: pose([1.0, 2.0, 3.0]),
            size: Vector3 { x: 0.4, y: 0.5, z: 0.6 },
            frame_id: frame_id.into(),
        },
        ..yolo_msgs::Detection::default()
    };
    let detections = vec![found("base_link"), found("")];
    let message = yolo_msgs::DetectionArray { header: header(3, "camera"), detections };
    let (got, bad) = yolo_found_in_space(&message);
    let [one] = &got.detections[..] else { panic!("{got:?}") };
    assert_eq!((one.frame_id.as_str(), one.label()), ("base_link", "chair"));
    assert_eq!(one.extents_m.map(|e| e.data.0), Some([[0.4, 0.5, 0.6]]));
    assert_eq!(bad[0].reason(), "no_frame", "a box in the image alone");
}
