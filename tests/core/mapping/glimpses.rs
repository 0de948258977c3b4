//! What is known of objects that were never measured.

use super::{Covariance, given_identities, independent, observation};
use crate::geometry::upright_pose;
use ellipsoid_slam::{
    geometry::{Ellipsoid, ImageSide, Outline, Plane, Pose, Silhouette},
    graph::BoxSide,
    mapping::{
        Hints, MappingSettings, ObjectMap, Observation, ObservedBox, Sighting, SlamSettings,
    },
    perception::UsualSize,
    time::Stamp,
};
use nalgebra::{Matrix3, Point3, UnitQuaternion, Vector3};
use std::f64::consts::FRAC_PI_2;

/// A refrigerator 8 m before the robot.
fn refrigerator() -> Ellipsoid {
    Ellipsoid::new(Pose::translation(8.0, 0.0, 0.8), Vector3::new(0.35, 0.35, 0.8))
}

/// The exact box of it from a camera 1 m above the floor, with a range and a size that are a third too small, and the level
/// plane that the image shows at a height (m).
fn glimpsed(odom_from_base: &Pose, plane_height_m: f64) -> Observation {
    let rotation = UnitQuaternion::from_euler_angles(-FRAC_PI_2, 0.0, -FRAC_PI_2);
    let base_from_camera = Pose::from_parts(Vector3::new(0.0, 0.0, 1.0).into(), rotation);
    let camera_from_odom = (odom_from_base * base_from_camera).inverse();
    let seen = Silhouette::new(&refrigerator().transformed(&camera_from_odom), Outline::Cuboid);
    let sides = ImageSide::ALL.map(|side| seen.tangent(side, 0.0).at);
    let in_base = refrigerator().transformed(&odom_from_base.inverse());
    let nearer = Vector3::new(0.67, 0.67, 0.67).component_mul(&in_base.center().coords);
    let guess = Ellipsoid::new(upright_pose(0.0, nearer), 0.67 * in_base.semi_axes);
    let mut observation = observation("refrigerator", guess, Covariance::identity());
    observation.track = Some(1);
    observation.sides =
        ObservedBox { base_from_camera, sides: sides.map(|at| Some(BoxSide { at, sigma: 0.006 })) };
    if let Some(measured) = &mut observation.measured {
        measured.support =
            Some(Plane::through(&Point3::new(0.0, 0.0, plane_height_m), Vector3::z_axis()));
        measured.glimpse = Some(Hints {
            depth_covariance: Covariance::identity() * 1e4,
            usual: UsualSize { semi_axes: guess.semi_axes, covariance: Matrix3::identity() * 0.2 },
        });
    }
    observation
}

/// Looks at it from one place; the images show level planes at these heights (m).
fn map_of(plane_heights_m: &[f64]) -> ObjectMap {
    let mut map = ObjectMap::new(given_identities(), SlamSettings::default());
    for (i, height_m) in plane_heights_m.iter().enumerate() {
        let odom_from_base = Pose::translation(0.0, 0.03 * i as f64, 0.0);
        map.observe(&Sighting {
            stamp: Stamp::from_secs(i as f64),
            odom_from_base,
            odometry_covariance: None,
            observations: vec![glimpsed(&odom_from_base, *height_m)],
            walls: Vec::new(),
            view: None,
        });
    }
    map
}

#[test]
fn the_floor_and_the_lower_side_of_a_box_say_how_far_off_it_is() {
    let map = map_of(&[0.0; 6]);
    let body = map.all()[0].ellipsoid();
    assert!(map.all()[0].is_glimpsed());
    // The guess is 2.6 m too near.
    assert!((body.center() - refrigerator().center()).norm() < 0.3, "{}", body.center());
    assert!((body.center().z - body.semi_axes.z).abs() < 0.05, "it stands on the floor");
}

#[test]
fn a_table_top_that_hid_the_floor_at_first_is_not_what_it_stands_on() {
    let map = map_of(&[0.7, 0.0, 0.0, 0.7, 0.0, 0.0]);
    let body = map.all()[0].ellipsoid();
    assert!((body.center().z - body.semi_axes.z).abs() < 0.05, "it stands on the floor");
    assert!((body.center() - refrigerator().center()).norm() < 0.3, "{}", body.center());
}

/// Looks at a chair 4.2 m off: first from so far away that there are only glimpses, which put it at another place (m) and are
/// surer of the range than they should be; then it is measured, with what was glimpsed in sight again or not.
fn chairs_of(glimpsed_at: [f64; 2], is_seen_beside: bool) -> Vec<Point3<f64>> {
    let mut map = ObjectMap::new(MappingSettings::default(), SlamSettings::default());
    let size = Vector3::new(0.22, 0.22, 0.45);
    let at =
        |[x, y]: [f64; 2]| Ellipsoid::new(upright_pose(y.atan2(x), Vector3::new(x, y, 0.45)), size);
    let glimpse = || {
        let body = at(glimpsed_at);
        let mut covariance = independent(&body, 1.0, 0.05, 0.1);
        covariance[(3, 3)] = 0.4 * 0.4;
        let mut observation = observation("chair", body, covariance);
        let usual = UsualSize { semi_axes: size, covariance: Matrix3::identity() * 0.2 };
        observation.measured.iter_mut().for_each(|measured| {
            measured.glimpse = Some(Hints { depth_covariance: covariance, usual });
        });
        observation
    };
    let body = at([4.2, 0.0]);
    let measured = || observation("chair", body, independent(&body, 0.05, 0.02, 0.02));
    let mut look = |i: usize, observations: Vec<Observation>| {
        map.observe(&Sighting {
            stamp: Stamp::from_secs(i as f64),
            odom_from_base: Pose::identity(),
            odometry_covariance: None,
            observations,
            walls: Vec::new(),
            view: None,
        });
    };
    (0..8).for_each(|i| look(i, vec![glimpse()]));
    for i in 8..14 {
        let beside = is_seen_beside.then(glimpse);
        look(i, beside.into_iter().chain([measured()]).collect());
    }
    map.confirmed().map(|object| object.ellipsoid().center()).collect()
}

#[test]
fn what_was_glimpsed_in_the_direction_of_what_is_measured_is_the_same() {
    let [only] = chairs_of([3.0, 0.0], false)[..] else { panic!("one chair") };
    assert!((only - Point3::new(4.2, 0.0, 0.45)).norm() < 0.05, "{only}");
    assert_eq!(chairs_of([3.0, 0.5], false).len(), 2, "it was seen in another direction");
    assert_eq!(chairs_of([3.0, 0.0], true).len(), 2, "it was seen beside it");
}
