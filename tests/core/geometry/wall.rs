use super::{ROUNDING, points, upright_pose, vectors, walls};
use ellipsoid_slam::geometry::Wall;
use nalgebra::{Point2, Vector2, Vector3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// Between a wall and the line of another one, at two places of the first (m).
fn apart_m(a: &Wall, b: &Wall) -> f64 {
    let ends = [-2.0, 2.0].map(|along| b.signed_distance(&(a.point + a.along() * along)));
    ends[0].abs().max(ends[1].abs())
}

#[test]
fn the_northern_wall_of_a_room() {
    // It is seen from the south: its normal points to -y.
    let wall = Wall { point: Point2::new(1.0, 3.0), heading: -FRAC_PI_2 };
    assert!((wall.signed_distance(&Point2::new(-4.0, 2.5)) - 0.5).abs() < ROUNDING);
    assert!((wall.along() - Vector2::x()).norm() < ROUNDING, "a quarter turn on");
    let nearer = wall.retract(&Vector2::new(0.0, 0.5));
    assert!(nearer.signed_distance(&Point2::new(7.0, 2.5)).abs() < ROUNDING, "towards the room");
    let turned = wall.retract(&Vector2::new(0.1, 0.0));
    assert!((turned.signed_distance(&Point2::new(1.0, 3.0))).abs() < ROUNDING, "about its point");
    assert!(turned.signed_distance(&Point2::new(3.0, 3.0)) > 0.1, "its eastern end goes back");
}

#[test]
fn a_turn_is_the_shorter_one() {
    let wall = |heading| Wall { point: Point2::origin(), heading };
    let turn = wall(PI - 0.1).local(&wall(-PI + 0.1)).x;
    assert!((turn - 0.2).abs() < ROUNDING);
}

proptest! {
    #[test]
    fn distances_stay_when_all_is_moved(
        wall in walls(), point in points(), yaw in -3.1..3.1, shift in vectors(5.0),
    ) {
        let a_from_b = upright_pose(yaw, shift);
        let there = wall.transformed(&a_from_b).signed_distance(&(a_from_b * point).xy());
        prop_assert!((there - wall.signed_distance(&point.xy())).abs() < ROUNDING);
    }

    #[test]
    fn the_step_to_another_wall_leads_there(a in walls(), b in walls()) {
        prop_assume!((a.local(&b).x).abs() < 3.0);
        let there = a.retract(&a.local(&b));
        prop_assert!(apart_m(&b, &there) < 1e-6, "{b:?} {there:?}");
        prop_assert!((b.normal() - there.normal()).norm() < ROUNDING);
    }

    #[test]
    fn height_and_tilt_do_not_matter(wall in walls(), z in -3.0..3.0) {
        let up = upright_pose(0.0, Vector3::new(0.0, 0.0, z));
        prop_assert_eq!(wall.transformed(&up), wall);
    }
}
