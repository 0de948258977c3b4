//! The terms of the cost through their public interface: laws that each obeys, and examples worked out by hand.

mod box_observation;
mod ellipsoid_observation;
mod face_evidence;
mod jacobians;
mod kernel;
mod noise;
mod odometry_noise;
mod relative_pose;
mod size_prior;
mod solver;
mod standing;
mod variable;
mod wall_observation;

use ellipsoid_slam::{
    geometry::Outline,
    graph::{EllipsoidId, Factor, PoseId, Variable, VariableIds},
};
use nalgebra::{DMatrix, DVector, SMatrix};
use proptest::prelude::*;

/// Two poses and an ellipsoid: nothing ties together more.
pub(crate) fn ids() -> (PoseId, PoseId, EllipsoidId) {
    let mut ids = VariableIds::default();
    (ids.next_pose(), ids.next_pose(), ids.next_ellipsoid())
}

/// Without the kernel.
pub(crate) fn cost(factor: &dyn Factor, at: &[Variable]) -> f64 {
    0.5 * factor.residual(at).norm_squared()
}

pub(crate) fn outlines() -> impl Strategy<Value = Outline> {
    prop_oneof![
        Just(Outline::Ellipsoid),
        Just(Outline::Cuboid),
        Just(Outline::Cylinder),
        (0.2..1.0, 0.2..1.8).prop_map(|(e1, e2)| Outline::Superquadric(e1, e2)),
    ]
}

/// A dense covariance: `L L^T` with standard deviations around 0.1.
pub(crate) fn covariances<const N: usize>() -> impl Strategy<Value = SMatrix<f64, N, N>> {
    prop::collection::vec(-0.05..0.05, N * N).prop_map(|numbers| {
        let spread = SMatrix::<f64, N, N>::from_iterator(numbers);
        spread * spread.transpose() + SMatrix::identity() * 0.01
    })
}

/// The residual's derivative by differences backwards and forwards.
fn numeric_jacobians(factor: &dyn Factor, at: &[Variable]) -> [DMatrix<f64>; 2] {
    // Truncation grows with the square of the step, rounding with its inverse.
    const STEP: f64 = 1e-6;
    let here = factor.residual(at);
    [-STEP, STEP].map(|size| {
        let mut columns: Vec<DVector<f64>> = Vec::new();
        for (i, variable) in at.iter().enumerate() {
            for j in 0..variable.dimension() {
                let mut delta = vec![0.0; variable.dimension()];
                delta[j] = size;
                let mut moved = at.to_vec();
                moved[i] = variable.retract(&delta);
                columns.push((factor.residual(&moved) - &here) / size);
            }
        }
        DMatrix::from_columns(&columns)
    })
}

/// What every factor has to obey, wherever it is linearised.
pub(crate) fn assert_linearization(factor: &dyn Factor, at: &[Variable]) {
    assert_eq!(factor.variables().len(), at.len());
    let linear = factor.linearize(at);
    let same = (&linear.residual - factor.residual(at)).amax();
    assert!(same < 1e-12 * (1.0 + linear.residual.amax()), "two residuals differ by {same}");
    let [backward, forward] = numeric_jacobians(factor, at);
    let central = (&backward + &forward) * 0.5;
    assert_eq!(linear.jacobian.shape(), central.shape());
    // Relative to the largest derivative: residuals of a hundred sigma cost eight digits of their differences.
    let tolerance = 1e-5 * (1.0 + central.amax() + linear.residual.amax());
    for (i, got) in linear.jacobian.iter().enumerate() {
        // A cuboid may change corners on the way: then any slope between those of the two corners is one.
        let is_between = (backward[i] - got) * (forward[i] - got) <= 0.0;
        assert!(
            (got - central[i]).abs() < tolerance || is_between,
            "{factor:?}\nelement {i} is {got}, between {} and {} by differences (tolerance {tolerance})",
            backward[i],
            forward[i],
        );
    }
}
