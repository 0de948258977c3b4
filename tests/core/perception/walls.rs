//! Rooms with walls.

use crate::scene::{Scene, View, camera, looking, standing};
use ellipsoid_slam::perception::{
    DepthImage, DepthNoise, Frame, Rays, WallSegment, WallSettings, find_walls,
};
use nalgebra::Vector3;
use std::f64::consts::FRAC_PI_2;

/// A wall 3 m north of the origin, and one 4 m east of it.
fn room() -> Scene {
    let mut scene = Scene::with_floor();
    scene.add(standing(0.0, [0.0, 3.05, 1.25], [6.0, 0.05, 1.25]));
    scene.add(standing(0.0, [4.05, 0.0, 1.25], [0.05, 6.0, 1.25]));
    scene
}

fn walls_in(view: &View) -> Vec<WallSegment> {
    let rays = Rays::new(camera());
    let frame = Frame::new(&view.depth, &rays, &view.up_in_camera(), DepthNoise::default());
    find_walls(&frame, 6.0, &WallSettings::default())
}

/// Heading of the normal (rad), and the middle, in the world.
fn in_world(view: &View, wall: &WallSegment) -> (f64, Vector3<f64>) {
    let normal = view.world_from_camera * wall.normal;
    (normal.y.atan2(normal.x), (view.world_from_camera * wall.center).coords)
}

#[test]
fn both_walls_of_a_corner_are_seen_where_they_are() {
    for (seed, yaw) in [(1, 0.6), (2, 0.7), (3, 0.8)] {
        let view = room().seen_with(&looking([0.5, 0.2, 1.0], yaw, 8.0), Some(seed));
        let mut walls = walls_in(&view);
        assert_eq!(walls.len(), 2, "{walls:?}");
        walls.sort_by(|a, b| in_world(&view, a).1.y.total_cmp(&in_world(&view, b).1.y));
        let (east, north) = (in_world(&view, &walls[0]), in_world(&view, &walls[1]));
        assert!(east.0.abs() > 3.12 && (east.1.x - 4.0).abs() < 0.01, "{east:?}");
        assert!((north.0 + FRAC_PI_2).abs() < 0.02 && (north.1.y - 3.0).abs() < 0.01, "{north:?}");
        for wall in &walls {
            assert!(wall.heading_sigma < 0.03 && wall.distance_sigma_m < 0.05);
        }
    }
}

#[test]
fn its_middle_and_length_are_those_of_what_is_seen() {
    let mut scene = Scene::with_floor();
    scene.add(standing(0.0, [0.5, 3.05, 1.25], [1.0, 0.05, 1.25]));
    let view = scene.seen_from(&looking([0.0, 0.0, 1.0], FRAC_PI_2, 8.0));
    let [wall] = walls_in(&view)[..] else { panic!("one wall") };
    // Normals need neighbours on both sides.
    assert!((wall.half_length_m - 0.95).abs() < 0.06, "{wall:?}");
    assert!((in_world(&view, &wall).1.x - 0.5).abs() < 0.05);
}

#[test]
fn furniture_before_a_wall_is_no_wall() {
    let mut scene = room();
    // A sideboard whose front is turned by 20 degrees: one sees the wall above it.
    scene.add(standing(0.35, [0.0, 2.0, 0.4], [0.9, 0.25, 0.4]));
    let view = scene.seen_with(&looking([0.0, -0.5, 1.0], FRAC_PI_2, 10.0), Some(4));
    let walls = walls_in(&view);
    assert!(!walls.is_empty());
    for wall in &walls {
        let (heading, middle) = in_world(&view, wall);
        assert!((heading + FRAC_PI_2).abs() < 0.02 && (middle.y - 3.0).abs() < 0.02, "{middle}");
    }
}

#[test]
fn a_row_of_things_is_no_wall() {
    let mut scene = Scene::with_floor();
    // Posts of a fence, each turned by 40 degrees: their points lie along a line, their faces do not.
    for i in 0..9 {
        let x = -1.8 + 0.45 * f64::from(i);
        scene.add(standing(0.7, [x, 3.0, 1.25], [0.14, 0.14, 1.25]));
    }
    let view = scene.seen_with(&looking([0.0, 0.0, 1.0], FRAC_PI_2, 8.0), Some(5));
    assert_eq!(walls_in(&view), []);
}

#[test]
fn a_camera_that_is_tilted_to_the_side_sees_the_same() {
    let level = looking([0.5, 0.2, 1.0], 0.8, 8.0);
    let roll = nalgebra::UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.3);
    let mut tilted = level;
    tilted.rotation *= roll;
    let places = |world_from_camera| {
        let view = room().seen_from(&world_from_camera);
        let walls = walls_in(&view);
        let mut found: Vec<_> = walls.iter().map(|w| in_world(&view, w)).collect();
        found.sort_by(|a, b| a.1.y.total_cmp(&b.1.y));
        found
    };
    let (a, b) = (places(level), places(tilted));
    assert_eq!((a.len(), b.len()), (2, 2));
    for (a, b) in a.iter().zip(&b) {
        assert!((a.0 - b.0).sin().abs() < 0.01, "{a:?} {b:?}");
    }
    assert!((b[0].1.x - 4.0).abs() < 0.01 && (b[1].1.y - 3.0).abs() < 0.01);
}

#[test]
fn no_depth_and_open_space_have_none() {
    let rays = Rays::new(camera());
    let up = looking([0.0, 0.0, 1.0], 0.0, 8.0).rotation.inverse() * Vector3::z_axis();
    for value in [f32::NAN, 0.0] {
        let depth = DepthImage::new(640, 480, vec![value; 640 * 480]).unwrap();
        let frame = Frame::new(&depth, &rays, &up, DepthNoise::default());
        assert_eq!(find_walls(&frame, 6.0, &WallSettings::default()), []);
    }
    let view = Scene::with_floor().seen_with(&looking([0.0, 0.0, 1.0], 0.0, 8.0), Some(6));
    assert_eq!(walls_in(&view), []);
}

#[test]
fn none_are_wanted() {
    let view = room().seen_from(&looking([0.5, 0.2, 1.0], 0.8, 8.0));
    let rays = Rays::new(camera());
    let frame = Frame::new(&view.depth, &rays, &view.up_in_camera(), DepthNoise::default());
    let settings = WallSettings { max_walls: 0, ..WallSettings::default() };
    assert_eq!(find_walls(&frame, 6.0, &settings), []);
}
