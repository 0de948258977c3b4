use super::{
    Run, boxes, camera_info, camera_on_base, color_camera, depth, odometry, small_camera, transform,
};
use ellipsoid_slam::{
    geometry::{Camera, Distortion, Pose},
    pipeline::{CameraRole, Input, MAX_FRAMES, Settings},
};

/// Feeds what there is, then images and boxes; returns reasons and sentences.
fn drops_with(given: Vec<Input>) -> Vec<(&'static str, String)> {
    let mut run = Run::new(Settings::default());
    run.feed(given);
    for ms in (100..400).step_by(100) {
        run.feed([depth(ms), boxes(ms)]);
    }
    assert!(run.total.poses.is_empty(), "nothing can be said of where the base is");
    run.finish();
    assert_eq!(run.total.poses.len() + run.total.dropped.len(), 3, "no image is lost in silence");
    run.total.dropped.into_iter().map(|d| (d.reason, d.why)).collect()
}

#[test]
fn a_missing_calibration_is_named() {
    let drops = drops_with(vec![camera_on_base(), odometry(0), odometry(1000)]);
    assert!(drops.iter().all(|(reason, _)| *reason == "no_camera_info"), "{drops:?}");
}

#[test]
fn a_missing_camera_mount_is_named_with_both_frames() {
    let drops = drops_with(vec![color_camera(), odometry(0), odometry(1000)]);
    for (reason, why) in drops {
        assert_eq!(reason, "no_transform");
        assert!(why.contains("\"camera\"") && why.contains("\"base_link\""), "{why}");
    }
}

#[test]
fn missing_odometry_is_named_with_both_frames() {
    let drops = drops_with(vec![color_camera(), camera_on_base()]);
    for (reason, why) in drops {
        assert_eq!(reason, "no_transform");
        assert!(why.contains("\"odom\"") && why.contains("\"base_link\""), "{why}");
    }
}

#[test]
fn odometry_that_ends_too_soon_is_named() {
    let drops = drops_with(vec![color_camera(), camera_on_base(), odometry(0), odometry(50)]);
    assert!(drops.iter().all(|(reason, _)| *reason == "no_odometry"), "{drops:?}");
}

#[test]
fn images_before_the_first_odometry_are_named_and_later_ones_used() {
    let mut run = Run::ready();
    run.feed([depth(0), boxes(0), depth(300), boxes(300), odometry(200), odometry(400)]);
    run.finish();
    assert_eq!(run.posed(), [300]);
    assert_eq!(run.dropped(), [(0, "no_odometry")]);
}

#[test]
fn a_transform_that_comes_later_is_waited_for() {
    let mut run = Run::new(Settings::default());
    run.feed([color_camera(), odometry(0), odometry(1000), depth(100), boxes(100)]);
    assert!(run.total.dropped.is_empty() && run.total.poses.is_empty());
    run.feed([camera_on_base()]);
    assert_eq!(run.keyframes(), [100]);
}

#[test]
fn where_a_camera_is_on_its_base_does_not_wait_for_corrections_of_odometry() {
    let mut run = Run::new(Settings::default());
    let moved = Pose::translation(5.0, -2.0, 0.3);
    run.feed([color_camera(), camera_on_base()]);
    // Two other nodes correct and integrate odometry, and have not said anything since.
    run.feed([transform(false, 0, ["map", "odom"], moved)]);
    run.feed([transform(false, 0, ["odom", "base_link"], moved)]);
    run.feed([odometry(0), odometry(1000), depth(100), boxes(100)]);
    assert_eq!(run.keyframes(), [100]);
    assert!(run.dropped().is_empty(), "{:?}", run.dropped());
}

#[test]
fn a_depth_image_of_another_size_is_refused_with_both_sizes() {
    let large = Camera::new((640, 480), (525.0, 525.0), (319.5, 239.5), Distortion::None).unwrap();
    let mut run = Run::new(Settings::default());
    run.feed([camera_info(CameraRole::Color, "camera", large), camera_on_base()]);
    run.feed([odometry(0), odometry(1000), depth(100), boxes(100)]);
    assert_eq!(run.dropped(), [(100, "size_mismatch")]);
    let why = &run.total.dropped[0].why;
    assert!(
        why.contains("16x12") && why.contains("640x480") && why.contains("\"camera\""),
        "{why}"
    );
    assert_eq!(run.posed(), [100], "where the base was is known all the same");
}

#[test]
fn depth_aligned_to_the_full_image_is_registered_to_the_smaller_one_of_the_boxes() {
    // One optical frame, two sizes: the calibration says what the name of the frame does not.
    let large = Camera::new((32, 24), (28.0, 28.0), (15.5, 11.5), Distortion::None).unwrap();
    let mut run = Run::new(Settings::default());
    run.feed([camera_info(CameraRole::Color, "camera", large), camera_on_base()]);
    run.feed([odometry(0), odometry(1000), depth(100), boxes(100)]);
    assert_eq!(run.dropped(), [(100, "size_mismatch")]);
    run.feed([camera_info(CameraRole::Depth, "camera", small_camera()), depth(200), boxes(200)]);
    assert_eq!(run.keyframes(), [200]);
    // The calibration of another camera is none of the depth image's.
    run.feed([camera_info(CameraRole::Depth, "infrared", small_camera()), depth(300), boxes(300)]);
    assert_eq!(run.keyframes(), [200]);
    assert_eq!(run.dropped().len(), 2);
}

#[test]
fn a_ring_of_frames_ends() {
    let mut run = Run::ready();
    run.feed([
        transform(true, 0, ["a", "base_link"], Pose::identity()),
        transform(true, 0, ["base_link", "a"], Pose::identity()),
        depth(100),
        boxes(100),
    ]);
    run.finish();
    assert_eq!(run.dropped().len(), 1);
}

#[test]
fn a_new_calibration_is_used_from_then_on() {
    let mut run = Run::ready();
    run.feed([odometry(0), odometry(1000), depth(100), boxes(100)]);
    let longer = Camera::new((16, 12), (28.0, 28.0), (7.5, 5.5), Distortion::None).unwrap();
    run.feed([camera_info(CameraRole::Color, "camera", longer), depth(200), boxes(200)]);
    assert_eq!(run.keyframes(), [100, 200]);
}

#[test]
fn frames_without_end_are_dropped_and_those_that_matter_stay() {
    let mut run = Run::ready();
    let mut flood = |names: std::ops::Range<usize>| {
        let named = |i| transform(false, 0, ["odom", &format!("frame_{i}")], Pose::identity());
        run.feed(names.map(named)).dropped
    };
    assert!(flood(0..MAX_FRAMES - 1).is_empty(), "the camera is one of them");
    let dropped = flood(MAX_FRAMES - 1..MAX_FRAMES + 9);
    assert_eq!(dropped.len(), 10);
    assert!(dropped.iter().all(|d| d.reason == "too_many_frames"), "{dropped:?}");
    // Known ones still move.
    assert!(flood(0..10).is_empty());
    run.feed([odometry(0), odometry(1000), depth(100), boxes(100)]);
    run.finish();
    assert_eq!(run.posed(), [100]);
}
