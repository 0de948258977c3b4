//! What is known of a variable beforehand.

use crate::{
    geometry::{self, Ellipsoid, Pose, log_derivative},
    graph::{EllipsoidId, Factor, Kernel, Linearization, Noise, PoseId, Variable, VariableId},
};
use nalgebra::{DVector, SMatrix, SVector, Vector6};

/// A pose is near `prior`: `r = W log(prior^-1 x)`.
#[derive(Clone, Debug)]
pub struct PosePrior {
    variables: [VariableId; 1],
    prior: Pose,
    noise: Noise<6>,
}

impl PosePrior {
    /// `noise` is that of `[rotation, translation]` (rad, m), a right perturbation.
    pub fn new(pose: PoseId, prior: Pose, noise: Noise<6>) -> Self {
        Self { variables: [pose.into()], prior, noise }
    }

    fn difference(&self, at: &[Variable]) -> Vector6<f64> {
        geometry::local(&self.prior, at[0].pose())
    }
}

impl Factor for PosePrior {
    fn variables(&self) -> &[VariableId] {
        &self.variables
    }

    fn residual(&self, at: &[Variable]) -> DVector<f64> {
        let whitened = self.noise.whiten(&self.difference(at));
        DVector::from_column_slice(whitened.as_slice())
    }

    fn linearize(&self, at: &[Variable]) -> Linearization {
        let difference = self.difference(at);
        let jacobian = log_derivative(&difference);
        Linearization::new(&self.noise.whiten(&difference), &self.noise.whiten(&jacobian))
    }

    fn move_map(&mut self, new_from_old: &Pose) {
        self.prior = new_from_old * self.prior;
    }
}

/// An ellipsoid is near `prior`: `r = W (x ⊟ prior)`.
///
/// It holds on to the names of the prior's axes: use it where the prior is an estimate of the same variable. For what
/// a camera sees, [`EllipsoidObservation`](crate::graph::EllipsoidObservation) does not depend on them.
#[derive(Clone, Debug)]
pub struct EllipsoidPrior {
    variables: [VariableId; 1],
    prior: Ellipsoid,
    noise: Noise<9>,
    kernel: Kernel,
}

impl EllipsoidPrior {
    /// `noise` is that of `[rotation, translation, log semi-axes]` (rad, m, 1), a right perturbation.
    pub fn new(ellipsoid: EllipsoidId, prior: Ellipsoid, noise: Noise<9>) -> Self {
        Self { variables: [ellipsoid.into()], prior, noise, kernel: Kernel::Quadratic }
    }

    /// The same about another object: what was taken for two turned out to be one.
    pub fn of(self, ellipsoid: EllipsoidId) -> Self {
        Self { variables: [ellipsoid.into()], ..self }
    }

    /// The same with a robust kernel.
    pub fn with_kernel(self, kernel: Kernel) -> Self {
        Self { kernel, ..self }
    }

    fn difference(&self, at: &[Variable]) -> SVector<f64, 9> {
        self.prior.local(at[0].known_ellipsoid())
    }
}

impl Factor for EllipsoidPrior {
    fn variables(&self) -> &[VariableId] {
        &self.variables
    }

    fn residual(&self, at: &[Variable]) -> DVector<f64> {
        let whitened = self.noise.whiten(&self.difference(at));
        DVector::from_column_slice(whitened.as_slice())
    }

    fn linearize(&self, at: &[Variable]) -> Linearization {
        let difference = self.difference(at);
        let mut jacobian = SMatrix::<f64, 9, 9>::identity();
        let pose_part = log_derivative(&difference.fixed_rows::<6>(0).into_owned());
        jacobian.fixed_view_mut::<6, 6>(0, 0).copy_from(&pose_part);
        Linearization::new(&self.noise.whiten(&difference), &self.noise.whiten(&jacobian))
    }

    fn move_map(&mut self, new_from_old: &Pose) {
        self.prior = self.prior.transformed(new_from_old);
    }

    fn kernel(&self) -> Kernel {
        self.kernel
    }
}
