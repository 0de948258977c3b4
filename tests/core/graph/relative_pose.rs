use super::{cost, ids};
use crate::geometry::{ellipsoids, poses};
use ellipsoid_slam::{
    geometry::{Pose, pose_from_xyzw},
    graph::{
        EllipsoidPrior, Factor, Noise, PosePrior, RelativePose,
        Variable::{Ellipsoid as Body, Pose as Place},
    },
};
use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;

/// `BetweenFactorPose3` of GTSAM 4.3 with `Diagonal.Sigmas` and rotations `Rot3.RzRyRx`.
#[test]
fn the_cost_is_that_of_gtsam() {
    let pose = |roll, pitch, yaw, x, y, z| {
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        Pose::from_parts(Vector3::new(x, y, z).into(), rotation)
    };
    let i = pose(0.1, -0.2, 0.3, 1.0, 2.0, 3.0);
    let j = pose(-0.3, 0.4, 1.1, 2.0, 1.5, 3.5);
    let measured = pose(0.2, 0.1, 0.5, 0.5, -0.7, 0.9);
    let q = [0.06407134770607115, -0.09115754934299071, 0.15343930202422257, 0.981856172866081];
    let same = pose_from_xyzw([1.0, 2.0, 3.0], q).unwrap();
    assert!(i.rotation.angle_to(&same.rotation) < 1e-12, "the same angles");

    let noise = Noise::from_sigmas([0.01, 0.02, 0.03, 0.1, 0.2, 0.3]).unwrap();
    let factor = RelativePose::new(ids().0, ids().1, &measured, noise);
    let at = [Place(i), Place(j)];
    assert!((cost(&factor, &at) - 1724.582425904537).abs() < 1e-9);
    let linear = factor.linearize(&at);
    assert!((linear.jacobian[(0, 0)] - -73.51227081359394).abs() < 1e-10);
    assert!((linear.jacobian[(3, 1)] - -6.874199904294662).abs() < 1e-10);
    assert!((linear.jacobian[(4, 6)] - -0.8055530752521842).abs() < 1e-10);
}

#[test]
fn driving_too_far_is_a_positive_error() {
    let noise = Noise::from_sigmas([0.1, 0.1, 0.1, 0.5, 0.5, 0.5]).unwrap();
    let measured = Pose::translation(1.0, 0.0, 0.0);
    let factor = RelativePose::new(ids().0, ids().1, &measured, noise);
    let at = [Place(Pose::identity()), Place(Pose::translation(2.0, 0.0, 0.0))];
    assert_eq!(factor.residual(&at).as_slice(), [0.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
}

proptest! {
    #[test]
    fn the_truth_costs_nothing(i in poses(), step in poses(), body in ellipsoids()) {
        let noise = Noise::from_sigmas([0.1; 6]).unwrap();
        let factor = RelativePose::new(ids().0, ids().1, &step, noise);
        prop_assert!(cost(&factor, &[Place(i), Place(i * step)]) < 1e-12);
        prop_assert!(cost(&PosePrior::new(ids().0, i, noise), &[Place(i)]) < 1e-12);
        let noise = Noise::from_sigmas([0.1; 9]).unwrap();
        prop_assert!(cost(&EllipsoidPrior::new(ids().2, body, noise), &[Body(body)]) < 1e-12);
    }

    #[test]
    fn where_the_map_has_its_origin_does_not_matter(
        i in poses(), j in poses(), step in poses(), motion in poses(),
    ) {
        let noise = Noise::from_sigmas([0.1, 0.2, 0.3, 0.4, 0.5, 0.6]).unwrap();
        let factor = RelativePose::new(ids().0, ids().1, &step, noise);
        let here = cost(&factor, &[Place(i), Place(j)]);
        let there = cost(&factor, &[Place(motion * i), Place(motion * j)]);
        prop_assert!((here - there).abs() < 1e-6 * (1.0 + here));
    }
}
