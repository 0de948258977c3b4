use super::{
    Run, at, boxes, camera_info, camera_on_base, color_camera, depth, depth_in, millis, odometry,
    odometry_at, small_camera, transform,
};
use crate::{
    geometry::{pose_distance, upright_pose},
    scene::looking,
};
use ellipsoid_slam::{
    config::parameters_from_yaml,
    geometry::{Pose, exp, interpolate},
    pipeline::{CameraRole, Input, Settings},
};
use nalgebra::{Vector3, Vector6};

/// Turning left on a circle: 0.6 rad and 1 m a second.
fn circling(seconds: f64) -> Pose {
    exp(&(Vector6::new(0.0, 0.0, 0.6, 1.0, 0.0, 0.0) * seconds))
}

#[test]
fn odometry_is_interpolated_at_the_images_stamp() {
    let mut run = Run::ready();
    run.feed([odometry_at(0, circling(0.0)), odometry_at(1000, circling(1.0))]);
    run.feed([depth(250), depth(700), depth(1000)]);
    run.finish();
    assert_eq!(run.posed(), [250, 700, 1000]);
    for pose in &run.total.poses {
        let expected = circling(pose.stamp.seconds_since(at(0)));
        assert!(pose_distance(&pose.odom_from_base, &expected) < 1e-9);
        assert_eq!(pose.map_from_base, pose.odom_from_base, "the map starts as the odometry");
    }
}

#[test]
fn an_image_waits_for_the_odometry_behind_it() {
    let mut run = Run::ready();
    let early = run.feed([odometry(0), depth(100), boxes(100)]);
    assert!(early.poses.is_empty() && early.dropped.is_empty());
    let then = run.feed([odometry(200)]);
    assert_eq!(then.keyframes.len(), 1);
    assert!((then.poses[0].odom_from_base.translation.x - 0.1).abs() < 1e-9);
}

#[test]
fn odometry_out_of_order_is_put_in_order() {
    let mut run = Run::ready();
    run.feed([odometry(0), odometry(400), odometry(200), odometry(100), odometry(300)]);
    run.feed([depth(50), depth(150), depth(350)]);
    run.finish();
    for pose in &run.total.poses {
        let expected = pose.stamp.seconds_since(at(0));
        assert!((pose.odom_from_base.translation.x - expected).abs() < 1e-9);
    }
    assert_eq!(run.posed().len(), 3);
}

#[test]
fn the_keyframe_is_where_the_camera_is() {
    let mut run = Run::ready();
    run.feed([odometry_at(0, circling(0.0)), odometry_at(1000, circling(1.0))]);
    run.feed([depth(500), boxes(500)]);
    let keyframe = &run.total.keyframes[0];
    let expected = circling(0.5) * looking([0.0, 0.0, 1.0], 0.0, 0.0);
    assert!(pose_distance(&keyframe.map_from_camera, &expected) < 1e-9);
    assert_eq!(run.slam.frames(), ("odom", "base_link"));
}

#[test]
fn without_odometry_messages_poses_come_from_transforms() {
    let mut run = Run::ready();
    for ms in (0..=1000).step_by(200) {
        let pose = circling(ms as f64 / 1000.0);
        run.feed([
            transform(false, ms, ["odom", "base_link"], pose),
            depth(ms - 50),
            boxes(ms - 50),
        ]);
    }
    run.finish();
    // The image of -50 ms is before the first transform.
    assert_eq!(run.posed(), [150, 350, 550, 750, 950]);
    assert_eq!(run.dropped(), [(-50, "no_transform")]);
    for pose in &run.total.poses {
        let expected = circling(pose.stamp.seconds_since(at(0)));
        assert!(pose_distance(&pose.odom_from_base, &expected) < 1e-9);
    }
}

