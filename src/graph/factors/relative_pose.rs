//! The step between two poses, as odometry or a loop closure measures it.

use crate::{
    geometry::{Pose, adjoint, log, log_derivative},
    graph::{Factor, Linearization, Noise, PoseId, Variable, VariableId},
};
use nalgebra::{DVector, SMatrix, Vector6};

/// `r = W log(z^-1 x_i^-1 x_j)`. Liao et al. 2020, eq. (16).
#[derive(Clone, Debug)]
pub struct RelativePose {
    variables: [VariableId; 2],
    /// `j_from_i` of the measurement.
    measured_inverse: Pose,
    noise: Noise<6>,
}

impl RelativePose {
    /// `from_from_to` is the measured pose of `to` in the frame of `from`; `noise` is that of `[rotation, translation]`
    /// (rad, m), a right perturbation of it.
    pub fn new(from: PoseId, to: PoseId, from_from_to: &Pose, noise: Noise<6>) -> Self {
        Self {
            variables: [from.into(), to.into()],
            measured_inverse: from_from_to.inverse(),
            noise,
        }
    }

    /// `x_i^-1 x_j` and the error of the measurement.
    fn evaluate(&self, at: &[Variable]) -> (Pose, Vector6<f64>) {
        let from_from_to = at[0].pose().inv_mul(at[1].pose());
        (from_from_to, log(&(self.measured_inverse * from_from_to)))
    }
}

impl Factor for RelativePose {
    fn variables(&self) -> &[VariableId] {
        &self.variables
    }

    fn residual(&self, at: &[Variable]) -> DVector<f64> {
        let whitened = self.noise.whiten(&self.evaluate(at).1);
        DVector::from_column_slice(whitened.as_slice())
    }

    fn linearize(&self, at: &[Variable]) -> Linearization {
        let (from_from_to, error) = self.evaluate(at);
        let by_to = self.noise.whiten(&log_derivative(&error));
        // x_i exp(d) is seen from x_j as exp(-Ad(j_from_i) d) on the right of the step.
        let by_from = -by_to * adjoint(&from_from_to.inverse());
        let mut jacobian = SMatrix::<f64, 6, 12>::zeros();
        jacobian.fixed_view_mut::<6, 6>(0, 0).copy_from(&by_from);
        jacobian.fixed_view_mut::<6, 6>(0, 6).copy_from(&by_to);
        Linearization::new(&self.noise.whiten(&error), &jacobian)
    }
}
