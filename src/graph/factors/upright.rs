//! Things that stand upright.

use crate::graph::{Body, Factor, Linearization, NoiseError, Variable, VariableId};
use nalgebra::{DMatrix, DVector, Vector2, Vector3};

/// The z axis of an object or a pose points up in the map: `r` = horizontal part of `R e_z`, over sigma.
///
/// Its length is the sine of the tilt; an arccosine would have no derivative where everything should end up. A body
/// that is upside down is upright, too.
#[derive(Clone, Debug)]
pub struct Upright {
    variables: [VariableId; 1],
    inverse_sigma: f64,
}

impl Upright {
    /// `sigma_rad` is that of the tilt in each of two directions.
    ///
    /// # Errors
    /// When sigma is not a positive number.
    pub fn new(body: impl Body, sigma_rad: f64) -> Result<Self, NoiseError> {
        let inverse_sigma = NoiseError::inverse_of_sigma(0, sigma_rad)?;
        Ok(Self { variables: [body.into()], inverse_sigma })
    }

    fn whitened(&self, at: &[Variable]) -> Vector2<f64> {
        (at[0].pose().rotation * Vector3::z()).xy() * self.inverse_sigma
    }
}

impl Factor for Upright {
    fn variables(&self) -> &[VariableId] {
        &self.variables
    }

    fn residual(&self, at: &[Variable]) -> DVector<f64> {
        DVector::from_column_slice(self.whitened(at).as_slice())
    }

    fn linearize(&self, at: &[Variable]) -> Linearization {
        let rotation = at[0].pose().rotation.to_rotation_matrix();
        let mut jacobian = DMatrix::zeros(2, at[0].dimension());
        // R Exp(d) e_z = R (e_z + d × e_z), and d × e_z = (d_y, -d_x, 0).
        for row in 0..2 {
            jacobian[(row, 0)] = -rotation[(row, 1)] * self.inverse_sigma;
            jacobian[(row, 1)] = rotation[(row, 0)] * self.inverse_sigma;
        }
        Linearization { residual: self.residual(at), jacobian }
    }
}