/// As AMCL and slam_toolbox do it: their transform is stamped ahead of time, and corrected on the way.
#[test]
fn beside_a_program_that_publishes_map_to_odom_poses_are_in_its_map() {
    let parameters = parameters_from_yaml(include_str!("../../../config/nav2.yaml")).unwrap();
    assert!(!parameters.node.publish_tf && parameters.node.topics.odometry.is_empty());
    let mut run = Run::new(parameters.slam);
    run.feed([color_camera(), camera_on_base()]);
    let map_from_odom = |ms: i64| {
        let corrected = if ms < 1500 { 0.0 } else { 0.3 };
        upright_pose(1.2, Vector3::new(4.0 + corrected, -2.0, 0.0))
    };
    for ms in (0..=3000).step_by(100) {
        run.feed([
            transform(false, ms + 500, ["map", "odom"], map_from_odom(ms + 500)),
            transform(false, ms, ["odom", "base_link"], circling(ms as f64 / 1000.0)),
            depth(ms - 50),
            boxes(ms - 50),
        ]);
    }
    run.finish();
    assert!(run.posed().len() >= 24, "{:?}", run.dropped());
    for pose in &run.total.poses {
        let (ms, own) = (millis(pose.stamp), circling(pose.stamp.seconds_since(at(0))));
        // Where it is being corrected, between the two.
        if !(1400..1500).contains(&ms) {
            let expected = map_from_odom(ms) * own;
            assert!(pose_distance(&pose.map_from_base, &expected) < 1e-6, "{ms}");
        }
    }
    assert_eq!(run.slam.frames(), ("map", "base_link"));
}

#[test]
fn a_moving_camera_is_where_its_transform_says() {
    // A head that pans from ahead to the left within a second, above a standing base.
    let head = |yaw: f64| looking([0.1, 0.0, 1.2], yaw, 10.0);
    let mut run = Run::new(Settings::default());
    run.feed([
        color_camera(),
        odometry_at(0, Pose::identity()),
        odometry_at(2000, Pose::identity()),
    ]);
    run.feed([
        transform(false, 0, ["base_link", "camera"], head(0.0)),
        transform(false, 1000, ["base_link", "camera"], head(1.0)),
        depth(300),
        boxes(300),
    ]);
    let keyframe = &run.total.keyframes[0];
    let expected = interpolate(&head(0.0), &head(1.0), 0.3);
    assert!(pose_distance(&keyframe.map_from_camera, &expected) < 1e-9);
    let ahead = keyframe.map_from_camera.rotation * Vector3::z();
    assert!((ahead.y.atan2(ahead.x) - 0.3).abs() < 1e-9, "panned by 0.3 rad");
}

#[test]
fn chains_of_transforms_are_followed_up_and_down() {
    // base_link → mast → camera, and odom → footprint → base_link.
    let mut run = Run::new(Settings::default());
    run.feed([
        color_camera(),
        transform(true, 0, ["mast", "camera"], looking([0.0, 0.0, 0.4], 0.0, 0.0)),
        transform(true, 0, ["base_link", "mast"], Pose::translation(0.1, 0.0, 0.5)),
        transform(true, 0, ["footprint", "base_link"], Pose::translation(0.0, 0.0, 0.2)),
        transform(false, 0, ["odom", "footprint"], Pose::translation(0.0, 0.0, 0.0)),
        transform(false, 100, ["odom", "footprint"], Pose::translation(0.2, 0.0, 0.0)),
        depth(50),
        boxes(50),
    ]);
    let camera = run.total.keyframes[0].map_from_camera.translation.vector;
    assert!((camera - Vector3::new(0.2, 0.0, 1.1)).norm() < 1e-9, "{camera}");
}

#[test]
fn depth_of_another_camera_is_registered_or_refused_with_both_frames() {
    let other = |run: &mut Run| {
        run.feed([color_camera(), camera_on_base(), odometry(0), odometry(9000)]);
        run.feed([depth_in("depth_camera", 100), boxes(100)]);
    };
    let info = || camera_info(CameraRole::Depth, "depth_camera", small_camera());
    let mount =
        || transform(true, 0, ["camera", "depth_camera"], Pose::translation(0.05, 0.0, 0.0));
    let cases: [(Vec<Input>, Option<&str>); 3] = [
        (vec![info(), mount()], None),
        (vec![mount()], Some("no_depth_camera_info")),
        (vec![info()], Some("no_transform")),
    ];
    for (extra, reason) in cases {
        let mut run = Run::new(Settings::default());
        run.feed(extra);
        other(&mut run);
        run.finish();
        match reason {
            None => assert_eq!(run.keyframes(), [100]),
            Some(reason) => {
                assert_eq!(run.dropped(), [(100, reason)]);
                let why = &run.total.dropped[0].why;
                assert!(why.contains("\"camera\"") && why.contains("\"depth_camera\""), "{why}");
            }
        }
    }
}
