//! 2D boxes.

use crate::fixtures::{detection, header};
use ellipsoid_slam::{
    msg::{
        cdr, coco,
        convert::{detection_array, detections, yolo_detection_array, yolo_detections},
        vision_msgs::{Detection2D, Detection2DArray},
        yolo_msgs,
    },
    perception::Mask,
};

fn array(detections: Vec<Detection2D>) -> Detection2DArray {
    Detection2DArray { header: header(3, "camera"), detections }
}

#[test]
fn a_box_is_its_centre_and_full_size() {
    let (got, bad) = detections(
        &array(vec![detection(
            (100.0, 50.0),
            (30.0, 10.0),
            &[("cup", 0.5), ("41", 0.25), ("56", 0.125)],
        )]),
        Some((640, 480)),
    );
    assert!(bad.is_empty());
    let [one] = got.detections.as_slice() else { panic!("{got:?}") };
    assert_eq!(
        (one.rect.x_min, one.rect.y_min, one.rect.x_max, one.rect.y_max),
        (85.0, 45.0, 115.0, 55.0)
    );
    assert_eq!(
        one.hypotheses(),
        [("cup".into(), 0.5), ("cup".into(), 0.25), ("chair".into(), 0.125)]
    );
    assert_eq!(
        (got.frame_id.as_str(), got.stamp.as_nanos()),
        ("camera", 1_700_000_000_300_000_000)
    );
}

#[test]
fn bad_boxes_are_left_out_one_by_one() {
    let cup: &[(&str, f64)] = &[("cup", 0.5)];
    let cases: &[(&str, Detection2D)] = &[
        ("bad_box", detection((10.0, 10.0), (0.0, 5.0), cup)),
        ("bad_box", detection((10.0, 10.0), (5.0, -5.0), cup)),
        ("bad_box", detection((f64::NAN, 10.0), (5.0, 5.0), cup)),
        ("bad_box", detection((10.0, 10.0), (f64::INFINITY, 5.0), cup)),
        ("box_outside", detection((700.0, 10.0), (50.0, 5.0), cup)),
        ("box_outside", detection((10.0, -30.0), (50.0, 50.0), cup)),
        ("no_class", detection((10.0, 10.0), (5.0, 5.0), &[])),
        (
            "no_class",
            detection(
                (10.0, 10.0),
                (5.0, 5.0),
                &[("cup", 0.0), ("", 0.5), ("tv", f64::NAN), ("tv", 87.0)],
            ),
        ),
    ];
    let good = detection((1.0, 1.0), (50.0, 50.0), cup);
    let all = cases.iter().map(|(_, bad)| bad.clone()).chain([good]).collect();
    let (got, bad) = detections(&array(all), Some((640, 480)));
    assert_eq!(got.detections.len(), 1, "a box that reaches beyond the image stays");
    let reasons: Vec<_> = bad.iter().map(|why| why.reason()).collect();
    assert_eq!(reasons, cases.iter().map(|(reason, _)| *reason).collect::<Vec<_>>());
}

#[test]
fn an_empty_array_says_that_nothing_was_found() {
    let (got, bad) = detections(&array(vec![]), None);
    assert!(got.detections.is_empty() && bad.is_empty());
}

