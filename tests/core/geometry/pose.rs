use super::{ROUNDING, pose_distance, poses, vectors};
use ellipsoid_slam::geometry::{
    Pose, adjoint, exp, interpolate, local, log, log_derivative, retract, rotation_log_derivative,
    skew, yaw_of,
};
use nalgebra::{Matrix3, Matrix4, Matrix6, Point3, Vector3, Vector6};
use proptest::prelude::*;
use std::f64::consts::FRAC_PI_2;

fn twists() -> impl Strategy<Value = Vector6<f64>> {
    // Also angles around the switch to the Taylor series, and none at all.
    let sizes = prop_oneof![Just(0.0), Just(1e-7), Just(0.99e-4), Just(1.01e-4), 0.0..1.0];
    (vectors(1.0), sizes, vectors(3.0)).prop_map(|(axis, size, shift)| {
        let phi = axis * (size * 1.7);
        Vector6::new(phi.x, phi.y, phi.z, shift.x, shift.y, shift.z)
    })
}

/// The exponential as the sum of its series.
fn exp_by_series(twist: &Vector6<f64>) -> Matrix4<f64> {
    let mut generator = Matrix4::zeros();
    let phi = Vector3::new(twist[0], twist[1], twist[2]);
    generator.fixed_view_mut::<3, 3>(0, 0).copy_from(&skew(phi));
    generator.fixed_view_mut::<3, 1>(0, 3).copy_from(&twist.fixed_rows::<3>(3));
    let (mut sum, mut term) = (Matrix4::identity(), Matrix4::identity());
    for n in 1..60 {
        term = term * generator / f64::from(n);
        sum += term;
    }
    sum
}

#[test]
fn a_quarter_turn_left_while_driving_ahead_ends_ahead_and_left() {
    let arc = exp(&Vector6::new(0.0, 0.0, FRAC_PI_2, FRAC_PI_2, 0.0, 0.0));
    // A circle of radius 1 m about (0, 1).
    assert!((arc.translation.vector - Vector3::new(1.0, 1.0, 0.0)).norm() < ROUNDING);
    assert!((yaw_of(&arc) - FRAC_PI_2).abs() < ROUNDING);
}

#[test]
fn the_name_says_which_way_a_pose_goes() {
    // The base stands at (2, 0) and looks to the left; a thing is 1 m ahead of it.
    let mut odom_from_base = exp(&Vector6::new(0.0, 0.0, FRAC_PI_2, 0.0, 0.0, 0.0));
    odom_from_base.translation.x = 2.0;
    let thing = odom_from_base * Point3::new(1.0, 0.0, 0.0);
    assert!((thing - Point3::new(2.0, 1.0, 0.0)).norm() < ROUNDING);
}

/// With the translation of a quarter circle: `log` changes by the turn and by what it bends.
#[test]
fn small_twists_hardly_bend_the_derivative() {
    let twist = Vector6::new(0.0, 0.0, 0.2, 1.0, 0.0, 0.0);
    let derivative = log_derivative(&twist);
    // To first order 1 + ad(twist) / 2.
    let mut expected = Matrix6::identity();
    for (row, column, block) in [
        (0, 0, skew(Vector3::z() * 0.2)),
        (3, 3, skew(Vector3::z() * 0.2)),
        (3, 0, skew(Vector3::x())),
    ] {
        let mut view = expected.fixed_view_mut::<3, 3>(row, column);
        view += Matrix3::from(block) * 0.5;
    }
    // The second order is ad^2 / 12, at most 0.2 / 6 here.
    assert!((derivative - expected).amax() < 0.04, "{derivative}");
}

