use super::{Run, at, boxes, depth, odometry, odometry_at, transform};
use ellipsoid_slam::geometry::Pose;

#[test]
fn an_image_from_the_past_is_dropped() {
    let mut run = Run::ready();
    run.feed([odometry(0), odometry(1000), depth(300), depth(200), depth(300), depth(400)]);
    run.finish();
    assert_eq!(run.posed(), [300, 400]);
    assert_eq!(run.dropped(), [(200, "stamp_goes_back"), (300, "stamp_goes_back")]);
}

#[test]
fn a_restarted_recording_starts_anew() {
    let mut run = Run::ready();
    for ms in (10_000..11_000).step_by(100) {
        run.feed([odometry(ms), depth(ms), boxes(ms)]);
    }
    run.feed([depth(11_000)]);
    for ms in (0..1000).step_by(100) {
        run.feed([odometry(ms), depth(ms), boxes(ms)]);
    }
    run.finish();
    let expected: Vec<i64> = (10_000..11_000).step_by(100).chain((0..1000).step_by(100)).collect();
    assert_eq!(run.keyframes(), expected);
    assert_eq!(run.dropped(), [(11_000, "clock_jumped")]);
}

/// Poses of the time before a jump must not be mixed with those after it.
#[test]
fn after_a_jump_poses_of_the_old_time_are_forgotten() {
    let there = |y: f64| Pose::translation(0.0, y, 0.0);
    for by_message in [true, false] {
        let pose = |ms: i64, y: f64| {
            if by_message {
                odometry_at(ms, there(y))
            } else {
                transform(false, ms, ["odom", "base_link"], there(y))
            }
        };
        let mut run = Run::ready();
        // The old time covers 0 to 10 s, at y = 5; in the new one the base stands at y = 0.
        run.feed((0..=100).map(|i| pose(100 * i, 5.0)));
        run.feed([depth(9_950), boxes(9_950)]);
        // The same stamps once more, as when a simulation is set back: pose and image in either order.
        run.feed([depth(1_050), boxes(1_050), pose(1_000, 0.0), pose(1_200, 0.0)]);
        run.feed([pose(1_300, 0.0), depth(1_250), boxes(1_250)]);
        run.finish();
        let ys: Vec<(i64, f64)> = run
            .total
            .poses
            .iter()
            .map(|p| (p.stamp.as_nanos() / 1_000_000, p.map_from_base.translation.y))
            .collect();
        assert_eq!(
            ys,
            [(9_950, 5.0), (1_050, 0.0), (1_250, 0.0)],
            "odometry messages: {by_message}"
        );
    }
}

#[test]
fn a_long_run_before_a_jump_does_not_crowd_out_the_new_time() {
    let mut run = Run::ready();
    // More poses than are kept.
    run.feed((0..12_000).map(|i| odometry(100_000 + 10 * i)));
    run.feed([depth(150_000), boxes(150_000)]);
    run.feed((0..20).map(|i| odometry(100 * i)));
    run.feed([depth(450), boxes(450), depth(1_850), boxes(1_850)]);
    run.finish();
    assert_eq!(run.keyframes()[1..], [450, 1_850], "{:?}", run.total.dropped);
}

#[test]
fn boxes_around_a_jump_are_not_lost_in_silence() {
    let mut run = Run::ready();
    run.feed([odometry(10_000), odometry(10_500), depth(10_100), boxes(10_100), boxes(10_300)]);
    // These are too old for the old time; that a new one begins only the next image tells.
    run.feed([odometry(0), odometry(500), boxes(100), depth(100), depth(200), boxes(200)]);
    run.finish();
    assert_eq!(run.keyframes(), [10_100, 200]);
    assert_eq!(run.posed(), [10_100, 100, 200]);
    assert_eq!(run.dropped(), [(100, "no_depth_for_boxes"), (10_300, "no_depth_for_boxes")]);
}

#[test]
fn one_pose_with_a_wrong_stamp_is_ignored() {
    let mut run = Run::ready();
    run.feed((0..20).map(|i| odometry(10_000 + 100 * i)));
    // Drivers that send before they know the time write zero.
    run.feed([odometry_at(0, Pose::translation(9.0, 9.0, 9.0)), odometry(12_000)]);
    run.feed([depth(10_050), boxes(10_050), depth(11_950), boxes(11_950)]);
    run.finish();
    assert_eq!(run.keyframes(), [10_050, 11_950]);
    assert!((run.total.poses[1].odom_from_base.translation.x - 11.95).abs() < 1e-9);
}

#[test]
fn boxes_of_the_future_do_not_stop_the_rest() {
    let mut run = Run::ready();
    run.feed([odometry(0), boxes(900_000)]);
    for ms in (100..600).step_by(100) {
        run.feed([odometry(ms + 1), depth(ms), boxes(ms)]);
    }
    run.finish();
    assert_eq!(run.posed(), [100, 200, 300, 400, 500]);
    assert_eq!(run.keyframes(), [100, 200, 300, 400, 500]);
    assert_eq!(run.dropped(), [(900_000, "no_depth_for_boxes")]);
    assert_eq!(run.total.dropped[0].stamp, at(900_000));
}
