//! How large things of a class usually are.

use crate::graph::{
    EllipsoidId, Factor, Kernel, Linearization, Noise, NoiseError, Variable, VariableId,
};
use nalgebra::{DVector, Matrix3, SMatrix, Vector3};

/// A body is about as large as others of its class: `r = W (log s - log u)` with its semi-axes `s` and the usual ones `u`,
/// of which the longer horizontal one belongs to whichever of the body's axes fits better. After Ok et al. 2019.
///
/// What was seen of an object outweighs it, what was not seen follows from it: once, however many views guess.
#[derive(Clone, Debug)]
pub struct SizePrior {
    variables: [VariableId; 1],
    usual: Vector3<f64>,
    noise: Noise<3>,
    kernel: Kernel,
}

impl SizePrior {
    /// `usual` are semi-axes (m): the longer horizontal one, the shorter one, the upright one. Bodies differ from it in size by
    /// `size_sigma`, and each of their extents by `proportion_sigma` besides: standard deviations of logarithms.
    ///
    /// Where the horizontal ones differ by less than their own spreads, a body's longer axis is as probably the usually shorter
    /// one. Then both are expected to have the mean of the two, and to differ by so much more in opposite directions: the
    /// first two moments of either.
    ///
    /// # Errors
    /// When the standard deviations are no positive numbers.
    pub fn new(
        ellipsoid: EllipsoidId,
        mut usual: Vector3<f64>,
        [size_sigma, proportion_sigma]: [f64; 2],
    ) -> Result<Self, NoiseError> {
        let mut covariance = Matrix3::repeat(size_sigma * size_sigma)
            + Matrix3::identity() * (proportion_sigma * proportion_sigma);
        let off_mean = Vector3::new(0.5, -0.5, 0.0) * (usual.x / usual.y).ln();
        if off_mean.amax() < proportion_sigma {
            usual.x = (usual.x * usual.y).sqrt();
            usual.y = usual.x;
            covariance += off_mean * off_mean.transpose();
        }
        Ok(Self {
            variables: [ellipsoid.into()],
            usual,
            noise: Noise::from_covariance(&covariance)?,
            kernel: Kernel::Quadratic,
        })
    }

    /// The same with a robust kernel.
    pub fn with_kernel(self, kernel: Kernel) -> Self {
        Self { kernel, ..self }
    }

    /// The same about another body: what was taken for two turned out to be one.
    pub fn of(self, ellipsoid: EllipsoidId) -> Self {
        Self { variables: [ellipsoid.into()], ..self }
    }

    /// Whitened, and whether the body's y axis is the longer one.
    fn compare(&self, body: &Vector3<f64>) -> (Vector3<f64>, bool) {
        let log_ratio = |s: Vector3<f64>| s.zip_map(&self.usual, |s, usual| (s / usual).ln());
        let whitened = |s: Vector3<f64>| self.noise.whiten(&log_ratio(s));
        let (along, across) = (whitened(*body), whitened(body.yxz()));
        if self.usual.x != self.usual.y && across.norm_squared() < along.norm_squared() {
            (across, true)
        } else {
            (along, false)
        }
    }
}

impl Factor for SizePrior {
    fn variables(&self) -> &[VariableId] {
        &self.variables
    }

    fn residual(&self, at: &[Variable]) -> DVector<f64> {
        let (residual, _) = self.compare(&at[0].known_ellipsoid().semi_axes);
        DVector::from_column_slice(residual.as_slice())
    }

    fn linearize(&self, at: &[Variable]) -> Linearization {
        let (residual, is_swapped) = self.compare(&at[0].known_ellipsoid().semi_axes);
        let mut jacobian = SMatrix::<f64, 3, 9>::zeros();
        let order = if is_swapped { [1, 0, 2] } else { [0, 1, 2] };
        for (row, axis) in order.into_iter().enumerate() {
            jacobian[(row, 6 + axis)] = 1.0;
        }
        Linearization::new(&residual, &self.noise.whiten(&jacobian))
    }

    fn kernel(&self) -> Kernel {
        self.kernel
    }
}