#[test]
fn classes_are_names_or_coco_indices() {
    let cases = [
        ("0", "person"),
        ("41", "cup"),
        ("56", "chair"),
        ("62", "tv"),
        ("79", "toothbrush"),
        ("80", "80"),
        ("-1", "-1"),
        (" tv ", "tv"),
        ("teddy bear", "teddy bear"),
    ];
    for (class_id, expected) in cases {
        assert_eq!(coco::label(class_id), expected);
    }
    let mut sorted = coco::NAMES;
    sorted.sort_unstable();
    assert!(sorted.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn what_is_written_is_read_again() {
    let (message, _) =
        detections(&array(vec![detection((100.0, 50.0), (30.0, 10.0), &[("cup", 0.5)])]), None);
    let (again, bad) = detections(&detection_array(&message), None);
    assert_eq!((again.detections, again.stamp), (message.detections, message.stamp));
    assert!(bad.is_empty());
}

#[test]
fn boxes_of_yolo_ros_are_read_too() {
    let found = |class_name: &str, class_id, x: f64| yolo_msgs::Detection {
        class_id,
        class_name: class_name.into(),
        score: 0.75,
        bbox: yolo_msgs::BoundingBox2D {
            center: yolo_msgs::Pose2D { position: yolo_msgs::Point2D { x, y: 50.0 }, theta: 0.0 },
            size: yolo_msgs::Vector2 { x: 30.0, y: 10.0 },
        },
        ..yolo_msgs::Detection::default()
    };
    let all = vec![found("cup", 41, 100.0), found("", 56, 100.0), found("tv", 62, -400.0)];
    let message = yolo_msgs::DetectionArray { header: header(3, "camera"), detections: all };
    let bytes = cdr::encode(&message).unwrap();
    let (got, bad) = yolo_detections(&cdr::decode(&bytes).unwrap(), Some((640, 480)));
    let labels: Vec<&str> = got.detections.iter().map(|d| d.label()).collect();
    assert_eq!(labels, ["cup", "chair"], "a name, or an index where there is no name");
    let (first, rect) = (&got.detections[0], got.detections[0].rect);
    assert_eq!(first.probability(), 0.75);
    assert_eq!((rect.x_min, rect.y_min, rect.x_max, rect.y_max), (85.0, 45.0, 115.0, 55.0));
    assert_eq!(bad.iter().map(|why| why.reason()).collect::<Vec<_>>(), ["box_outside"]);
}

/// A box of `yolo_ros` from (85, 45) to (115, 55) with a mask, and what is said of an image of 640x480.
fn masked(height: i32, width: i32, corners: &[[f64; 2]]) -> (Option<Mask>, Vec<&'static str>) {
    let data = corners.iter().map(|[x, y]| yolo_msgs::Point2D { x: *x, y: *y }).collect();
    let position = yolo_msgs::Point2D { x: 100.0, y: 50.0 };
    let found = yolo_msgs::Detection {
        class_name: "cup".into(),
        score: 0.75,
        bbox: yolo_msgs::BoundingBox2D {
            center: yolo_msgs::Pose2D { position, theta: 0.0 },
            size: yolo_msgs::Vector2 { x: 30.0, y: 10.0 },
        },
        mask: yolo_msgs::Mask { height, width, data },
        ..yolo_msgs::Detection::default()
    };
    let message =
        yolo_msgs::DetectionArray { header: header(3, "camera"), detections: vec![found] };
    let bytes = cdr::encode(&message).unwrap();
    let (got, bad) = yolo_detections(&cdr::decode(&bytes).unwrap(), Some((640, 480)));
    let [one] = got.detections.as_slice() else { panic!("the box stays") };
    let sent = cdr::encode(&yolo_detection_array(&got, (640, 480))).unwrap();
    let (again, _) = yolo_detections(&cdr::decode(&sent).unwrap(), Some((640, 480)));
    assert_eq!(again.detections, got.detections, "what is written is read again");
    (one.mask.clone(), bad.iter().map(|why| why.reason()).collect())
}

#[test]
fn masks_of_yolo_ros_are_read_and_wrong_ones_leave_the_box() {
    let corners = [[85.0, 45.0], [115.0, 45.0], [115.0, 50.0], [85.0, 50.0]];
    let (mask, bad) = masked(480, 640, &corners);
    let mask = mask.unwrap();
    assert!(mask.contains(100.0, 47.0) && !mask.contains(100.0, 53.0) && bad.is_empty());
    assert_eq!(masked(0, 0, &[]), (None, vec![]), "a network without masks");
    let elsewhere = corners.map(|[x, y]| [x + 300.0, y]);
    let not_finite = [[85.0, f64::NAN], [115.0, 45.0], [115.0, 50.0]];
    for (height, width, corners) in [
        (160, 160, &corners[..]),
        (480, 640, &elsewhere),
        (480, 640, &not_finite),
        (480, 640, &corners[..2]),
    ] {
        assert_eq!(masked(height, width, corners), (None, vec!["bad_mask"]), "{corners:?}");
    }
}
