//! Images given as arrays.

use ellipsoid_slam::{
    geometry::{Camera, Distortion, Pose},
    perception::{DepthError, DetectionError, MaskError},
    pipeline::{FrameError, ObjectSlam, RgbdFrame, Settings},
    time::Stamp,
};
use nalgebra::Vector3;

fn camera() -> Camera {
    Camera::new((4, 3), (4.0, 4.0), (1.5, 1.0), Distortion::None).unwrap()
}

#[test]
fn arrays_that_are_no_image_are_refused() {
    let new = |pose: &Pose, depth: &[f32]| RgbdFrame::new(Stamp::default(), &camera(), pose, depth);
    let (pose, depth) = (Pose::identity(), [1.0; 12]);
    assert_eq!(
        new(&pose, &depth[1..]).unwrap_err(),
        FrameError::Depth(DepthError::WrongLength { width: 4, height: 3, got: 11 })
    );
    let nowhere = Pose::new(Vector3::new(0.0, f64::NAN, 0.0), Vector3::zeros());
    assert_eq!(new(&nowhere, &depth).unwrap_err(), FrameError::Pose);
    let with = |corners, score| new(&pose, &depth).unwrap().with_box(corners, "cup", score);
    assert!(with([0.0, 0.0, 2.0, 2.0], 0.5).is_ok());
    for (corners, score, why) in [
        ([2.0, 0.0, 1.0, 2.0], 0.5, DetectionError::BadBox),
        ([0.0, 0.0, f64::NAN, 2.0], 0.5, DetectionError::BadBox),
        ([0.0, 0.0, 2.0, 2.0], 0.0, DetectionError::NoClass),
        ([0.0, 0.0, 2.0, 2.0], 1.5, DetectionError::NoClass),
    ] {
        assert_eq!(with(corners, score).unwrap_err(), FrameError::Box(why));
    }
    let cup = || with([0.0, 0.0, 2.0, 2.0], 0.5).unwrap();
    assert!(cup().masked(|u, v| u < 2 && v < 3).is_ok());
    assert_eq!(cup().masked(|_, _| false).unwrap_err(), FrameError::Mask(MaskError::Empty));
}

#[test]
fn each_image_has_its_pose_and_stamps_that_go_back_are_dropped() {
    let mut slam = ObjectSlam::new(Settings::default());
    let pose = |at: f64| Pose::translation(at, 0.0, 1.0);
    let mut see = |at: f64| {
        let (stamp, depth) = (Stamp::from_secs(at), [2.0; 12]);
        slam.see(RgbdFrame::new(stamp, &camera(), &pose(at), &depth).unwrap())
    };
    for at in [1.0, 1.1, 1.2] {
        let update = see(at);
        assert_eq!((update.poses.len(), update.keyframes.len(), update.dropped.len()), (1, 1, 0));
        assert_eq!(update.poses[0].odom_from_base, pose(at));
    }
    let late = see(1.15);
    assert!(late.dropped.iter().any(|dropped| dropped.reason == "stamp_goes_back"), "{late:?}");
}
