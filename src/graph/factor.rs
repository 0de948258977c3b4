//! What ties variables together: the terms of the cost.

use super::{Kernel, Variable, VariableId};
use crate::geometry::Pose;
use nalgebra::{DMatrix, DVector, SMatrix, SVector};

/// A residual and its derivative at some values.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearization {
    /// Whitened residual.
    pub residual: DVector<f64>,
    /// Its derivative by the tangents of the factor's variables, side by side in their order.
    pub jacobian: DMatrix<f64>,
}

impl Linearization {
    /// From matrices whose sizes are known when compiling.
    pub(super) fn new<const R: usize, const C: usize>(
        residual: &SVector<f64, R>,
        jacobian: &SMatrix<f64, R, C>,
    ) -> Self {
        Self {
            residual: DVector::from_column_slice(residual.as_slice()),
            jacobian: DMatrix::from_column_slice(R, C, jacobian.as_slice()),
        }
    }
}

/// A term of the cost: `kernel.cost(||r||^2)` with `r` whitened.
pub trait Factor: std::fmt::Debug + Send + Sync {
    /// The variables it ties together, each once; their tangents have at most 18 elements together, as two ellipsoids'.
    fn variables(&self) -> &[VariableId];

    /// Whitened residual; `at[i]` is the value of `variables()[i]`.
    fn residual(&self, at: &[Variable]) -> DVector<f64>;

    /// The residual and its derivative, at the same values.
    fn linearize(&self, at: &[Variable]) -> Linearization;

    /// The whole map moves: a factor that knows a place in it takes this place along, so that its residual stays the
    /// same. Whatever compares variables with one another has nothing to do. `new_from_old` turns about the vertical.
    fn move_map(&mut self, _new_from_old: &Pose) {}

    /// How the residual's norm becomes cost.
    fn kernel(&self) -> Kernel {
        Kernel::Quadratic
    }
}
