//! Support planes and uprightness.

use super::{cost, ids, outlines};
use crate::geometry::{pose_distance, upright_ellipsoids, upright_pose};
use ellipsoid_slam::{
    geometry::{Ellipsoid, Outline, Plane, Pose, exp},
    graph::{
        Factor, SupportContact, Upright,
        Variable::{Ellipsoid as Body, Pose as Place},
    },
};
use nalgebra::{Point3, UnitQuaternion, Vector3, Vector6};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_4, PI};

fn floor_at(height: f64) -> Plane {
    Plane::through(&Point3::new(3.0, -2.0, height), Vector3::z_axis())
}

fn contact(outline: Outline, plane: Plane) -> SupportContact {
    SupportContact::new(ids().2, outline, plane, 0.01).unwrap()
}

#[test]
fn hovering_is_a_positive_error() {
    let body =
        Ellipsoid::new(upright_pose(0.4, Vector3::new(1.0, 1.0, 1.5)), Vector3::new(0.3, 0.2, 0.4));
    for outline in [Outline::Cuboid, Outline::Cylinder, Outline::Ellipsoid] {
        let got = contact(outline, floor_at(1.08)).residual(&[Body(body)]);
        assert!((got[0] - 2.0).abs() < 1e-9, "{outline:?}: {got}");
    }
}

#[test]
fn a_cuboid_stands_on_its_edge_when_it_is_tilted() {
    let tilt = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), FRAC_PI_4);
    let pose = Pose::from_parts(Vector3::new(0.0, 0.0, 1.0).into(), tilt);
    let body = Ellipsoid::new(pose, Vector3::new(0.5, 0.2, 0.4));
    // Half of its diagonal across the edge goes down: (0.2 + 0.4) / sqrt(2).
    let lowest = 1.0 - 0.6 / 2.0_f64.sqrt();
    let got = contact(Outline::Cuboid, floor_at(0.0)).residual(&[Body(body)]);
    assert!((got[0] - lowest / 0.01).abs() < 1e-9, "{got}");
    // The ellipsoid's shadow is smaller.
    let lowest = 1.0 - (0.5_f64 * (0.2 * 0.2 + 0.4 * 0.4)).sqrt();
    let got = contact(Outline::Ellipsoid, floor_at(0.0)).residual(&[Body(body)]);
    assert!((got[0] - lowest / 0.01).abs() < 1e-9, "{got}");
}

/// A face lies on the plane: tilting it a little either way lowers a corner, so neither way is downhill.
#[test]
fn standing_on_a_face_has_no_preferred_tilt() {
    let body = Ellipsoid::new(upright_pose(0.7, Vector3::zeros()), Vector3::new(0.5, 0.2, 0.4));
    for outline in [Outline::Cuboid, Outline::Cylinder] {
        let jacobian = contact(outline, floor_at(0.0)).linearize(&[Body(body)]).jacobian;
        let expected = [0.0, 0.0, 0.0, 0.0, 0.0, 100.0, 0.0, 0.0, -40.0];
        for (got, expected) in jacobian.iter().zip(expected) {
            assert!((got - expected).abs() < 1e-6, "{outline:?}: {jacobian}");
        }
    }
}

#[test]
fn tilt_is_measured_by_its_sine() {
    let factor = Upright::new(ids().0, 0.02).unwrap();
    // Leaning forward: the top goes to +x.
    let leaning = exp(&Vector6::new(0.0, 0.1, 0.0, 0.0, 0.0, 0.0));
    let got = factor.residual(&[Place(leaning)]);
    assert!((got[0] - 0.1_f64.sin() / 0.02).abs() < 1e-9 && got[1].abs() < 1e-9, "{got}");
    let on_its_head = exp(&Vector6::new(PI, 0.0, 0.0, 0.0, 0.0, 0.0));
    assert!(factor.residual(&[Place(on_its_head)]).norm() < 1e-9);
    assert!(Upright::new(ids().0, 0.0).is_err());
}

proptest! {
    #[test]
    fn what_stands_upright_costs_nothing(body in upright_ellipsoids(), outline in outlines()) {
        let plane = floor_at(body.center().z - body.semi_axes.z);
        prop_assert!(cost(&contact(outline, plane), &[Body(body)]) < 1e-9);
        prop_assert!(cost(&Upright::new(ids().2, 0.01).unwrap(), &[Body(body)]) < 1e-9);
    }

    /// Gauss-Newton on the tilt alone: the derivative does not vanish or jump on the way to upright.
    #[test]
    fn uprightness_is_reached_from_afar(roll in -0.8..0.8, pitch in -0.8..0.8) {
        let factor = Upright::new(ids().0, 0.01).unwrap();
        let start = Pose::from_parts(
            Vector3::new(1.0, 2.0, 3.0).into(),
            UnitQuaternion::from_euler_angles(roll, pitch, 0.3),
        );
        let mut at = Place(start);
        for _ in 0..8 {
            let linear = factor.linearize(&[at]);
            let step = linear.jacobian.svd(true, true).solve(&-linear.residual, 1e-9).unwrap();
            at = at.retract(step.as_slice());
        }
        prop_assert!(cost(&factor, &[at]) < 1e-12);
        prop_assert!(pose_distance(at.pose(), &start) < 1.5, "it only turns");
    }
}
