//! Walls of one building.

use crate::graph::{Factor, Kernel, Linearization, NoiseError, Variable, VariableId, WallId};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::FRAC_PI_2;

/// Two walls are parallel or at right angles: `r` = what their angle differs by from so many quarter turns, over sigma.
///
/// Coughlan and Yuille 1999, Manhattan World, for pairs of walls: a building may have several directions.
#[derive(Clone, Debug)]
pub struct RightAngle {
    variables: [VariableId; 2],
    angle: f64,
    inverse_sigma: f64,
    kernel: Kernel,
}

impl RightAngle {
    /// `quarters` is how many quarter turns lead from the first wall's normal to the second's; `sigma_rad` is how exactly
    /// the building is built.
    ///
    /// # Errors
    /// When sigma is not a positive number.
    pub fn new(from: WallId, to: WallId, quarters: i8, sigma_rad: f64) -> Result<Self, NoiseError> {
        Ok(Self {
            variables: [from.into(), to.into()],
            angle: f64::from(quarters) * FRAC_PI_2,
            inverse_sigma: NoiseError::inverse_of_sigma(0, sigma_rad)?,
            kernel: Kernel::Quadratic,
        })
    }

    /// The same with a robust kernel.
    #[must_use]
    pub fn with_kernel(self, kernel: Kernel) -> Self {
        Self { kernel, ..self }
    }
}

impl Factor for RightAngle {
    fn variables(&self) -> &[VariableId] {
        &self.variables
    }

    fn residual(&self, at: &[Variable]) -> DVector<f64> {
        let (from, to) = (at[0].known_wall(), at[1].known_wall());
        let off = from.turned(self.angle).local(to).x;
        DVector::from_element(1, off * self.inverse_sigma)
    }

    fn linearize(&self, at: &[Variable]) -> Linearization {
        let row = [-self.inverse_sigma, 0.0, self.inverse_sigma, 0.0];
        Linearization {
            residual: self.residual(at),
            jacobian: DMatrix::from_row_slice(1, row.len(), &row),
        }
    }

    fn kernel(&self) -> Kernel {
        self.kernel
    }
}