proptest! {
    #[test]
    fn exp_is_the_sum_of_its_series(twist in twists()) {
        let difference = exp(&twist).to_homogeneous() - exp_by_series(&twist);
        prop_assert!(difference.norm() < ROUNDING, "{difference}");
    }

    #[test]
    fn log_takes_back_exp(twist in twists()) {
        prop_assert!((log(&exp(&twist)) - twist).norm() < ROUNDING);
    }

    #[test]
    fn exp_takes_back_log(pose in poses()) {
        prop_assert!(pose_distance(&exp(&log(&pose)), &pose) < 1e-7);
    }

    #[test]
    fn local_takes_back_retract(pose in poses(), twist in twists()) {
        prop_assert!((local(&pose, &retract(&pose, &twist)) - twist).norm() < 1e-8);
    }

    #[test]
    fn retract_takes_back_local(from in poses(), to in poses()) {
        prop_assert!(pose_distance(&retract(&from, &local(&from, &to)), &to) < 1e-6);
    }

    #[test]
    fn retract_perturbs_on_the_right(world_from_a in poses(), a_from_b in poses(), twist in twists()) {
        let after = retract(&(world_from_a * a_from_b), &twist);
        prop_assert!(pose_distance(&after, &(world_from_a * retract(&a_from_b, &twist))) < 1e-8);
    }

    #[test]
    fn poses_compose_and_invert(a_from_b in poses(), b_from_c in poses(), shift in vectors(5.0)) {
        let point_in_c = Point3::from(shift);
        let stepwise = a_from_b * (b_from_c * point_in_c);
        prop_assert!((a_from_b * b_from_c * point_in_c - stepwise).norm() < ROUNDING);
        let back = (a_from_b * b_from_c).inverse() * stepwise;
        prop_assert!((back - point_in_c).norm() < ROUNDING);
    }

    #[test]
    fn interpolation_starts_and_ends_where_it_should(from in poses(), to in poses(), share in 0.0..1.0) {
        prop_assert!(pose_distance(&interpolate(&from, &to, 0.0), &from) < 1e-6);
        prop_assert!(pose_distance(&interpolate(&from, &to, 1.0), &to) < 1e-6);
        let there = interpolate(&from, &to, share);
        let back = interpolate(&to, &from, 1.0 - share);
        prop_assert!(pose_distance(&there, &back) < 1e-6);
    }

    #[test]
    fn the_adjoint_takes_twists_to_another_frame(a_from_b in poses(), twist in twists()) {
        let there = exp(&(adjoint(&a_from_b) * twist));
        prop_assert!(pose_distance(&(a_from_b * exp(&twist)), &(there * a_from_b)) < 1e-7);
    }

    #[test]
    fn the_adjoint_of_the_inverse_is_the_inverse(a_from_b in poses()) {
        let back = adjoint(&a_from_b) * adjoint(&a_from_b.inverse());
        prop_assert!((back - Matrix6::identity()).norm() < ROUNDING);
    }

    #[test]
    fn the_derivative_of_log_is_that_of_differences(twist in twists(), turned in poses()) {
        // Angles up to nearly half a turn as well as those around the series.
        for twist in [twist, log(&turned)] {
            let pose = exp(&twist);
            const STEP: f64 = 1e-6;
            let numeric = Matrix6::from_fn(|row, column| {
                let delta = Vector6::ith(column, STEP);
                (log(&retract(&pose, &delta))[row] - log(&retract(&pose, &-delta))[row])
                    / (2.0 * STEP)
            });
            let derivative = log_derivative(&twist);
            // Near half a turn the logarithm's second derivatives grow.
            prop_assert!((derivative - numeric).norm() < 1e-6 * (1.0 + numeric.norm()), "{derivative}{numeric}");
            let rotation = rotation_log_derivative(twist.fixed_rows::<3>(0).into_owned());
            prop_assert_eq!(rotation, derivative.fixed_view::<3, 3>(0, 0).into_owned());
        }
    }

    /// Numeric differences are too coarse to see digits get lost at small angles.
    #[test]
    fn the_derivative_of_log_is_the_sum_of_its_series(
        axis in super::directions(), angle in 0.0..0.06, shift in vectors(3.0),
    ) {
        let phi: Vector3<f64> = axis.into_inner() * angle;
        let twist = Vector6::new(phi.x, phi.y, phi.z, shift.x, shift.y, shift.z);
        let mut ad = Matrix6::zeros();
        for (row, column, block) in [(0, 0, skew(phi)), (3, 3, skew(phi)), (3, 0, skew(shift))] {
            ad.fixed_view_mut::<3, 3>(row, column).copy_from(&block);
        }
        let square = ad * ad;
        // Bernoulli numbers over factorials; the next term is below 1e-14.
        let sum = Matrix6::identity() + ad / 2.0 + square / 12.0 - square * square / 720.0
            + square * square * square / 30_240.0;
        prop_assert!((log_derivative(&twist) - sum).norm() < 3e-12);
    }

    #[test]
    fn a_twist_does_not_change_the_derivative_along_itself(twist in twists(), size in 0.0..0.2) {
        for twist in [twist, twist * size] {
            let along = log_derivative(&twist) * twist;
            prop_assert!((along - twist).norm() < 1e-12 * (1.0 + twist.norm()), "{}", along - twist);
        }
    }

    #[test]
    fn skew_is_the_cross_product(a in vectors(3.0), b in vectors(3.0)) {
        prop_assert!((skew(a) * b - a.cross(&b)).norm() < ROUNDING);
    }

    #[test]
    fn yaw_is_read_back(yaw in -3.1..3.1, shift in vectors(3.0)) {
        let pose: Pose = super::upright_pose(yaw, shift);
        prop_assert!((yaw_of(&pose) - yaw).abs() < ROUNDING);
    }
}
