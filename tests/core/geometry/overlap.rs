use super::{poses, upright_ellipsoids, upright_pose};
use ellipsoid_slam::geometry::{
    Ellipsoid, OrientedBox, Pose, intersection_over_union, intersection_volume,
};
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::FRAC_PI_4;

fn cuboid(pose: Pose, half_extents: [f64; 3]) -> OrientedBox {
    OrientedBox { pose, half_extents: half_extents.into() }
}

fn at(x: f64, y: f64, z: f64, half_extents: [f64; 3]) -> OrientedBox {
    cuboid(Pose::translation(x, y, z), half_extents)
}

/// Boxes near the origin, so that most pairs overlap.
fn boxes() -> impl Strategy<Value = OrientedBox> {
    let side = 0.1..1.0;
    (poses(), (side.clone(), side.clone(), side)).prop_map(|(mut pose, (x, y, z))| {
        pose.translation.vector *= 0.1;
        cuboid(pose, [x, y, z])
    })
}

fn holds(b: &OrientedBox, point: &Point3<f64>) -> bool {
    let own = b.pose.inverse_transform_point(point).coords.abs();
    (own - b.half_extents).max() <= 0.0
}

/// The common part's volume and its standard error by throwing points into `a`.
fn by_chance(a: &OrientedBox, b: &OrientedBox, throws: u32) -> (f64, f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut hits = 0;
    for _ in 0..throws {
        let own = a.half_extents.map(|h| h * rng.random_range(-1.0..1.0));
        hits += u32::from(holds(b, &(a.pose * Point3::from(own))));
    }
    let share = f64::from(hits) / f64::from(throws);
    let error = (share * (1.0 - share) / f64::from(throws)).sqrt();
    (share * a.volume(), error * a.volume())
}

#[test]
fn parallel_boxes_by_hand() {
    let unit = at(0.0, 0.0, 0.0, [0.5; 3]);
    for (other, expected) in [
        (at(0.0, 0.0, 0.0, [0.5; 3]), 1.0),
        (at(0.5, 0.0, 0.0, [0.5; 3]), 0.5),
        (at(0.5, 0.5, 0.5, [0.5; 3]), 0.125),
        (at(0.0, 0.0, 0.0, [0.1, 0.2, 0.3]), 8.0 * 0.006),
        (at(0.0, 0.0, 0.0, [5.0, 5.0, 0.1]), 0.2),
        (at(1.0, 0.0, 0.0, [0.5; 3]), 0.0),
        (at(3.0, 0.0, 0.0, [0.5; 3]), 0.0),
    ] {
        let got = intersection_volume(&unit, &other);
        assert!((got - expected).abs() < 1e-12, "{other:?}: {got}");
    }
    assert!(
        (intersection_over_union(&unit, &at(0.5, 0.0, 0.0, [0.5; 3])) - 1.0 / 3.0).abs() < 1e-12
    );
}

#[test]
fn a_square_turned_by_45_degrees_leaves_an_octagon() {
    let straight = at(0.0, 0.0, 0.0, [1.0, 1.0, 0.5]);
    let turned = cuboid(upright_pose(FRAC_PI_4, Vector3::zeros()), [1.0, 1.0, 0.5]);
    // The regular octagon around a circle of radius 1, one metre high.
    let octagon = 8.0 * (std::f64::consts::FRAC_PI_8).tan();
    assert!((intersection_volume(&straight, &turned) - octagon).abs() < 1e-12);
}

#[test]
fn a_cube_cut_across_its_corner_leaves_a_tetrahedron() {
    // The other box ends at x + y + z = -1 inside the cube of half extent 1: legs of 2 m from the corner (-1,-1,-1).
    let normal = Vector3::new(1.0, 1.0, 1.0) / 3.0_f64.sqrt();
    let rotation = UnitQuaternion::rotation_between(&Vector3::x(), &normal).unwrap();
    let far = 10.0;
    let center = normal * (-1.0 / 3.0_f64.sqrt() - far);
    let other = cuboid(Pose::from_parts(Translation3::from(center), rotation), [far; 3]);
    let got = intersection_volume(&at(0.0, 0.0, 0.0, [1.0; 3]), &other);
    assert!((got - 8.0 / 6.0).abs() < 1e-9, "{got}");
}

#[test]
fn the_exact_volume_is_what_chance_finds() {
    let pairs = [
        (upright_pose(0.3, Vector3::new(0.2, 0.1, 0.0)), [0.6, 0.3, 0.4]),
        (upright_pose(1.1, Vector3::new(-0.3, 0.2, 0.3)), [0.9, 0.2, 0.5]),
        (Pose::new(Vector3::new(0.1, 0.2, 0.3), Vector3::new(0.5, -0.8, 1.2)), [0.7, 0.4, 0.3]),
    ];
    let a = cuboid(Pose::new(Vector3::zeros(), Vector3::new(0.1, 0.2, -0.4)), [0.5, 0.4, 0.6]);
    for (pose, half_extents) in pairs {
        let b = cuboid(pose, half_extents);
        let (expected, error) = by_chance(&a, &b, 100_000);
        let got = intersection_volume(&a, &b);
        // Four standard errors: once in 16,000 draws, and the draw is always the same.
        assert!((got - expected).abs() < 4.0 * error, "{got} against {expected} ± {error}");
        assert!(got > 10.0 * error, "the boxes overlap");
    }
}

proptest! {
    #[test]
    fn overlap_is_a_symmetric_share(a in boxes(), b in boxes()) {
        let common = intersection_volume(&a, &b);
        prop_assert!((common - intersection_volume(&b, &a)).abs() < 1e-9);
        prop_assert!(common <= a.volume().min(b.volume()) + 1e-9);
        let share = intersection_over_union(&a, &b);
        prop_assert!((0.0..=1.0 + 1e-9).contains(&share));
        prop_assert!((share - intersection_over_union(&b, &a)).abs() < 1e-9);
        prop_assert!((intersection_over_union(&a, &a) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn moving_both_changes_nothing(a in boxes(), b in boxes(), motion in poses()) {
        let moved = |x: &OrientedBox| OrientedBox { pose: motion * x.pose, ..*x };
        let there = intersection_volume(&moved(&a), &moved(&b));
        prop_assert!((there - intersection_volume(&a, &b)).abs() < 1e-8);
    }

    #[test]
    fn naming_axes_differently_changes_nothing(
        a in upright_ellipsoids(), b in upright_ellipsoids(), quarters in 1_i64..4,
    ) {
        // Near each other.
        let b = Ellipsoid { pose: Pose::from_parts(a.pose.translation, b.pose.rotation), ..b };
        let share = |b: &Ellipsoid| intersection_over_union(&(&a).into(), &b.into());
        prop_assert!((share(&b.quarter_turned(quarters)) - share(&b)).abs() < 1e-8);
        let renamed = a.quarter_turned(quarters);
        prop_assert!((intersection_over_union(&(&a).into(), &(&renamed).into()) - 1.0).abs() < 1e-8);
    }

    #[test]
    fn corners_are_in_the_box_and_span_it(b in boxes()) {
        let corners = b.corners();
        let slightly_larger = OrientedBox { half_extents: b.half_extents * 1.000_001, ..b };
        prop_assert!(corners.iter().all(|c| holds(&slightly_larger, c)));
        let diagonal = (corners[0] - corners[7]).norm();
        prop_assert!((diagonal - 2.0 * b.half_extents.norm()).abs() < 1e-9);
    }
}
