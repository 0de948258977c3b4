//! From a bag to the core's inputs.

use crate::fixtures::{self, Line, PLAIN, bag, detection, line, scene};
use ellipsoid_slam::{
    io::{BagInput, InputError, decode_color},
    msg::convert::{RgbImage, color_image_message, compressed_color_message},
    pipeline::{CameraRole, Input},
};
use std::fs;

fn opened(lines: &[Line], look: impl FnOnce(Result<BagInput, InputError>)) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    fs::write(&path, bag(lines, PLAIN)).unwrap();
    look(BagInput::open(&path, &[]));
}

fn refusal(lines: &[Line]) -> String {
    let mut says = String::new();
    opened(lines, |input| says = input.unwrap_err().to_string());
    assert!(says.contains("a.mcap") && !says.contains('\n'), "{says}");
    says
}

/// One letter an input.
fn letter(input: &Input) -> char {
    match input {
        Input::Depth(_) => 'd',
        Input::Camera(info) => {
            if info.role == CameraRole::Color {
                'c'
            } else {
                'C'
            }
        }
        Input::Odometry(_) => 'o',
        Input::Transforms { is_static: true, .. } => 'S',
        Input::Transforms { is_static: false, .. } => 't',
        Input::Detections(_) => 'b',
        Input::Detections3d(_) => 'B',
    }
}

#[test]
fn every_message_becomes_the_input_of_its_role() {
    let mut lines = scene();
    lines.insert(1, line("/tf", 0, &fixtures::transforms(0)));
    lines.push(line("/unrelated", 9, &fixtures::odometry(9)));
    lines.push(line("/ground_truth/odom", 9, &fixtures::odometry(9)));
    opened(&lines, |input| {
        let input = input.unwrap();
        let mut inputs = input.inputs();
        let letters: String = inputs.by_ref().map(|i| letter(&i)).collect();
        assert_eq!(letters, format!("St{}", "odcb".repeat(10)));
        assert_eq!((inputs.messages_read(), input.message_count()), (42, 42));
        assert_eq!((inputs.skipped().total(), inputs.warnings().len()), (0, 0));
        assert_eq!(inputs.log_time(), fixtures::stamp(9));
    });
}

#[test]
fn bad_messages_are_counted_by_reason_and_end_nothing() {
    let mut lines = scene();
    let mut image = fixtures::depth(5);
    image.encoding = "rgb8".into();
    lines.push(line("/camera/depth/image", 5, &image));
    let mut short = line("/camera/depth/image", 6, &fixtures::depth(6));
    short.data.truncate(20);
    lines.push(short);
    let mut nowhere = fixtures::odometry(7);
    nowhere.pose.pose.orientation.w = f64::NAN;
    lines.push(line("/odom", 7, &nowhere));
    let mut boxes = fixtures::detections(7);
    boxes.detections.push(detection((90.0, 1.0), (1.0, 1.0), &[("cup", 0.5)]));
    boxes.detections.push(detection((1.0, 1.0), (-1.0, 1.0), &[("cup", 0.5)]));
    lines.push(line("/detections", 7, &boxes));
    opened(&lines, |input| {
        let input = input.unwrap();
        let mut inputs = input.inputs();
        assert_eq!(inputs.by_ref().count(), 42);
        let counted: Vec<_> = inputs
            .skipped()
            .iter()
            .map(|(topic, reason, count, _)| (topic.to_owned(), reason, count))
            .collect();
        let expected = [
            ("/camera/depth/image", "bad_cdr", 1),
            ("/camera/depth/image", "unknown_encoding", 1),
            ("/detections", "bad_box", 1),
            ("/detections", "box_outside", 1),
            ("/odom", "bad_pose", 1),
        ];
        assert_eq!(
            counted,
            expected.map(|(topic, reason, count)| (topic.to_owned(), reason, count))
        );
    });
}

#[test]
fn what_cannot_be_replayed_is_refused_before_it_starts() {
    let without =
        |topic: &str| scene().into_iter().filter(|l| l.topic != topic).collect::<Vec<_>>();
    for (topic, role) in [
        ("/camera/depth/image", "depth"),
        ("/camera/camera_info", "camera_info"),
        ("/detections", "detections"),
    ] {
        let says = refusal(&without(topic));
        assert!(
            says.contains(&format!("no topic for {role};"))
                && says.contains("/odom (nav_msgs/msg/Odometry)"),
            "{says}"
        );
    }

    let mut other_size = without("/camera/camera_info");
    let mut info = fixtures::camera_info(0);
    (info.width, info.height) = (640, 480);
    other_size.push(line("/camera/camera_info", 0, &info));
    let says = refusal(&other_size);
    assert!(
        says.contains("3x2") && says.contains("640x480") && says.contains("depth_camera_info:="),
        "{says}"
    );

    let mut uncalibrated = without("/camera/camera_info");
    info.k = [0.0; 9];
    uncalibrated.push(line("/camera/camera_info", 0, &info));
    let says = refusal(&uncalibrated);
    assert!(says.contains("/camera/camera_info") && says.contains("not calibrated"), "{says}");

    let mut unreadable = without("/camera/depth/image");
    let mut image = fixtures::depth(0);
    image.encoding = "bayer_rggb8".into();
    unreadable.push(line("/camera/depth/image", 0, &image));
    let says = refusal(&unreadable);
    assert!(says.contains("/camera/depth/image") && says.contains("bayer_rggb8"), "{says}");
}

#[test]
fn one_bad_first_message_does_not_hide_the_good_ones() {
    let mut lines = scene();
    let mut image = fixtures::depth(0);
    image.encoding = String::new();
    lines.insert(0, line("/camera/depth/image", 0, &image));
    opened(&lines, |input| assert_eq!(input.unwrap().inputs().count(), 41));
}

#[test]
fn a_depth_camera_of_its_own_is_measured_by_its_own_calibration() {
    let mut lines: Vec<Line> =
        scene().into_iter().filter(|l| l.topic != "/camera/camera_info").collect();
    let mut color = fixtures::camera_info(0);
    (color.width, color.height) = (640, 480);
    lines.push(line("/camera/color/camera_info", 0, &color));
    lines.push(line("/camera/depth/camera_info", 0, &fixtures::camera_info(0)));
    opened(&lines, |input| {
        let letters: String = input.unwrap().inputs().map(|i| letter(&i)).collect();
        assert!(letters.contains('c') && letters.contains('C'), "{letters}");
    });
}

#[test]
fn colour_is_decoded_on_demand_from_either_type() {
    let picture = RgbImage { width: 1, height: 2, data: vec![9, 8, 7, 6, 5, 4] };
    let header = fixtures::header(1, "camera");
    let flat = RgbImage { width: 8, height: 8, data: vec![120; 192] };
    let packed = compressed_color_message(header.clone(), &flat, 95).unwrap();
    let mut lines = scene();
    lines.push(line("/rgb/image", 1, &color_image_message(header, &picture)));
    lines.push(line("/rgb/image/compressed", 2, &packed));
    opened(&lines, |input| {
        let input = input.unwrap();
        assert_eq!(input.inputs().count(), 41, "the core needs no colour");
        let messages = input.bag().messages().only(["/rgb/image", "/rgb/image/compressed"]);
        let pictures: Vec<_> = messages.map(|m| decode_color(&m).unwrap()).collect();
        assert_eq!(pictures, [picture, flat]);
    });
}
