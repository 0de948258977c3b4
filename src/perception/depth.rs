//! The depth image.

use thiserror::Error;

/// Metric depth along the optical axis, row-major; NaN where there is no reading.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthImage {
    width: u32,
    height: u32,
    metres: Vec<f32>,
}

/// Why pixels are not a depth image.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DepthError {
    /// The number of pixels does not fit the size.
    #[error("a depth image of {width}x{height} needs {expected} pixels, got {got}", expected = u64::from(*width) * u64::from(*height))]
    WrongLength {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// Pixels given.
        got: usize,
    },
}

impl DepthImage {
    /// An image from `width * height` depths (m), row-major. Readings that are not positive and finite mean
    /// "none" and become NaN.
    ///
    /// # Errors
    /// When the number of pixels does not fit the size.
    pub fn new(width: u32, height: u32, mut metres: Vec<f32>) -> Result<Self, DepthError> {
        if u64::from(width) * u64::from(height) != metres.len() as u64 {
            return Err(DepthError::WrongLength { width, height, got: metres.len() });
        }
        for z in &mut metres {
            if !(z.is_finite() && *z > 0.0) {
                *z = f32::NAN;
            }
        }
        Ok(Self { width, height, metres })
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Depths (m), row-major, NaN where there is no reading.
    pub fn metres(&self) -> &[f32] {
        &self.metres
    }

    /// Depth at column `u`, row `v` (m), or nothing outside the image or without a reading.
    #[inline]
    pub fn at(&self, u: i32, v: i32) -> Option<f32> {
        if u < 0 || v < 0 || u as u32 >= self.width || v as u32 >= self.height {
            return None;
        }
        let z = self.metres[v as usize * self.width as usize + u as usize];
        (!z.is_nan()).then_some(z)
    }
}
