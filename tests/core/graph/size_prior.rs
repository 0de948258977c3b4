//! What a class says of sizes.

use super::ids;
use ellipsoid_slam::{
    geometry::{Ellipsoid, Pose},
    graph::{
        EllipsoidObservation, EllipsoidPrior, Factor, Graph, Noise, PosePrior, SizePrior, Variable,
    },
};
use nalgebra::{SMatrix, SVector, Vector3};

fn body(semi_axes: [f64; 3]) -> Ellipsoid {
    Ellipsoid::new(Pose::identity(), Vector3::from(semi_axes))
}

fn residual(usual: [f64; 3], sigmas: [f64; 2], semi_axes: [f64; 3]) -> Vec<f64> {
    let prior = SizePrior::new(ids().2, Vector3::from(usual), sigmas).unwrap();
    prior.residual(&[Variable::Ellipsoid(body(semi_axes))]).as_slice().to_vec()
}

#[test]
fn one_extent_that_is_unusual_by_its_spread_costs_one() {
    // With hardly any common spread, each extent stands for itself.
    let grown = 0.75 * 0.2f64.exp();
    let r = residual([0.75, 0.3, 0.4], [1e-6, 0.2], [grown, 0.3, 0.4]);
    assert!((r[0] - 1.0).abs() < 1e-6 && r[1].abs() < 1e-6 && r[2].abs() < 1e-6, "{r:?}");
}

#[test]
fn a_body_of_usual_proportions_may_be_larger_than_one_of_unusual_ones() {
    let cost = |semi_axes| {
        residual([0.75, 0.3, 0.4], [0.4, 0.1], semi_axes).iter().map(|r| r * r).sum::<f64>()
    };
    let larger = cost([0.9, 0.36, 0.48]);
    let longer = cost([0.9, 0.3, 0.4]);
    assert!(larger < 0.5 * longer, "{larger} for all of it, {longer} for one extent");
}

#[test]
fn the_longer_extent_is_that_of_whichever_axis_fits() {
    let along = residual([0.75, 0.3, 0.4], [0.2, 0.2], [0.8, 0.25, 0.4]);
    let across = residual([0.75, 0.3, 0.4], [0.2, 0.2], [0.25, 0.8, 0.4]);
    assert_eq!(along, across);
}

#[test]
fn where_a_class_is_nearly_square_no_axis_is_the_longer_one() {
    let at = |x: f64, y: f64| residual([0.28, 0.24, 0.45], [0.2, 0.2], [x, y, 0.45]);
    let mean = (0.28f64 * 0.24).sqrt();
    let r = at(mean, mean);
    assert!(r.iter().all(|r| r.abs() < 1e-9), "{r:?}");
}

/// The left part of a table: its left face is seen, and its front and its height are known.
#[test]
fn what_was_not_seen_of_a_table_follows_from_its_class() {
    let mut graph = Graph::default();
    let pose = graph.add_pose(Pose::identity());
    let table = graph.add_ellipsoid(body([0.5, 0.4, 0.37]));
    graph.add_factor(PosePrior::new(
        pose,
        Pose::identity(),
        Noise::from_sigmas([1e-3; 6]).unwrap(),
    ));
    graph.add_factor(EllipsoidPrior::new(
        table,
        body([0.5, 0.4, 0.37]),
        Noise::from_sigmas([0.01, 0.01, 0.01, 100.0, 100.0, 100.0, 10.0, 10.0, 10.0]).unwrap(),
    ));
    // Centre and semi-axis are half the sum and half the difference of a face known to 1 cm and one known to 2 m.
    let mut covariance = SMatrix::<f64, 9, 9>::from_diagonal(&SVector::from([1e-4; 9]));
    let (low, high) = (0.01f64.powi(2), 2.0f64.powi(2));
    covariance[(3, 3)] = 0.25 * (low + high);
    covariance[(6, 6)] = 0.25 * (low + high) / 0.5f64.powi(2);
    covariance[(3, 6)] = 0.25 * (high - low) / 0.5;
    covariance[(6, 3)] = covariance[(3, 6)];
    let measured = body([0.5, 0.4, 0.37]);
    let outline = ellipsoid_slam::geometry::Outline::Cuboid;
    graph.add_factor(
        EllipsoidObservation::new(pose, table, measured, &covariance, outline).unwrap(),
    );
    graph.add_factor(SizePrior::new(table, Vector3::new(0.75, 0.4, 0.37), [0.2, 0.2]).unwrap());
    graph.optimize(50, 1e-9).unwrap();
    let found = graph.ellipsoid(table);
    let left = found.center().x - found.semi_axes.x;
    assert!((left + 0.5).abs() < 0.02, "the face that was seen stays where it is, not at {left}");
    assert!((found.semi_axes.x - 0.75).abs() < 0.05, "{}", found.semi_axes);
}
