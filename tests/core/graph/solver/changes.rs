//! Removal, and what cannot be solved.

use super::{
    reference::{Twin, distance},
    world::{Course, Drive},
};
use ellipsoid_slam::{
    geometry::Pose,
    graph::{Graph, Noise, PoseId, PosePrior, RelativePose, SolverSettings, VariableId},
};
use nalgebra::Vector3;

fn step() -> Pose {
    Pose::new(Vector3::new(0.3, 0.1, 0.0), Vector3::new(0.0, 0.0, 0.2))
}

fn noise() -> Noise<6> {
    Noise::from_sigmas([0.01, 0.01, 0.02, 0.03, 0.03, 0.03]).unwrap()
}

fn tie(from: PoseId, to: PoseId) -> RelativePose {
    RelativePose::new(from, to, &step(), noise())
}

/// The dense optimum of what is left.
fn assert_optimal(drive: &mut Drive) {
    drive.twin.graph.update().unwrap();
    drive.twin.converge();
    let dense = drive.twin.dense();
    let wanted = dense.optimum(&drive.twin.estimate());
    let cost = drive.twin.graph.cost();
    assert!((cost / dense.cost(&wanted) - 1.0).abs() < 1e-9, "{cost}");
    let away = distance(&drive.twin.estimate(), &wanted);
    assert!(away < 1e-7, "{away}");
}

#[test]
fn removed_factors_leave_no_trace() {
    let mut drive = Course::new(5).driven();
    let with = drive.twin.graph.cost();
    assert!(!drive.outliers.is_empty());
    for outlier in drive.outliers.clone() {
        drive.twin.remove_factor(outlier);
        drive.twin.graph.remove_factor(outlier);
    }
    assert_optimal(&mut drive);
    assert!(drive.twin.graph.cost() < 0.9 * with);
    assert_eq!(drive.twin.graph.factor_count(), drive.twin.factors.len());
}

#[test]
fn removed_variables_leave_no_trace() {
    let mut drive = Course::new(6).driven();
    let body = drive.twin.ellipsoids[2];
    drive.twin.remove_variable(body);
    let last = drive.twin.poses[27];
    drive.twin.remove_variable(last);
    assert_optimal(&mut drive);
    assert_eq!(drive.twin.graph.factor_count(), drive.twin.factors.len());
}

#[test]
fn what_is_removed_before_it_was_solved_was_never_there() {
    let mut drive = Drive::new(Course::new(7));
    (0..10).for_each(|_| {
        drive.step();
        drive.twin.graph.update().unwrap();
    });
    let before = drive.twin.estimate();
    let new = drive.twin.add_pose(Pose::identity());
    let tied = drive.twin.add(tie(drive.twin.poses[9], new));
    let wrong = drive.twin.add(PosePrior::new(drive.twin.poses[3], step(), noise()));
    drive.twin.remove_factor(wrong);
    drive.twin.graph.remove_factor(tied);
    drive.twin.remove_variable(new);
    drive.twin.graph.update().unwrap();
    assert_eq!(drive.twin.graph.factor_count(), drive.twin.factors.len());
    assert!(distance(&before, &drive.twin.estimate()) < 0.02);
    assert_optimal(&mut drive);
}

#[test]
fn a_new_factor_on_a_variable_that_goes_goes_with_it() {
    let mut drive = Course::new(7).driven();
    let (body, pose) = (drive.twin.ellipsoids[1], drive.twin.poses[5]);
    drive.twin.add(PosePrior::new(pose, step(), noise()));
    drive.twin.remove_variable(pose);
    drive.twin.add(tie(drive.twin.poses[4], drive.twin.poses[5]));
    drive.twin.remove_variable(body);
    assert_optimal(&mut drive);
    assert_eq!(drive.twin.graph.factor_count(), drive.twin.factors.len());
}

