//! A measurement of which each face counts by itself.

use super::{assert_linearization, ids, outlines};
use crate::geometry::{ellipsoids, poses};
use ellipsoid_slam::{
    geometry::{Ellipsoid, FaceEvidence, Outline, Pose, Reach},
    graph::{
        EllipsoidId, EllipsoidObservation, EllipsoidPrior, Factor, Graph, Kernel, Noise,
        NoiseError, PoseId, PosePrior,
        Variable::{Ellipsoid as Body, Pose as Place},
    },
};
use nalgebra::{SVector, Vector3};
use proptest::{array::uniform9, prelude::*};

const ROTATION: [f64; 3] = [0.02, 0.02, 0.05];

fn at(position_m: f64, sigma_m: f64) -> FaceEvidence {
    FaceEvidence::At(Reach { position_m, sigma_m })
}

fn between(at_least_m: f64, at_most_m: Option<f64>, sigma_m: f64) -> FaceEvidence {
    FaceEvidence::Between {
        at_least: Reach { position_m: at_least_m, sigma_m },
        at_most: at_most_m.map(|position_m| Reach { position_m, sigma_m }),
    }
}

fn table() -> Ellipsoid {
    Ellipsoid::new(Pose::translation(2.0, 0.0, 0.4), Vector3::new(0.7, 0.4, 0.4))
}

fn all_seen(e: &Ellipsoid, sigma_m: f64) -> [FaceEvidence; 6] {
    std::array::from_fn(|face| at(e.semi_axes[face / 2], sigma_m))
}

fn observation(measured: Ellipsoid, faces: [FaceEvidence; 6]) -> EllipsoidObservation {
    let (pose, _, object) = ids();
    EllipsoidObservation::of_faces(pose, object, measured, (ROTATION, faces), Outline::Cuboid)
        .unwrap()
}

fn residual(factor: &EllipsoidObservation, object: Ellipsoid) -> Vec<f64> {
    factor.residual(&[Place(Pose::identity()), Body(object)]).as_slice().to_vec()
}

/// A body 6 cm longer, moved by 1 cm along x: its low face is 2 cm farther out, its high face 4 cm.
#[test]
fn each_face_by_hand() {
    let factor = observation(table(), all_seen(&table(), 0.01));
    let longer = Ellipsoid::new(Pose::translation(2.01, 0.0, 0.4), Vector3::new(0.73, 0.4, 0.4));
    let expected = [0.0, 0.0, 0.0, 2.0, 4.0, 0.0, 0.0, 0.0, 0.0];
    for (got, expected) in residual(&factor, longer).iter().zip(expected) {
        assert!((got - expected).abs() < 1e-9, "{got} instead of {expected}");
    }
}

#[test]
fn a_face_that_was_not_seen_costs_nothing_within_its_bounds() {
    let mut faces = all_seen(&table(), 0.01);
    faces[1] = between(0.5, Some(1.0), 0.02);
    let factor = observation(table(), faces);
    // The low face stays at -0.7 from the measured centre.
    let with_high_face_at = |high_m: f64| {
        let semi = 0.5 * (high_m + 0.7);
        let center = Pose::translation(2.0 + high_m - semi, 0.0, 0.4);
        let r = residual(&factor, Ellipsoid::new(center, Vector3::new(semi, 0.4, 0.4)));
        assert!(r[3].abs() < 1e-9, "{r:?}");
        r[4]
    };
    for within_m in [0.51, 0.7, 0.99] {
        assert_eq!(with_high_face_at(within_m), 0.0);
    }
    assert!((with_high_face_at(0.44) + 3.0).abs() < 1e-9, "it reaches farther than that");
    assert!((with_high_face_at(1.04) - 2.0).abs() < 1e-9, "there is a wall");
}

/// A graph in which the pose is known and the object is not.
fn graph_of(object: Ellipsoid) -> (Graph, PoseId, EllipsoidId) {
    let mut graph = Graph::default();
    let pose = graph.add_pose(Pose::identity());
    let body = graph.add_ellipsoid(object);
    let noise = Noise::from_sigmas([1e-4; 6]).unwrap();
    graph.add_factor(PosePrior::new(pose, Pose::identity(), noise));
    let noise = Noise::from_sigmas([10.0; 9]).unwrap();
    graph.add_factor(EllipsoidPrior::new(body, object, noise));
    (graph, pose, body)
}

fn estimated(views: &[[FaceEvidence; 6]], kernel: Kernel) -> Ellipsoid {
    let (mut graph, pose, body) = graph_of(table());
    for faces in views {
        let seen = (ROTATION, *faces);
        let factor =
            EllipsoidObservation::of_faces(pose, body, table(), seen, Outline::Cuboid).unwrap();
        graph.add_factor(factor.with_kernel(kernel));
    }
    graph.optimize(50, 1e-12).unwrap();
    graph.ellipsoid(body)
}

