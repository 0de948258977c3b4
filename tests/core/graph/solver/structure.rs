//! Graphs of unusual shapes.

use ellipsoid_slam::{
    geometry::Pose,
    graph::{Graph, Noise, PoseId, PosePrior, RelativePose, SolverSettings},
};
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use std::f64::consts::TAU;

const CHAIN: usize = 10_000;

fn noise() -> Noise<6> {
    Noise::from_sigmas([0.001, 0.001, 0.001, 0.01, 0.01, 0.01]).unwrap()
}

/// A step along a ring of [`CHAIN`] steps, that is measured 0.1 % too long.
fn step() -> Pose {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), TAU / CHAIN as f64);
    Pose::from_parts(Translation3::new(0.1 * 1.001, 0.0, 0.0), turn)
}

fn chain(mut after_each: impl FnMut(&mut Graph)) -> (Graph, Vec<PoseId>) {
    let mut graph = Graph::new(SolverSettings::default());
    let first = graph.add_pose(Pose::identity());
    graph.add_factor(PosePrior::new(first, Pose::identity(), noise()));
    let (mut ids, mut at) = (vec![first], Pose::identity());
    for i in 1..CHAIN {
        at *= step();
        ids.push(graph.add_pose(at));
        graph.add_factor(RelativePose::new(ids[i - 1], ids[i], &step(), noise()));
        after_each(&mut graph);
    }
    (graph, ids)
}

fn assert_closes(graph: &mut Graph, ids: &[PoseId]) {
    // The end is said to be 5 m aside of where it is.
    let (first, last) = (ids[0], ids[CHAIN - 1]);
    let aside = graph.pose(last) * Pose::translation(0.0, 5.0, 0.0);
    let measured = graph.pose(first).inv_mul(&aside);
    graph.add_factor(RelativePose::new(first, last, &measured, noise()));
    let before = graph.cost();
    for _ in 0..5 {
        graph.update().unwrap();
    }
    let cost = graph.cost();
    assert!(cost < 0.01 * before, "{before}, then {cost}");
    graph.optimize(20, 1e-9).unwrap();
    assert!(cost < 1.001 * graph.cost() + 0.01, "{cost}, batch {}", graph.cost());
    assert_eq!(graph.covariance(&[ids[CHAIN / 2].into()]).shape(), (6, 6));
}

#[test]
fn a_long_chain_that_was_driven_closes_its_loop() {
    let (mut graph, ids) = chain(|graph| {
        let report = graph.update().unwrap();
        assert!(report.eliminated <= 4, "{report:?}");
    });
    assert_closes(&mut graph, &ids);
}

#[test]
fn a_long_chain_that_was_loaded_closes_its_loop() {
    let (mut graph, ids) = chain(|_| ());
    graph.update().unwrap();
    assert_closes(&mut graph, &ids);
}

#[test]
fn two_unconnected_parts_do_not_know_of_each_other() {
    let part = |graph: &mut Graph, y: f64| -> [PoseId; 2] {
        let at = Pose::translation(0.0, y, 0.0);
        let ids = [graph.add_pose(at), graph.add_pose(at)];
        graph.add_factor(PosePrior::new(ids[0], at, noise()));
        graph.add_factor(RelativePose::new(ids[0], ids[1], &step(), noise()));
        graph.update().unwrap();
        ids
    };
    let mut graph = Graph::new(SolverSettings::default());
    let one = part(&mut graph, 0.0);
    let before = graph.covariance(&[one[1].into()]);
    let other = part(&mut graph, 3.0);
    assert_eq!(graph.covariance(&[one[1].into()]), before);
    let joint = graph.covariance(&[one[1].into(), other[1].into()]);
    assert_eq!(joint.view((0, 6), (6, 6)).amax(), 0.0);
    assert!((graph.pose(other[1]).translation.vector.y - 3.0).abs() < 1e-9);

    // And become one when something ties them.
    let between = graph.pose(one[1]).inv_mul(&graph.pose(other[1]));
    graph.add_factor(RelativePose::new(one[1], other[1], &between, noise()));
    graph.update().unwrap();
    let joint = graph.covariance(&[one[1].into(), other[1].into()]);
    assert!(joint.view((0, 6), (6, 6)).amax() > 1e-6);
}
