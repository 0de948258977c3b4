//! What limits an object that is not seen as a whole: walls, and the edges of its own top.

use super::{estimate_all, in_world, measure};
use crate::scene::{Scene, detection, looking, round_all, standing};
use ellipsoid_slam::geometry::yaw_of;
use nalgebra::Point3;
use std::f64::consts::FRAC_PI_2;

/// Nothing tells how deep a wardrobe is that is seen from the front, but the wall that it stands against does.
#[test]
fn nothing_reaches_into_a_wall() {
    let back_m = |wall_m: f64| {
        let mut scene = Scene::with_floor();
        scene.add(standing(0.0, [wall_m + 0.05, 0.0, 1.5], [0.05, 5.0, 1.5]));
        let wardrobe = scene.add(standing(0.0, [2.75, 0.0, 1.0], [0.15, 0.8, 1.0]));
        let view = scene.seen_from(&looking([0.0, 0.0, 1.2], 0.0, 0.0));
        let e = in_world(&measure(&view, "cabinet", wardrobe), &view, scene.thing(wardrobe));
        assert!((e.center().x - e.semi_axes.x - 2.6).abs() < 0.02, "the front is at 2.6 m: {e:?}");
        e.center().x + e.semi_axes.x
    };
    assert!(back_m(2.95) < 2.97, "{} m", back_m(2.95));
    assert!(back_m(4.5) > 3.0, "without the wall it is thought to be deeper: {} m", back_m(4.5));
}

/// The back of a couch that stands in a room is no wall that it could not reach into.
#[test]
fn what_is_seen_of_a_thing_is_no_wall_behind_it() {
    let mut scene = Scene::with_floor();
    let couch = scene.add(standing(0.0, [2.95, 0.0, 0.9], [0.45, 1.0, 0.9]));
    let view = scene.seen_from(&looking([0.0, 0.0, 1.5], 0.0, 10.0));
    let e = in_world(&measure(&view, "couch", couch), &view, scene.thing(couch));
    assert!(e.semi_axes.x > 0.3, "couches are deeper than their backs: {e:?}");
}

/// A table that is turned and stands behind a chair: what is seen of its top ends where the chair begins, too.
#[test]
fn a_top_is_turned_as_its_own_edges_are() {
    for (yaw, seed) in [(0.25, 1), (-0.25, 2), (0.4, 3)] {
        let mut scene = Scene::with_floor();
        let table = scene.add(standing(yaw, [2.6, 0.0, 0.72], [0.4, 0.75, 0.02]));
        let place = standing(yaw, [2.6, 0.0, 0.35], [0.4, 0.75, 0.35]).pose;
        let legs = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)].map(|(x, y)| {
            let at = place * Point3::new(0.36 * x, 0.71 * y, 0.0);
            scene.add(standing(yaw, at.into(), [0.03, 0.03, 0.35]))
        });
        let chair = scene.add(standing(0.0, [1.75, -0.4, 0.5], [0.2, 0.35, 0.5]));
        let view = scene.seen_with(&looking([0.0, 0.0, 1.3], 0.0, 15.0), Some(seed));
        let parts = legs.into_iter().filter_map(|leg| view.try_box_around(leg));
        let table = round_all(parts.chain([view.box_around(table)]));
        let boxes = [detection("dining table", table), detection("chair", view.box_around(chair))];
        let m = estimate_all(&view, &boxes).objects.remove(0).unwrap();
        let off = yaw_of(&(view.world_from_camera * m.ellipsoid.pose)) - yaw;
        let off = off - FRAC_PI_2 * (off / FRAC_PI_2).round();
        assert!(off.abs() < 0.06, "turned by {off} rad against the true heading {yaw}");
        assert!(m.covariance[(2, 2)].sqrt() < 0.1, "{}", m.covariance[(2, 2)].sqrt());
    }
}