/// One end was seen past the left chair, the other past the right one. The middle of what each view saw is elsewhere, and
/// neither knows how long the table is.
#[test]
fn parts_of_a_table_add_up() {
    let mut left = all_seen(&table(), 0.01);
    (left[0], left[1]) = (at(0.9, 0.01), between(0.1, None, 0.01));
    let mut right = all_seen(&table(), 0.01);
    (right[0], right[1]) = (between(0.2, None, 0.01), at(0.8, 0.01));
    let found = estimated(&[left, right], Kernel::Quadratic);
    let (low, high) = (0.9 - (2.0 - found.center().x), 0.8 + (2.0 - found.center().x));
    assert!((found.semi_axes.x - 0.85).abs() < 0.005, "{}", found.semi_axes);
    assert!((low - 0.85).abs() < 0.005 && (high - 0.85).abs() < 0.005, "{}", found.center());
}

/// One view takes the wall behind for a part of the table. The other faces of that view stay as good as they were.
#[test]
fn a_wrong_face_takes_no_weight_from_the_others() {
    let truth = all_seen(&table(), 0.01);
    let mut wrong = truth;
    wrong[3] = at(0.9, 0.01);
    // Only the wrong view knows the height well.
    wrong[5] = at(0.45, 0.01);
    let mut vague = truth;
    vague[5] = at(0.4, 0.1);
    let found = estimated(&[vague, vague, wrong], Kernel::Cauchy(3.0));
    assert!((found.semi_axes.y - 0.4).abs() < 0.01, "width {}", found.semi_axes.y);
    let top = found.center().z + found.semi_axes.z - 0.4;
    assert!((top - 0.45).abs() < 0.005, "the top is at {top}");
}

#[test]
fn a_share_counts_outside_the_kernels() {
    let kernel = Kernel::Cauchy(3.0);
    let factor = observation(table(), all_seen(&table(), 0.01)).with_kernel(kernel);
    let off = Ellipsoid::new(Pose::translation(2.2, 0.0, 0.4), table().semi_axes);
    let cost = |f: &EllipsoidObservation| residual(f, off).iter().map(|r| r * r).sum::<f64>() / 2.0;
    // Two faces that are 20 standard deviations off.
    assert!((cost(&factor) - 2.0 * kernel.cost(400.0)).abs() < 1e-9, "{}", cost(&factor));
    let half = factor.scaled(0.5).unwrap();
    assert!((cost(&half) - kernel.cost(400.0)).abs() < 1e-9, "{}", cost(&half));
}

#[test]
fn what_is_no_evidence_is_refused() {
    let (pose, _, object) = ids();
    let of = |rotation: [f64; 3], faces| {
        let seen = (rotation, faces);
        EllipsoidObservation::of_faces(pose, object, table(), seen, Outline::Cuboid)
    };
    let good = all_seen(&table(), 0.01);
    for bad in [at(f64::NAN, 0.01), at(0.3, 0.0), between(0.3, Some(0.5), -1.0)] {
        let mut faces = good;
        faces[4] = bad;
        assert!(matches!(of(ROTATION, faces), Err(NoiseError::Sigma { index: 7, .. })));
    }
    assert!(matches!(of([0.1, f64::NAN, 0.1], good), Err(NoiseError::Sigma { index: 1, .. })));
}

fn evidence() -> impl Strategy<Value = FaceEvidence> {
    let sigma = 0.005..0.1;
    prop_oneof![
        (0.0..0.6, sigma.clone()).prop_map(|(p, sigma)| at(p, sigma)),
        (0.0..0.3, prop::option::of(0.3..0.6), sigma)
            .prop_map(|(least, most, sigma)| between(least, most, sigma)),
    ]
}

proptest! {
    #[test]
    fn derivatives(
        x in poses(), measured in ellipsoids(), e in uniform9(-0.3..0.3), quarters in 0_i64..4,
        faces in prop::array::uniform6(evidence()), outline in outlines(), robust in any::<bool>(),
    ) {
        let (pose, _, object) = ids();
        let seen = (ROTATION, faces);
        let factor =
            EllipsoidObservation::of_faces(pose, object, measured, seen, outline).unwrap();
        let kernel = if robust { Kernel::Cauchy(3.0) } else { Kernel::Quadratic };
        let factor = factor.with_kernel(kernel).scaled(0.3).unwrap();
        let named = measured.retract(&SVector::from(e)).quarter_turned(quarters);
        assert_linearization(&factor, &[Place(x), Body(named.transformed(&x))]);
    }
}
