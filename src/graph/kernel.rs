//! Robust kernels: how much a residual costs that may be an outlier's.

/// The cost of a whitened residual by its norm `d`. With a robust kernel, outliers pull less.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kernel {
    /// `d^2 / 2`: least squares.
    Quadratic,
    /// `d^2 / 2` up to the threshold `k`, from there on `k (d - k / 2)`. Huber 1964.
    Huber(f64),
    /// `k^2 / 2 ln(1 + d^2 / k^2)`.
    Cauchy(f64),
    /// `c^2 / 2 d^2 / (c^2 + d^2)`: no residual costs more than `c^2 / 2`. Geman and McClure 1985.
    GemanMcClure(f64),
}

impl Kernel {
    /// Cost of a whitened residual with this squared norm.
    pub fn cost(&self, squared_norm: f64) -> f64 {
        let s = squared_norm;
        match *self {
            Self::Quadratic => 0.5 * s,
            Self::Huber(k) if s <= k * k => 0.5 * s,
            Self::Huber(k) => k * (s.sqrt() - 0.5 * k),
            Self::Cauchy(k) => 0.5 * k * k * (s / (k * k)).ln_1p(),
            Self::GemanMcClure(c) => 0.5 * c * c * s / (c * c + s),
        }
    }

    /// Weight for iteratively reweighted least squares: twice the derivative of [`Kernel::cost`].
    pub fn weight(&self, squared_norm: f64) -> f64 {
        let s = squared_norm;
        match *self {
            Self::Quadratic => 1.0,
            Self::Huber(k) if s <= k * k => 1.0,
            Self::Huber(k) => k / s.sqrt(),
            Self::Cauchy(k) => k * k / (k * k + s),
            Self::GemanMcClure(c) => (c * c / (c * c + s)).powi(2),
        }
    }

    /// The residual whose square costs what this scalar residual costs with the kernel, and its derivative by that: so that
    /// components of one factor can each have a kernel of their own. Both grow with the residual.
    pub(super) fn rooted(&self, residual: f64) -> (f64, f64) {
        let squared = residual * residual;
        let root = (2.0 * self.cost(squared)).sqrt().copysign(residual);
        let slope = if root == 0.0 { 1.0 } else { self.weight(squared) * residual / root };
        (root, slope)
    }
}
