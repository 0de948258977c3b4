//! The pinhole camera with lens distortion.

use nalgebra::{Point2, Point3, Vector3};
use thiserror::Error;

/// Lens distortion, in the models of `sensor_msgs/CameraInfo`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distortion {
    /// A rectified image.
    None,
    /// `plumb_bob`, `[k1, k2, p1, p2, k3]`: Brown 1966.
    PlumbBob([f64; 5]),
    /// `rational_polynomial`, `[k1, k2, p1, p2, k3, k4, k5, k6]`: Claus and Fitzgibbon 2005, as in OpenCV.
    Rational([f64; 8]),
}

/// A pinhole camera whose numbers have been checked: finite, positive focal lengths, a non-empty image.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    width: u32,
    height: u32,
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    distortion: Distortion,
}

/// Why numbers are not a camera.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CameraError {
    /// A focal length is zero, negative or not finite: an uncalibrated camera sends zeros.
    #[error(
        "focal lengths fx={fx}, fy={fy} are not positive numbers: the camera is not calibrated"
    )]
    FocalLength {
        /// Horizontal focal length (px).
        fx: f64,
        /// Vertical focal length (px).
        fy: f64,
    },
    /// The principal point or a distortion coefficient is not finite.
    #[error("the principal point or the distortion is not a finite number")]
    NotFinite,
    /// An image without pixels.
    #[error("the image size {width}x{height} is empty")]
    EmptyImage {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
}

impl Camera {
    /// A camera of `size` = `(width, height)` pixels with `focal` = `(fx, fy)` and `principal` = `(cx, cy)` (px).
    ///
    /// # Errors
    /// When a number is not finite, a focal length is not positive or the image is empty.
    pub fn new(
        size: (u32, u32),
        focal: (f64, f64),
        principal: (f64, f64),
        distortion: Distortion,
    ) -> Result<Self, CameraError> {
        let ((width, height), (fx, fy), (cx, cy)) = (size, focal, principal);
        if width == 0 || height == 0 {
            return Err(CameraError::EmptyImage { width, height });
        }
        if !(fx.is_finite() && fy.is_finite() && fx > 0.0 && fy > 0.0) {
            return Err(CameraError::FocalLength { fx, fy });
        }
        let coefficients: &[f64] = match &distortion {
            Distortion::None => &[],
            Distortion::PlumbBob(d) => d,
            Distortion::Rational(d) => d,
        };
        if !(cx.is_finite() && cy.is_finite() && coefficients.iter().all(|k| k.is_finite())) {
            return Err(CameraError::NotFinite);
        }
        let zero = coefficients.iter().all(|k| *k == 0.0);
        let distortion = if zero { Distortion::None } else { distortion };
        Ok(Self { width, height, fx, fy, cx, cy, distortion })
    }

    /// Columns of the image.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows of the image.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Focal lengths `(fx, fy)` (px).
    pub fn focal(&self) -> (f64, f64) {
        (self.fx, self.fy)
    }

    /// Principal point `(cx, cy)` (px).
    pub fn principal(&self) -> (f64, f64) {
        (self.cx, self.cy)
    }

    /// Lens distortion; [`Distortion::None`] if all coefficients are zero.
    pub fn distortion(&self) -> Distortion {
        self.distortion
    }

    /// The same camera for the rectified image with the same intrinsics.
    pub fn rectified(&self) -> Self {
        Self { distortion: Distortion::None, ..self.clone() }
    }

    /// Pixel of a point in the camera frame, or nothing if it is not in front of the camera.
    ///
    /// The pixel may lie outside the image.
    pub fn project(&self, point: &Point3<f64>) -> Option<Point2<f64>> {
        if point.z <= 1e-6 {
            return None;
        }
        let (x, y) = self.distort(point.x / point.z, point.y / point.z);
        Some(Point2::new(self.fx * x + self.cx, self.fy * y + self.cy))
    }

    /// The direction `(x, y, 1)` in the camera frame that is seen at pixel `(u, v)`.
    ///
    /// Distortion is inverted by fixed-point iteration, to well below a hundredth of a pixel for real lenses.
    pub fn ray(&self, u: f64, v: f64) -> Vector3<f64> {
        let (x_d, y_d) = ((u - self.cx) / self.fx, (v - self.cy) / self.fy);
        if self.distortion == Distortion::None {
            return Vector3::new(x_d, y_d, 1.0);
        }
        let (mut x, mut y) = (x_d, y_d);
        for _ in 0..MAX_UNDISTORT_ITERATIONS {
            let (x_now, y_now) = self.distort(x, y);
            let (dx, dy) = (x_d - x_now, y_d - y_now);
            (x, y) = (x + dx, y + dy);
            if dx.abs().max(dy.abs()) < 1e-9 {
                break;
            }
        }
        Vector3::new(x, y, 1.0)
    }

    /// Distorted normalised coordinates of undistorted ones.
    fn distort(&self, x: f64, y: f64) -> (f64, f64) {
        let r2 = x * x + y * y;
        let (radial, p1, p2) = match self.distortion {
            Distortion::None => return (x, y),
            Distortion::PlumbBob([k1, k2, p1, p2, k3]) => {
                (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3)), p1, p2)
            }
            Distortion::Rational([k1, k2, p1, p2, k3, k4, k5, k6]) => {
                let numerator = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
                (numerator / (1.0 + r2 * (k4 + r2 * (k5 + r2 * k6))), p1, p2)
            }
        };
        (
            x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        )
    }
}

const MAX_UNDISTORT_ITERATIONS: usize = 100;
