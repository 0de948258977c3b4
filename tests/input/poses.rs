//! Odometry and transforms.

use crate::fixtures::{self, header, odometry, stamp, transforms};
use ellipsoid_slam::msg::{
    convert::{self, odometry_message, tf_message},
    geometry_msgs::{Quaternion, TransformStamped},
    nav_msgs::Odometry,
    tf2_msgs::TFMessage,
};
use nalgebra::{Point3, Vector3};

/// A quarter turn to the left about z, of length two.
const LEFT: Quaternion =
    Quaternion { x: 0.0, y: 0.0, z: std::f64::consts::SQRT_2, w: std::f64::consts::SQRT_2 };
const BAD: [Quaternion; 4] = [
    Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 0.0 },
    Quaternion { x: f64::NAN, y: 0.0, z: 0.0, w: 1.0 },
    Quaternion { x: 0.0, y: f64::INFINITY, z: 0.0, w: 1.0 },
    Quaternion { x: 0.0, y: 0.0, z: 1e200, w: 1e200 },
];

fn turned(rotation: Quaternion) -> Odometry {
    let mut message = odometry(12);
    message.pose.pose.orientation = rotation;
    message
}

#[test]
fn odometry_is_odom_from_base_with_a_unit_quaternion() {
    let got = convert::odometry(&turned(LEFT)).unwrap();
    assert_eq!(
        (got.stamp, got.frame_id.as_str(), got.child_frame_id.as_str()),
        (stamp(12), "odom", "base_link")
    );
    let ahead = got.odom_from_base * Point3::new(1.0, 0.0, 0.0);
    assert!((ahead - Point3::new(1.0, 3.0, 3.0)).norm() < 1e-12, "{ahead}");
}

#[test]
fn poses_that_are_none_are_refused_by_name() {
    for rotation in BAD {
        let error = convert::odometry(&turned(rotation)).unwrap_err();
        assert_eq!(error.reason(), "bad_pose");
        assert!(error.to_string().contains("`base_link` in `odom`"), "{error}");
    }
    let mut nowhere = odometry(0);
    nowhere.pose.pose.position.y = f64::NAN;
    assert_eq!(convert::odometry(&nowhere).unwrap_err().reason(), "bad_pose");
}

#[test]
fn covariance_counts_only_where_it_was_filled_in() {
    let mut message = odometry(0);
    assert_eq!(convert::odometry(&message).unwrap().covariance, None);
    (message.pose.covariance[0][0], message.pose.covariance[1][2], message.pose.covariance[5][5]) =
        (0.25, 0.5, 0.75);
    let got = convert::odometry(&message).unwrap().covariance.unwrap();
    assert_eq!((got[0], got[8], got[35]), (0.25, 0.5, 0.75));
    message.pose.covariance[3][3] = f64::NAN;
    assert_eq!(convert::odometry(&message).unwrap().covariance, None);
}

#[test]
fn a_bad_transform_costs_only_itself() {
    let mut message = TFMessage::default();
    for rotation in [BAD[0], LEFT, BAD[1]] {
        let mut one: TransformStamped = transforms(5).transforms.remove(0);
        one.transform.rotation = rotation;
        one.header = header(5, "/base_link");
        message.transforms.push(one);
    }
    let (good, bad) = convert::transforms(&message);
    assert_eq!(bad.iter().map(|why| why.reason()).collect::<Vec<_>>(), ["bad_pose", "bad_pose"]);
    let [only] = good.as_slice() else { panic!("{good:?}") };
    assert_eq!((only.frame_id.as_str(), only.child_frame_id.as_str()), ("base_link", "camera"));
    let ahead = only.parent_from_child * Vector3::x();
    assert!((ahead - Vector3::y()).norm() < 1e-12);
    assert_eq!(only.parent_from_child.translation.vector, Vector3::new(0.1, 0.2, 0.3));
}

#[test]
fn what_is_written_is_read_again() {
    let mut message = turned(LEFT);
    message.pose.covariance[0][1] = 0.5;
    let reading = convert::odometry(&message).unwrap();
    let again = convert::odometry(&odometry_message(&reading)).unwrap();
    assert_eq!(
        (again.stamp, again.odom_from_base, again.covariance),
        (reading.stamp, reading.odom_from_base, reading.covariance)
    );
    let (good, _) = convert::transforms(&transforms(5));
    assert_eq!(tf_message(&good), transforms(5));
}

#[test]
fn long_names_are_refused_and_cut_where_they_are_shown() {
    let long = "x".repeat(1_000_000);
    let mut reading = fixtures::odometry(0);
    reading.child_frame_id.clone_from(&long);
    let mut tree = fixtures::transforms(0);
    tree.transforms[0].header.frame_id.clone_from(&long);
    let mut image = fixtures::depth(0);
    image.encoding = format!("two\nlines{long}");
    let mut boxes = fixtures::detections(0);
    boxes.detections[0].results[0].hypothesis.class_id.clone_from(&long);
    let errors = [
        convert::odometry(&reading).unwrap_err(),
        convert::transforms(&tree).1.remove(0),
        convert::depth_image(&image, &[]).unwrap_err(),
        convert::detections(&boxes, None).1.remove(0),
    ];
    for error in errors {
        let said = error.to_string();
        assert!(said.len() < 300 && !said.contains('\n'), "{} bytes", said.len());
        assert!(said.contains("(10000"), "{said}");
    }
}
