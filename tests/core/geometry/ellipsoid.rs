use super::{ROUNDING, directions, ellipsoids, pose_distance, poses, upright_ellipsoids};
use ellipsoid_slam::geometry::{Ellipsoid, Outline, Pose, yaw_of};
use nalgebra::{Point3, SVector, Vector3};
use proptest::{array::uniform9, prelude::*};
use std::f64::consts::FRAC_PI_4;

fn tangents() -> impl Strategy<Value = SVector<f64, 9>> {
    uniform9(-0.9..0.9).prop_map(SVector::<f64, 9>::from)
}

#[test]
fn a_step_reads_rotation_translation_log_axes() {
    let e = Ellipsoid::new(Pose::identity(), Vector3::new(1.0, 2.0, 3.0));
    let mut delta = SVector::<f64, 9>::zeros();
    (delta[2], delta[4], delta[7]) = (0.3, 0.5, 2.0_f64.ln());
    let moved = e.retract(&delta);
    assert!((yaw_of(&moved.pose) - 0.3).abs() < ROUNDING);
    assert!((moved.semi_axes - Vector3::new(1.0, 4.0, 3.0)).norm() < ROUNDING);
    assert!(moved.center().y > 0.49 && moved.center().x < 0.0, "ahead on an arc to the left");
}

#[test]
fn outlines_by_hand() {
    let p = Vector3::new(0.6, 0.8, 0.5);
    for (outline, expected) in [
        (Outline::Ellipsoid, 1.25_f64.sqrt()),
        (Outline::Cuboid, 0.8),
        (Outline::Cylinder, 1.0),
        (Outline::Superquadric(1.0, 1.0), 1.25_f64.sqrt()),
    ] {
        assert!((outline.radius(&p) - expected).abs() < ROUNDING, "{outline:?}");
    }
}

proptest! {
    #[test]
    fn local_takes_back_retract(e in ellipsoids(), delta in tangents()) {
        let moved = e.retract(&delta);
        prop_assert!((e.local(&moved) - delta).norm() < 1e-8);
        prop_assert!(moved.semi_axes.min() > 0.0);
    }

    #[test]
    fn retract_takes_back_local(a in ellipsoids(), b in ellipsoids()) {
        let back = a.retract(&a.local(&b));
        prop_assert!(pose_distance(&back.pose, &b.pose) < 1e-6);
        prop_assert!((back.semi_axes - b.semi_axes).norm() < ROUNDING);
        prop_assert!(a.local(&a).norm() < ROUNDING);
    }

    #[test]
    fn steps_are_taken_in_its_own_frame(e in ellipsoids(), a_from_b in poses(), delta in tangents()) {
        let there = e.transformed(&a_from_b).retract(&delta);
        let here = e.retract(&delta).transformed(&a_from_b);
        prop_assert!(pose_distance(&there.pose, &here.pose) < 1e-8);
    }

    #[test]
    fn moving_goes_step_by_step(e in ellipsoids(), a_from_b in poses(), b_from_c in poses()) {
        let stepwise = e.transformed(&b_from_c).transformed(&a_from_b);
        let at_once = e.transformed(&(a_from_b * b_from_c));
        prop_assert!(pose_distance(&stepwise.pose, &at_once.pose) < 1e-7);
    }

    /// Liao et al. 2020, eq. (6): minus one at the centre, zero on the surface.
    #[test]
    fn the_algebraic_distance_vanishes_on_the_surface(e in ellipsoids(), direction in directions(), out in 0.0..3.0) {
        let at = |radius: f64| {
            e.pose * Point3::from(direction.into_inner().component_mul(&e.semi_axes) * radius)
        };
        prop_assert!((e.algebraic_distance(&e.center()) + 1.0).abs() < ROUNDING);
        prop_assert!(e.algebraic_distance(&at(1.0)).abs() < 1e-8);
        prop_assert!((e.algebraic_distance(&at(out)) - (out * out - 1.0)).abs() < 1e-7);
    }

    #[test]
    fn outlines_grow_along_rays_and_fill_the_same_extents(direction in directions(), size in 0.1..3.0_f64) {
        let d = direction.into_inner();
        for outline in [
            Outline::Ellipsoid, Outline::Cuboid, Outline::Cylinder, Outline::Superquadric(0.3, 0.7),
        ] {
            let radius = outline.radius(&d);
            prop_assert!((outline.radius(&(d * size)) - size * radius).abs() < 1e-8);
            prop_assert!(radius <= Outline::Ellipsoid.radius(&d) + ROUNDING, "inside the ellipsoid");
            prop_assert!(radius >= Outline::Cuboid.radius(&d) - ROUNDING, "outside the cuboid");
            for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
                prop_assert!((outline.radius(&axis) - 1.0).abs() < ROUNDING);
            }
        }
    }

    #[test]
    fn the_nearest_name_is_within_45_degrees(e in upright_ellipsoids(), reference in -3.1..3.1) {
        let renamed = e.relabelled_towards(reference);
        let off = (yaw_of(&renamed.pose) - reference).sin().atan2((yaw_of(&renamed.pose) - reference).cos());
        prop_assert!(off.abs() <= FRAC_PI_4 + ROUNDING);
        prop_assert!((renamed.dual_quadric() - e.dual_quadric()).norm() < 1e-8);
    }
}
