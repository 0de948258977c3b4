//! Odometry whose frame jumps, since the base driver was restarted or corrected itself, and readings that cannot be.

use super::{Run, at, boxes, depth, millis, odometry_at};
use crate::geometry::pose_distance;
use ellipsoid_slam::{geometry::Pose, pipeline::Input};
use nalgebra::Vector3;
use std::f64::consts::FRAC_PI_2;

/// Where odometry says that a robot is which drives half a metre a second, when its frame moves after two seconds.
fn drive(jump: &Pose) -> Run {
    let mut run = Run::ready();
    for ms in (0..4000).step_by(20) {
        let start_from_base = Pose::translation(0.5 * ms as f64 / 1000.0, 0.0, 0.0);
        let odom_from_start = if ms < 2000 { Pose::identity() } else { *jump };
        run.feed([odometry_at(ms, odom_from_start * start_from_base)]);
        if ms % 200 == 100 {
            run.feed([depth(ms), boxes(ms)]);
        }
    }
    run.finish();
    run
}

#[test]
fn the_robot_goes_on_where_it_was_and_the_frame_of_odometry_jumps() {
    let turned = Pose::new(Vector3::new(0.3, -0.4, 0.0), Vector3::z() * FRAC_PI_2);
    let to_zero = Pose::translation(-1.0, 0.0, 0.0);
    for jump in
        [Pose::translation(0.5, 0.0, 0.0), turned, to_zero, Pose::translation(1e9, 0.0, 0.0)]
    {
        let run = drive(&jump);
        assert_eq!(run.dropped(), [(2000, "odometry_jump")]);
        assert!(run.total.dropped[0].why.contains("jump of its frame"));
        assert_eq!(run.total.poses.len(), 20);
        for pose in &run.total.poses {
            let start_from_base = 0.5 * millis(pose.stamp) as f64 / 1000.0;
            let off = pose.map_from_base.translation.vector - Vector3::x() * start_from_base;
            // What is driven while the frame jumps is not known: a centimetre.
            assert!(off.norm() < 0.011, "{off} at {}", pose.stamp);
            // What is published of it: `map -> odom` takes the pose that odometry says to the one in the map.
            let odom_from_start = if pose.stamp < at(2000) { Pose::identity() } else { jump };
            let expected = odom_from_start * Pose::translation(start_from_base, 0.0, 0.0);
            assert!(pose_distance(&pose.odom_from_base, &expected) < 0.012);
            let later = run.slam.map_from_base(pose);
            assert!(pose_distance(&later, &pose.map_from_base) < 1e-3);
        }
    }
}

#[test]
fn a_fast_robot_and_seldom_readings_are_no_jumps() {
    let mut run = Run::ready();
    for ms in (0..3000).step_by(20) {
        let ahead = 2.5 * ms as f64 / 1000.0;
        run.feed([odometry_at(ms, Pose::translation(ahead, 0.0, 0.0))]);
    }
    run.feed([odometry_at(9000, Pose::translation(40.0, 0.0, 0.0))]);
    run.finish();
    assert_eq!(run.dropped(), []);
}

/// How far off the worst pose of a drive of half a metre a second is (m), whose readings are replaced by others.
fn worst(replaced: impl Fn(i64, Input) -> Vec<Input>) -> (f64, Vec<&'static str>) {
    let mut run = Run::ready();
    for ms in (0..4000).step_by(20) {
        let ahead = 0.5 * ms as f64 / 1000.0;
        run.feed(replaced(ms, odometry_at(ms, Pose::translation(ahead, 0.0, 0.0))));
        if ms % 200 == 100 {
            run.feed([depth(ms), boxes(ms)]);
        }
    }
    run.finish();
    assert_eq!(run.total.poses.len(), 20);
    let off = run.total.poses.iter().map(|pose| {
        let ahead = 0.5 * millis(pose.stamp) as f64 / 1000.0;
        (pose.map_from_base.translation.vector - Vector3::x() * ahead).norm()
    });
    (off.fold(0.0, f64::max), run.dropped().into_iter().map(|(_, why)| why).collect())
}

#[test]
fn readings_that_cannot_be_leave_the_way_as_it_is() {
    let (off, said) = worst(|ms, reading| {
        let far = odometry_at(ms, Pose::translation(1e9, 0.0, 0.0));
        if ms == 2000 { vec![far] } else { vec![reading] }
    });
    // There and back again.
    assert_eq!(said, ["odometry_jump", "odometry_jump"]);
    assert!(off < 0.025, "{off} m after one reading of 1e9 m");

    let (off, said) = worst(|_, reading| vec![reading.clone(), reading]);
    assert_eq!(said, Vec::<&str>::new());
    assert!(off < 1e-9, "{off} m with every reading twice");

    let (off, _) = worst(|_, reading| {
        let Input::Odometry(mut reading) = reading else { return vec![reading] };
        let mut negative = [0.0; 36];
        negative.iter_mut().step_by(7).for_each(|variance| *variance = -1.0);
        reading.covariance = Some(Box::new(negative));
        vec![Input::Odometry(reading)]
    });
    assert!(off < 1e-6, "{off} m with variances of -1");
}
