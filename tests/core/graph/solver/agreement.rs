//! The same answer as a dense solver's.

use super::{
    reference::distance,
    world::{Course, Drive},
};
use ellipsoid_slam::graph::VariableId;
use nalgebra::DMatrix;

#[test]
fn the_optimum_is_the_dense_one() {
    for seed in 0..3 {
        let mut drive = Course::new(seed).driven();
        let dense = drive.twin.dense();
        let optimum = dense.optimum(&drive.twin.values);
        let wanted = dense.cost(&optimum);
        drive.twin.graph.optimize(100, 1e-12).unwrap();
        let cost = drive.twin.graph.cost();
        assert!((cost / wanted - 1.0).abs() < 1e-6, "seed {seed}: {cost}, dense {wanted}");
        // A cost within 1e-12 of its minimum leaves 1e-6 sigma, and a sigma is at most 0.1.
        let away = distance(&drive.twin.estimate(), &optimum);
        assert!(away < 1e-6, "seed {seed}: {away}");
    }
}

#[test]
fn everything_at_once_gives_the_same_optimum() {
    let mut drive = Drive::new(Course::new(4));
    while drive.step() {}
    let dense = drive.twin.dense();
    let wanted = dense.cost(&dense.optimum(&drive.twin.values));
    drive.twin.graph.optimize(100, 1e-12).unwrap();
    assert!((drive.twin.graph.cost() / wanted - 1.0).abs() < 1e-6);
}

#[test]
fn updates_alone_come_within_a_thousandth() {
    for seed in 0..5 {
        let drive = Course::new(seed).driven();
        let dense = drive.twin.dense();
        let wanted = dense.cost(&dense.optimum(&drive.twin.estimate()));
        let cost = drive.twin.graph.cost();
        assert!(cost / wanted - 1.0 < 1e-3, "seed {seed}: {cost}, dense {wanted}");
    }
}

#[test]
fn the_cost_is_the_sum_over_the_factors() {
    let drive = Course::new(1).driven();
    let wanted = drive.twin.dense().cost(&drive.twin.estimate());
    assert!((drive.twin.graph.cost() / wanted - 1.0).abs() < 1e-12);
}

#[test]
fn covariances_are_blocks_of_the_inverse_of_the_information() {
    let mut drive = Course::new(2).driven();
    drive.twin.converge();
    let dense = drive.twin.dense();
    let (information, _) = dense.normal_equations(&drive.twin.estimate());
    let all = information.cholesky().unwrap().inverse();
    let (poses, bodies) = (&drive.twin.poses, &drive.twin.ellipsoids);
    let sets: &[&[VariableId]] = &[
        &[poses[0].into()],
        &[poses[13].into()],
        &[bodies[3].into()],
        &[poses[27].into(), bodies[0].into()],
        &[bodies[6].into(), poses[9].into(), poses[10].into(), bodies[1].into()],
    ];
    for set in sets {
        let rows: Vec<usize> = set
            .iter()
            .flat_map(|v| {
                let first = dense.first_row[v];
                first..first + drive.twin.values[v].dimension()
            })
            .collect();
        let wanted = DMatrix::from_fn(rows.len(), rows.len(), |i, j| all[(rows[i], rows[j])]);
        let found = drive.twin.graph.covariance(set);
        // Rounding, of matrices whose condition is about a million.
        let error = (&found - &wanted).amax() / wanted.amax();
        assert!(error < 1e-8, "{set:?}: {error}");
    }
}

#[test]
fn the_same_operations_give_the_same_bits() {
    let (one, other) = (Course::new(3).driven(), Course::new(3).driven());
    assert_eq!(one.twin.estimate(), other.twin.estimate());
    assert_eq!(one.twin.graph.cost().to_bits(), other.twin.graph.cost().to_bits());
}
