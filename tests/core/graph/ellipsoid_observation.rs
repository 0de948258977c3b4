use super::{cost, covariances, ids, outlines};
use crate::{
    geometry::{ellipsoids, poses, upright_ellipsoids, upright_pose},
    mapping::{Covariance, by_faces, independent},
};
use ellipsoid_slam::{
    geometry::{Ellipsoid, Outline, Pose},
    graph::{
        EllipsoidObservation, Factor, NoiseError,
        Variable::{Ellipsoid as Body, Pose as Place},
    },
};
use nalgebra::Vector3;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

fn observation(z: Ellipsoid, covariance: &Covariance, outline: Outline) -> EllipsoidObservation {
    let (pose, _, object) = ids();
    EllipsoidObservation::new(pose, object, z, covariance, outline).unwrap()
}

/// Cost of an object in the frame of the pose.
fn cost_of(factor: &EllipsoidObservation, object: Ellipsoid) -> f64 {
    cost(factor, &[Place(Pose::identity()), Body(object)])
}

fn cabinet() -> Ellipsoid {
    Ellipsoid::new(upright_pose(0.4, Vector3::new(1.0, 2.0, 0.4)), Vector3::new(0.5, 0.2, 0.4))
}

fn turned(e: &Ellipsoid, angle: f64) -> Ellipsoid {
    Ellipsoid::new(e.pose * upright_pose(angle, Vector3::zeros()), e.semi_axes)
}

fn upside_down(e: &Ellipsoid) -> Ellipsoid {
    Ellipsoid::new(e.pose * Pose::rotation(Vector3::x() * PI), e.semi_axes)
}

/// Names of the axes of the same body.
fn renamings(e: &Ellipsoid) -> Vec<Ellipsoid> {
    (0..4).flat_map(|q| [e.quarter_turned(q), upside_down(&e.quarter_turned(q))]).collect()
}

/// Everything along the axes of the measurement, which is turned by a right angle against the pose.
#[test]
fn by_hand() {
    let z = Ellipsoid::new(
        upright_pose(FRAC_PI_2, Vector3::new(2.0, 0.0, 0.0)),
        Vector3::new(0.5, 0.2, 0.4),
    );
    let factor = observation(z, &independent(&z, 0.05, 0.02, 0.01), Outline::Cuboid);
    let object = Ellipsoid::new(
        upright_pose(FRAC_PI_2 + 0.1, Vector3::new(2.04, 0.02, -0.06)),
        Vector3::new(0.51, 0.22, 0.37),
    );
    let residual = factor.residual(&[Place(Pose::identity()), Body(object)]);
    // The pose's x is the measurement's -y.
    let expected = [0.0, 0.0, 2.0, 1.0, -2.0, -3.0, 1.0, 2.0, -3.0];
    for (got, expected) in residual.iter().zip(expected) {
        assert!((got - expected).abs() < 1e-9, "{residual}");
    }
}

#[test]
fn the_paper_s_weight_scales_the_cost() {
    let z = cabinet();
    let factor = observation(z, &independent(&z, 0.05, 0.02, 0.01), Outline::Cuboid);
    let object = turned(&z, 0.1);
    let half = factor.clone().scaled(0.5).unwrap();
    assert!((cost_of(&half, object) - 0.5 * cost_of(&factor, object)).abs() < 1e-9);
    let refused = factor.scaled(f64::NAN).unwrap_err();
    assert!(matches!(refused, NoiseError::Scale { .. }));
}

#[test]
fn a_bad_covariance_is_refused_even_where_the_heading_fades() {
    let (pose, _, object) = ids();
    let z = Ellipsoid::new(Pose::identity(), Vector3::new(0.3, 0.3, 0.4));
    for bad in [f64::NAN, -1.0, f64::INFINITY] {
        let mut covariance = independent(&z, 0.05, 0.02, 0.01);
        covariance[(2, 2)] = bad;
        let made = EllipsoidObservation::new(pose, object, z, &covariance, Outline::Cylinder);
        assert!(made.is_err(), "{bad} was taken");
    }
}

/// What one view cannot see is along its line of sight, whatever the heading of the object.
#[test]
fn a_hidden_side_is_hidden_where_it_is_not_where_the_heading_says() {
    let z = Ellipsoid::new(Pose::identity(), Vector3::new(0.4, 0.4, 0.3));
    let covariance = by_faces(&z, 0.8, [0.3, 0.3, 0.01, 0.01, 0.01, 0.01]);
    let factor = observation(z, &covariance, Outline::Cylinder);
    let object =
        |x: f64, y: f64| Ellipsoid::new(upright_pose(0.7, Vector3::new(x, y, 0.0)), z.semi_axes);
    // Half a sigma of 0.3 / sqrt(2) m, and 14 sigma of 0.01 / sqrt(2) m.
    assert!((cost_of(&factor, object(0.1, 0.0)) - 0.5 * 0.02 / 0.09).abs() < 1e-4);
    assert!((cost_of(&factor, object(0.0, 0.1)) - 0.5 * 200.0).abs() < 1e-4);
}

