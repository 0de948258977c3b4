//! Where a robot can stand before an object.

use super::{independent, map_of, observation};
use crate::geometry::upright_pose;
use ellipsoid_slam::{
    geometry::{Ellipsoid, Pose, polygon_distance, yaw_of},
    mapping::{ApproachSettings, MapObject, NoApproach, Surroundings},
};
use nalgebra::{Point2, Vector3};

const SETTINGS: ApproachSettings =
    ApproachSettings { distance_m: 0.6, robot_radius_m: 0.25, robot_height_m: 1.5 };

/// Things that were seen often: label, centre, heading (rad), half extents.
fn room(things: &[(&str, [f64; 3], f64, [f64; 3])]) -> Vec<MapObject> {
    let seen = things.iter().flat_map(|(label, at, yaw, half)| {
        let e = Ellipsoid::new(upright_pose(*yaw, Vector3::from(*at)), Vector3::from(*half));
        vec![observation(label, e, independent(&e, 0.02, 0.03, 0.02)); 8]
    });
    let map = map_of(seen.collect::<Vec<_>>());
    assert_eq!(map.confirmed().count(), things.len());
    map.confirmed().cloned().collect()
}

/// Before the first object, for a robot here.
fn before(
    objects: &[MapObject],
    walls: &[[Point2<f64>; 2]],
    robot: [f64; 2],
) -> Result<Pose, NoApproach> {
    let base = Pose::translation(robot[0], robot[1], 0.02);
    Surroundings { objects, walls, base: &base }.approach(&objects[0], &SETTINGS)
}

/// A cabinet at (2, 1), turned by 30 degrees.
const CABINET: (&str, [f64; 3], f64, [f64; 3]) =
    ("cabinet", [2.0, 1.0, 0.5], std::f64::consts::FRAC_PI_6, [0.4, 0.2, 0.5]);

#[test]
fn a_robot_stands_at_its_side_and_faces_the_object() {
    let objects = room(&[CABINET]);
    for robot in [[0.0, 0.0], [4.0, 1.0], [2.0, -3.0]] {
        let pose = before(&objects, &[], robot).unwrap();
        let at: Point2<f64> = pose.translation.vector.xy().into();
        let distance = polygon_distance(&objects[0].footprint(0.0), &at).0;
        assert!((distance - 0.6).abs() < 1e-6, "{distance}");
        assert!((pose.translation.z - 0.02).abs() < 1e-9, "it is on the floor");
        let ahead =
            pose * nalgebra::Point3::new(nalgebra::distance(&at, &center(&objects[0])), 0.0, 0.0);
        assert!(nalgebra::distance(&ahead.xy(), &center(&objects[0])) < 1e-6, "{ahead}");
        // The way to the robot does not lead through the cabinet.
        let (to_robot, to_object) = (Point2::from(robot) - at, center(&objects[0]) - at);
        assert!(to_robot.dot(&to_object) < 0.0, "{robot:?}: {at}");
    }
}

fn center(object: &MapObject) -> Point2<f64> {
    object.ellipsoid().center().xy()
}

#[test]
fn where_something_is_in_the_way_it_stands_elsewhere_and_under_a_lamp_it_passes() {
    let robot = [0.0, 0.0];
    let free = before(&room(&[CABINET]), &[], robot).unwrap();
    let [x, y, _]: [f64; 3] = free.translation.vector.into();
    let bed = ("bed", [x, y, 0.3], 0.0, [0.3, 0.3, 0.3]);
    let objects = room(&[CABINET, bed]);
    let pose = before(&objects, &[], robot).unwrap();
    let at: Point2<f64> = pose.translation.vector.xy().into();
    assert!(polygon_distance(&objects[1].footprint(0.0), &at).0 >= 0.25);
    assert!((polygon_distance(&objects[0].footprint(0.0), &at).0 - 0.6).abs() < 1e-6);
    let lamp = ("lamp", [x, y, 1.9], 0.0, [0.3, 0.3, 0.3]);
    let under = before(&room(&[CABINET, lamp]), &[], robot).unwrap();
    assert!((under.translation.vector - free.translation.vector).norm() < 0.05);
}

#[test]
fn it_does_not_stand_behind_a_wall() {
    let objects = room(&[CABINET]);
    // Between the robot and the cabinet.
    let wall = [Point2::new(1.2, -5.0), Point2::new(1.2, 5.0)];
    let pose = before(&objects, &[wall], [0.0, 0.0]).unwrap();
    assert!(pose.translation.x >= 1.2 + 0.25, "{pose}");
    assert!(yaw_of(&pose).is_finite());
}

#[test]
fn before_what_stands_on_a_table_it_keeps_away_from_the_table() {
    let table = ("dining table", [0.0, 0.0, 0.4], 0.0, [0.9, 0.5, 0.4]);
    let cup = ("cup", [0.6, 0.3, 0.85], 0.0, [0.05, 0.05, 0.05]);
    let objects = room(&[cup, table]);
    // The robot is on the other side of the table.
    let pose = before(&objects, &[], [-3.0, -3.0]).unwrap();
    let at: Point2<f64> = pose.translation.vector.xy().into();
    assert!((polygon_distance(&objects[1].footprint(0.0), &at).0 - 0.6).abs() < 1e-6);
    // The nearest side is 0.2 m from the cup.
    assert!(nalgebra::distance(&at, &Point2::new(0.6, 0.3)) < 0.85, "{at}");
}

#[test]
fn a_chair_that_is_pushed_under_a_table_is_approached_from_its_free_side() {
    let chair = ("chair", [0.0, -0.6, 0.45], 0.0, [0.25, 0.25, 0.45]);
    let table = ("dining table", [0.0, 0.0, 0.4], 0.0, [0.9, 0.5, 0.4]);
    let objects = room(&[chair, table]);
    let pose = before(&objects, &[], [0.0, 4.0]).unwrap();
    let at: Point2<f64> = pose.translation.vector.xy().into();
    assert!(at.y < -0.5 && polygon_distance(&objects[1].footprint(0.0), &at).0 >= 0.25, "{at}");
}

#[test]
fn where_nothing_is_free_or_the_distance_is_none_a_sentence_says_so() {
    let beds = [(1.3, 0.0), (-1.3, 0.0), (0.0, 1.3), (0.0, -1.3)];
    let mut things = vec![("vase", [0.0, 0.0, 0.2], 0.0, [0.1, 0.1, 0.2])];
    things.extend(beds.map(|(x, y)| ("bed", [x, y, 0.3], 0.0, [0.9, 0.9, 0.3])));
    let objects = room(&things);
    let why = before(&objects, &[], [5.0, 5.0]).unwrap_err();
    assert!(matches!(why, NoApproach::NothingFree { .. }));
    assert!(why.to_string().contains("before vase 1 is free"), "{why}");
    for distance_m in [0.1, -1.0, f64::NAN, 1e9] {
        let settings = ApproachSettings { distance_m, ..SETTINGS };
        let base = Pose::identity();
        let surroundings = Surroundings { objects: &objects, walls: &[], base: &base };
        let why = surroundings.approach(&objects[0], &settings).unwrap_err();
        assert!(matches!(why, NoApproach::BadDistance { .. }), "{why}");
    }
}
