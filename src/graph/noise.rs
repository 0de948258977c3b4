//! How sure a measurement is.

use nalgebra::{Cholesky, SMatrix};
use thiserror::Error;

/// Gaussian noise of a residual, as the square root `W` of its information: `W^T W` is the inverse of the covariance.
///
/// `W` is lower triangular, and `W r` has unit covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise<const N: usize> {
    square_root: SMatrix<f64, N, N>,
}

/// Why numbers are not the noise of a measurement.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum NoiseError {
    /// An element is infinite or not a number.
    #[error("the covariance has {value} in row {row}, column {column}")]
    NotFinite {
        /// Counted from 0.
        row: usize,
        /// Counted from 0.
        column: usize,
        /// What is there.
        value: f64,
    },
    /// The two sides of the diagonal differ by more than rounding.
    #[error("the covariance is not symmetric: row {row}, column {column} differs by {difference}")]
    NotSymmetric {
        /// Counted from 0.
        row: usize,
        /// Counted from 0.
        column: usize,
        /// Of the two elements.
        difference: f64,
    },
    /// Some direction would be known exactly, or better than that.
    #[error("the covariance is not positive definite")]
    NotPositiveDefinite,
    /// A standard deviation is zero, negative or not finite.
    #[error("standard deviation {index} is {value}, which is not a positive number")]
    Sigma {
        /// Which one, counted from 0.
        index: usize,
        /// What it is.
        value: f64,
    },
    /// A weight is zero, negative or not finite.
    #[error("information cannot be scaled by {scale}")]
    Scale {
        /// What was asked for.
        scale: f64,
    },
}

impl<const N: usize> Noise<N> {
    /// From a covariance.
    ///
    /// # Errors
    /// When the matrix is not finite, not symmetric or not positive definite.
    pub fn from_covariance(covariance: &SMatrix<f64, N, N>) -> Result<Self, NoiseError> {
        check_symmetric(covariance)?;
        let symmetric = (covariance + covariance.transpose()) * 0.5;
        let lower = Cholesky::new(symmetric).ok_or(NoiseError::NotPositiveDefinite)?.unpack();
        // C = L L^T, so its inverse is (L^-1)^T L^-1.
        let square_root = lower
            .solve_lower_triangular(&SMatrix::identity())
            .filter(|w| w.iter().all(|v| v.is_finite()))
            .ok_or(NoiseError::NotPositiveDefinite)?;
        Ok(Self { square_root })
    }

    /// From standard deviations without correlations.
    ///
    /// # Errors
    /// When one of them is not a positive finite number.
    pub fn from_sigmas(sigmas: [f64; N]) -> Result<Self, NoiseError> {
        let mut square_root = SMatrix::zeros();
        for (index, value) in sigmas.into_iter().enumerate() {
            square_root[(index, index)] = NoiseError::inverse_of_sigma(index, value)?;
        }
        Ok(Self { square_root })
    }

    /// The same noise with `scale` times the information.
    ///
    /// # Errors
    /// When the scale is not a positive finite number.
    pub fn scaled(self, scale: f64) -> Result<Self, NoiseError> {
        Ok(Self { square_root: self.square_root * NoiseError::root_of_scale(scale)? })
    }

    /// The lower triangular `W` with `W^T W` = information.
    pub fn square_root_information(&self) -> &SMatrix<f64, N, N> {
        &self.square_root
    }

    /// A residual or the columns of its derivative in units of standard deviations.
    pub fn whiten<const C: usize>(&self, columns: &SMatrix<f64, N, C>) -> SMatrix<f64, N, C> {
        // Derivatives are half zeros, and a general product of matrices is slow on sizes like these.
        let mut whitened = SMatrix::<f64, N, C>::zeros();
        for column in 0..C {
            for row in 0..N {
                let value = columns[(row, column)];
                if value != 0.0 {
                    whitened.column_mut(column).axpy(value, &self.square_root.column(row), 1.0);
                }
            }
        }
        whitened
    }
}

impl NoiseError {
    /// `sqrt(scale)`, by which residuals grow, if information can be scaled by `scale`.
    pub(super) fn root_of_scale(scale: f64) -> Result<f64, Self> {
        if scale.is_finite() && scale > 0.0 { Ok(scale.sqrt()) } else { Err(Self::Scale { scale }) }
    }

    /// `1 / value`, if `value` is a standard deviation.
    pub(super) fn inverse_of_sigma(index: usize, value: f64) -> Result<f64, Self> {
        let is_sigma = value.is_finite() && value > 0.0;
        if is_sigma { Ok(1.0 / value) } else { Err(Self::Sigma { index, value }) }
    }
}

fn check_symmetric<const N: usize>(covariance: &SMatrix<f64, N, N>) -> Result<(), NoiseError> {
    for column in 0..N {
        for row in 0..N {
            let value = covariance[(row, column)];
            if !value.is_finite() {
                return Err(NoiseError::NotFinite { row, column, value });
            }
            let difference = value - covariance[(column, row)];
            let size = (covariance[(row, row)] * covariance[(column, column)]).abs().sqrt();
            if difference.abs() > ASYMMETRY * size {
                return Err(NoiseError::NotSymmetric { row, column, difference });
            }
        }
    }
    Ok(())
}

/// Rounding of covariances that were turned into another frame, as a share of the standard deviations.
const ASYMMETRY: f64 = 1e-6;
