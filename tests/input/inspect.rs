//! What `inspect` says about a bag.

use crate::fixtures::{self, Line, PLAIN, bag, line, scene};
use ellipsoid_slam::{
    io::{BagReport, inspect},
    msg::sensor_msgs::Image,
    pipeline::SyncSettings,
    topics::Role,
};
use std::fs;

fn report(lines: &[Line], remaps: &[&str]) -> BagReport {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    fs::write(&path, bag(lines, PLAIN)).unwrap();
    let remaps: Vec<_> = remaps.iter().map(|text| text.parse().unwrap()).collect();
    inspect(&path, &remaps, &SyncSettings::default(), false).unwrap()
}

fn without(topic: &str) -> Vec<Line> {
    scene().into_iter().filter(|line| line.topic != topic).collect()
}

/// The one problem that the report names.
#[track_caller]
fn problem(lines: &[Line]) -> String {
    let report = report(lines, &[]);
    let [problem] = report.problems.as_slice() else { panic!("{:#?}", report.problems) };
    assert!(report.to_string().contains(problem.as_str()));
    assert!(!report.to_string().contains("can be replayed as it is"));
    problem.clone()
}

#[test]
fn a_good_bag_has_no_problems() {
    let mut lines = scene();
    for at in [0, 2, 4] {
        let image = Image { encoding: "mono8".into(), ..fixtures::depth(at) };
        lines.push(line("/rgb/image", at, &image));
    }
    let report = report(&lines, &[]);
    assert_eq!(report.problems, [""; 0]);
    assert_eq!((report.messages, report.duration_s), (44, 0.9));
    let streams: Vec<_> =
        report.streams.iter().map(|s| (s.role, s.topic.as_str(), s.messages)).collect();
    let expected = [
        (Role::Rgb, "/rgb/image", 3),
        (Role::Depth, "/camera/depth/image", 10),
        (Role::CameraInfo, "/camera/camera_info", 10),
        (Role::Odometry, "/odom", 10),
        (Role::Detections, "/detections", 10),
    ];
    assert_eq!(streams, expected);
    let depth = &report.streams[1].rhythm;
    assert!(
        (depth.rate_hz - 10.0).abs() < 1e-9 && (depth.max_gap_s - 0.1).abs() < 1e-9,
        "{depth:?}"
    );
    assert_eq!((depth.gaps, depth.backwards), (0, 0));
    assert_eq!(report.detections_to_depth.as_ref().unwrap().exact_share, 1.0);
    assert_eq!(report.odometry.as_ref().unwrap().share, 1.0);
    assert_eq!(report.frames.base_to_camera, Some(true));
    let text = report.to_string();
    for part in [
        "10.0 Hz",
        "/camera/depth/image",
        "base_link -> camera (fixed)",
        "can be replayed as it is",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    let json = serde_json::to_value(&report).unwrap();
    assert_eq!(json["roles"]["depth"], "/camera/depth/image");
    assert_eq!(json["streams"][0]["role"], "rgb");
}

#[test]
fn what_was_chosen_and_why_is_said_and_depth_is_known_by_its_format() {
    let mut lines = scene();
    for at in [0, 2] {
        // Painted for people, and depth under a name that does not say so.
        let painted = Image { encoding: "rgb8".into(), ..fixtures::depth(at) };
        lines.push(line("/aligned_depth/painted", at, &painted));
        lines.push(line(
            "/zed/range",
            at,
            &Image { encoding: "16UC1".into(), ..fixtures::depth(at) },
        ));
    }
    let report = report(&lines, &[]);
    assert_eq!(report.roles.depth, "/camera/depth/image");
    let text = report.to_string();
    let why = "is /camera/depth/image, rather than /zed/range, which is not called depth";
    assert!(text.contains(why), "{text}");
    assert_eq!(report.choices.iter().find(|c| c.role == Role::Depth).unwrap().rather_than.len(), 1);
}

#[test]
fn what_is_missing_is_said_in_words_to_act_on() {
    let says = problem(&without("/detections"));
    assert!(
        says.contains("no topic for detections") && says.contains("-r detections:=/topic"),
        "{says}"
    );

    let says = problem(&without("/odom"));
    assert!(
        says.contains("no odometry")
            && says.contains("-r odometry:=/topic")
            && says.contains("/tf"),
        "{says}"
    );

    let says = problem(&without("/tf_static"));
    assert!(
        says.contains("`base_link`") && says.contains("`camera`") && says.contains("/tf_static"),
        "{says}"
    );

    let half = scene().into_iter().enumerate();
    let half: Vec<Line> =
        half.filter(|(at, line)| line.topic != "/odom" || *at < 20).map(|(_, line)| line).collect();
    let says = problem(&half);
    assert!(says.contains("covers only 50 %"), "{says}");

    let mut late = without("/detections");
    late.extend((0..10).map(|at| line("/detections", at, &fixtures::detections(at + 600))));
    let says = problem(&late);
    assert!(
        says.contains("/detections") && says.contains("59.500 s") && says.contains("same clock"),
        "{says}"
    );
}

#[test]
fn moving_transforms_stand_in_for_odometry() {
    let mut lines = without("/odom");
    for at in 0..10 {
        let mut moving = fixtures::transforms(at);
        moving.transforms[0].header.frame_id = "odom".into();
        moving.transforms[0].child_frame_id = "base_link".into();
        lines.push(line("/tf", at, &moving));
    }
    let report = report(&lines, &[]);
    assert_eq!(report.problems, [""; 0]);
    assert!(report.frames.camera_moves);
}

#[test]
fn stamps_that_go_backwards_and_gaps_are_counted() {
    let mut lines = without("/odom");
    for (log, stamped) in [(0, 0), (1, 1), (2, 2), (3, 1), (4, 9)] {
        lines.push(line("/odom", log, &fixtures::odometry(stamped)));
    }
    let says = problem(&lines);
    assert!(says.contains("stamps on /odom go backwards (1 times)"), "{says}");
}

#[test]
fn offsets_are_to_the_nearest_image() {
    let mut lines = without("/detections");
    for at in 0..10 {
        let mut boxes = fixtures::detections(at);
        // Half of them 20 ms late, the last one 30 ms.
        boxes.header.stamp.nanosec +=
            [0, 20_000_000][at as usize % 2] + [0, 10_000_000][usize::from(at == 9)];
        lines.push(line("/detections", at, &boxes));
    }
    let matching = report(&lines, &[]).detections_to_depth.unwrap();
    assert_eq!((matching.exact_share, matching.within_slop_share), (0.5, 0.9));
    assert!(
        (matching.max_offset_s - 0.03).abs() < 1e-9 && matching.median_offset_s == 0.0,
        "{matching:?}"
    );
}

#[test]
fn sizes_that_differ_are_a_problem_and_a_bad_remap_an_error() {
    let mut lines = without("/camera/camera_info");
    let mut info = fixtures::camera_info(0);
    info.width = 99;
    lines.push(line("/camera/camera_info", 0, &info));
    let says = problem(&lines);
    assert!(says.contains("3x2") && says.contains("99x2"), "{says}");

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    fs::write(&path, bag(&scene(), PLAIN)).unwrap();
    let remaps = ["depth:=/nope".parse().unwrap()];
    let says = inspect(&path, &remaps, &SyncSettings::default(), false).unwrap_err().to_string();
    assert!(says.contains("/nope"), "{says}");
}