#[test]
fn growing_towards_the_hidden_side_is_free() {
    let z = Ellipsoid::new(Pose::identity(), Vector3::new(0.4, 0.4, 0.3));
    let factor =
        observation(z, &by_faces(&z, 0.01, [0.01, 10.0, 0.01, 0.01, 0.01, 0.01]), Outline::Cuboid);
    let grown = |shift: f64| {
        let semi_axes = z.semi_axes + Vector3::new(0.2, 0.0, 0.0);
        Ellipsoid::new(Pose::translation(shift, 0.0, 0.0), semi_axes)
    };
    // The seen face stays, the hidden one moves by 0.4 m.
    assert!(cost_of(&factor, grown(0.2)) < 0.001);
    // The seen face moves by 0.4 m: 40 sigma.
    assert!((cost_of(&factor, grown(-0.2)) - 800.0).abs() < 1.0);
}

#[test]
fn the_heading_fades_as_the_footprint_becomes_round() {
    let heading_cost = |outline: Outline, a: f64, b: f64, turn: f64| {
        let z = Ellipsoid::new(upright_pose(0.3, Vector3::zeros()), Vector3::new(a, b, 0.3));
        let factor = observation(z, &independent(&z, 0.1, 0.02, 0.01), outline);
        cost_of(&factor, turned(&z, turn))
    };
    let full = 0.5 * (FRAC_PI_4 / 0.1).powi(2);
    for outline in [Outline::Ellipsoid, Outline::Cylinder, Outline::Superquadric(0.5, 1.0)] {
        assert!(heading_cost(outline, 0.3, 0.3, FRAC_PI_4) < 1e-4, "{outline:?}");
        let clarity = (0.16 - 0.09) / (0.16 + 0.09_f64);
        let got = heading_cost(outline, 0.4, 0.3, FRAC_PI_4);
        assert!((got - full * clarity * clarity).abs() < 1e-9, "{outline:?}");
    }
    let cuboid = heading_cost(Outline::Cuboid, 0.3, 0.3, FRAC_PI_4);
    assert!((cuboid - full).abs() < 1e-9, "a square has a heading");
    assert!(heading_cost(Outline::Cuboid, 0.3, 0.3, FRAC_PI_2) < 1e-12, "modulo a quarter turn");
    assert!(heading_cost(Outline::Cuboid, 0.4, 0.3, FRAC_PI_2) > 1.0);
    let between = heading_cost(Outline::Superquadric(0.5, 0.5), 0.3, 0.3, FRAC_PI_4);
    assert!((between - full * 0.25).abs() < 1e-9, "half round: {between}");
}

proptest! {
    #[test]
    fn the_truth_costs_nothing_whatever_its_axes_are_called(
        x in poses(), z in ellipsoids(), covariance in covariances::<9>(), outline in outlines(),
    ) {
        let factor = observation(z, &covariance, outline);
        for named in renamings(&z) {
            let at = [Place(x), Body(named.transformed(&x))];
            prop_assert!(cost(&factor, &at) < 1e-9, "{}", cost(&factor, &at));
        }
    }

    #[test]
    fn names_of_the_object_s_axes_do_not_matter(
        z in ellipsoids(), object in ellipsoids(), covariance in covariances::<9>(),
        outline in outlines(),
    ) {
        let factor = observation(z, &covariance, outline);
        let expected = cost_of(&factor, object);
        for named in renamings(&object) {
            prop_assert!((cost_of(&factor, named) - expected).abs() < 1e-7 * (1.0 + expected));
        }
    }

    #[test]
    fn names_of_the_measurement_s_axes_do_not_matter(
        z in upright_ellipsoids(), object in upright_ellipsoids(),
        faces in prop::array::uniform6(0.01..0.2), outline in outlines(),
    ) {
        let expected = cost_of(&observation(z, &by_faces(&z, 0.1, faces), outline), object);
        let quarter = z.quarter_turned(1);
        // The new x is the old y, the new y the old -x.
        let faces = [faces[2], faces[3], faces[1], faces[0], faces[4], faces[5]];
        let renamed = observation(quarter, &by_faces(&quarter, 0.1, faces), outline);
        prop_assert!((cost_of(&renamed, object) - expected).abs() < 1e-7 * (1.0 + expected));
    }

    #[test]
    fn where_the_map_has_its_origin_does_not_matter(
        x in poses(), z in ellipsoids(), object in ellipsoids(), motion in poses(),
        covariance in covariances::<9>(), outline in outlines(),
    ) {
        let factor = observation(z, &covariance, outline);
        let here = cost(&factor, &[Place(x), Body(object)]);
        let there = cost(&factor, &[Place(motion * x), Body(object.transformed(&motion))]);
        prop_assert!((here - there).abs() < 1e-6 * (1.0 + here));
    }

    /// Angles wrap and names change on the way.
    #[test]
    fn nothing_jumps_on_a_full_turn(
        z in upright_ellipsoids(), object in upright_ellipsoids(),
        faces in prop::array::uniform6(0.02..0.2), outline in outlines(),
    ) {
        let factor = observation(z, &by_faces(&z, 0.1, faces), outline);
        const STEPS: usize = 2000;
        let angle = TAU / STEPS as f64;
        let costs: Vec<f64> =
            (0..=STEPS).map(|i| cost_of(&factor, turned(&object, i as f64 * angle))).collect();
        // A heading sigma of 0.1 and errors of at most half a turn: a slope of at most 100 * pi.
        let steepest = 100.0 * PI * angle;
        for pair in costs.windows(2) {
            prop_assert!((pair[1] - pair[0]).abs() < steepest, "{} then {}", pair[0], pair[1]);
        }
        prop_assert!((costs[STEPS] - costs[0]).abs() < 1e-6 * (1.0 + costs[0]));
    }
}