#[test]
fn a_variable_can_be_replaced_in_one_update() {
    let mut drive = Course::new(8).driven();
    let old = drive.twin.ellipsoids[0];
    let at = drive.twin.graph.ellipsoid(old);
    drive.twin.remove_variable(old);
    let new = drive.twin.add_ellipsoid(at);
    let noise = Noise::from_sigmas([0.1; 9]).unwrap();
    drive.twin.add(ellipsoid_slam::graph::EllipsoidPrior::new(new, at, noise));
    assert_optimal(&mut drive);
}

#[test]
fn an_undetermined_variable_is_named_and_everything_stays_as_it_was() {
    let mut drive = Drive::new(Course::new(9));
    (0..12).for_each(|_| {
        drive.step();
        drive.twin.graph.update().unwrap();
    });
    let (values, cost, count) =
        (drive.twin.estimate(), drive.twin.graph.cost(), drive.twin.graph.factor_count());
    let graph = &mut drive.twin.graph;
    let (tied, loose) = (graph.add_pose(step()), graph.add_pose(step()));
    graph.add_factor(tie(drive.twin.poses[11], tied));
    graph.add_factor(PosePrior::new(drive.twin.poses[2], step(), noise()));
    let gone = graph.add_factor(PosePrior::new(drive.twin.poses[2], step(), noise()));
    graph.remove_factor(gone);
    graph.remove_factor(drive.observations[4]);
    assert_eq!(graph.update().unwrap_err().variable, loose.into());

    assert_eq!(drive.twin.estimate(), values);
    assert_eq!(drive.twin.graph.cost(), cost);
    assert_eq!(drive.twin.graph.factor_count(), count);
    // As if it had not been tried, to the bit.
    let mut other = Drive::new(Course::new(9));
    (0..12).for_each(|_| {
        other.step();
        other.twin.graph.update().unwrap();
    });
    while drive.step() && other.step() {
        drive.twin.graph.update().unwrap();
        other.twin.graph.update().unwrap();
    }
    let estimates = |twin: &Twin| twin.estimate().into_values().collect::<Vec<_>>();
    assert_eq!(estimates(&drive.twin), estimates(&other.twin));
    assert_optimal(&mut drive);
}

#[test]
fn what_holds_everything_cannot_be_removed() {
    let mut graph = Graph::new(SolverSettings::default());
    let a = graph.add_pose(Pose::identity());
    let b = graph.add_pose(step());
    let prior = graph.add_factor(PosePrior::new(a, Pose::identity(), noise()));
    let tie = graph.add_factor(tie(a, b));
    graph.update().unwrap();
    graph.remove_factor(prior);
    assert!(graph.update().is_err());
    graph.remove_factor(tie);
    let error = graph.update().unwrap_err();
    assert_eq!(error.variable, VariableId::from(b));
    assert_eq!(error.to_string(), "the factors leave variable 1 undetermined");
    assert_eq!(graph.factor_count(), 2);
    graph.update().unwrap();
    assert!((graph.pose(b).translation.vector - step().translation.vector).norm() < 1e-9);
}

/// Places in memory are used again, so handles of what is gone must not lead to what came after it.
#[test]
fn handles_of_what_is_gone_lead_nowhere() {
    let mut graph = Graph::new(SolverSettings::default());
    let first = graph.add_pose(Pose::identity());
    graph.add_factor(PosePrior::new(first, Pose::identity(), noise()));
    let gone = graph.add_pose(step());
    let old = graph.add_factor(tie(first, gone));
    graph.update().unwrap();
    graph.remove_variable(gone);
    graph.update().unwrap();

    let new = graph.add_pose(step());
    assert_eq!(VariableId::from(new).index(), VariableId::from(gone).index());
    assert_ne!(new, gone);
    graph.add_factor(tie(first, new));
    graph.remove_factor(old);
    graph.remove_variable(gone);
    graph.add_factor(tie(gone, first));
    graph.update().unwrap();
    assert_eq!((graph.factor_count(), graph.degree(first), graph.degree(new)), (2, 2, 1));
}
