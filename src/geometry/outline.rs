//! The outline a class of objects has inside its extents.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// The shape that fills an object's extents: semi-axes are half extents, whatever the outline.
///
/// All are superquadrics (Barr 1981) or their limits: an ellipsoid has exponents (1, 1), a cuboid is the limit
/// (0, 0), an upright cylinder (0, 1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outline {
    /// The paper's model.
    Ellipsoid,
    /// Most furniture.
    #[default]
    Cuboid,
    /// Upright, with an elliptic footprint.
    Cylinder,
    /// By exponents `e1` (profile) in `(0, 1]` and `e2` (footprint) in `(0, 2)`: anything between, and footprints
    /// from the ellipse at 1 on towards the rhombus at 2.
    Superquadric(f64, f64),
}

impl Outline {
    /// Whether its footprint is an ellipse, or has points where its axes end: it has no vertical faces.
    pub fn is_round(self) -> bool {
        match self {
            Self::Ellipsoid | Self::Cylinder => true,
            Self::Cuboid => false,
            Self::Superquadric(_, footprint) => footprint >= 1.0,
        }
    }

    /// How far out a point is: 1 on the surface, proportional to the distance from the centre along its ray.
    ///
    /// `scaled` is the point in the object's frame, divided by the semi-axes. For an ellipsoid, `F` of Liao et
    /// al. 2020, eq. (6) is `radius^2 - 1`.
    pub fn radius(self, scaled: &Vector3<f64>) -> f64 {
        let a = scaled.abs();
        match self {
            Self::Ellipsoid => a.norm(),
            Self::Cuboid => a.max(),
            Self::Cylinder => a.x.hypot(a.y).max(a.z),
            Self::Superquadric(e1, e2) => {
                let footprint = (a.x.powf(2.0 / e2) + a.y.powf(2.0 / e2)).powf(e2 / e1);
                (footprint + a.z.powf(2.0 / e1)).powf(0.5 * e1)
            }
        }
    }
}

/// Where a convex body ends in a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Support {
    /// The support function: the largest `direction · x` of all points `x` of the body.
    pub reach: f64,
    /// A point of the body that reaches it, in the body's own frame (m). Where a whole edge or face does, its middle.
    pub contact: Vector3<f64>,
}

impl Outline {
    /// How far the body reaches from its centre along `direction`, which is in its own frame and of any length.
    ///
    /// The support function of a superquadric is the dual of the norm in [`Outline::radius`]: its exponents `2/e`
    /// become `2/(2-e)`. So it is a sum for a cuboid and a Euclidean norm for an ellipsoid. The derivative by the
    /// direction is `contact`, the derivative by the logarithm of a semi-axis is the direction times `contact` along
    /// that axis.
    pub fn support(self, direction: &Vector3<f64>, semi_axes: &Vector3<f64>) -> Support {
        let scaled = direction.component_mul(semi_axes);
        let (reach, slopes) = self.dual_norm(&scaled);
        Support { reach, contact: slopes.component_mul(semi_axes) }
    }

    /// The dual norm of a vector and its derivative.
    fn dual_norm(self, v: &Vector3<f64>) -> (f64, Vector3<f64>) {
        let tie = TIE * v.amax();
        match self {
            Self::Ellipsoid => {
                let norm = v.norm();
                (norm, if norm > 0.0 { v / norm } else { Vector3::zeros() })
            }
            Self::Cuboid => {
                (v.x.abs() + v.y.abs() + v.z.abs(), v.map(|component| sign(component, tie)))
            }
            Self::Cylinder => {
                let (radius, [x, y]) = circle_norm(v.x, v.y);
                let footprint = sign(radius, tie);
                (radius + v.z.abs(), Vector3::new(footprint * x, footprint * y, sign(v.z, tie)))
            }
            Self::Superquadric(e1, e2) => {
                let (radius, [x, y]) = power_norm(v.x, v.y, 2.0 / (2.0 - e2));
                let (norm, [footprint, z]) = power_norm(radius, v.z, 2.0 / (2.0 - e1));
                (norm, Vector3::new(footprint * x, footprint * y, z))
            }
        }
    }
}

/// `(|a|^p + |b|^p)^(1/p)` and its derivative, for `p` greater than 1.
fn power_norm(a: f64, b: f64, p: f64) -> (f64, [f64; 2]) {
    let (size_a, size_b) = (a.abs(), b.abs());
    let (largest, smallest) = (size_a.max(size_b), size_a.min(size_b));
    if largest == 0.0 {
        return (0.0, [0.0; 2]);
    }
    // Of the terms, divided by the largest, only the other one is not 1.
    let share = (smallest / largest).powf(p);
    let sum = 1.0 + share;
    let norm = sum.powf(1.0 / p);
    let steep = norm / sum;
    let flat = if smallest > 0.0 { share * (largest / smallest) * steep } else { 0.0 };
    let (slope_a, slope_b) = if size_a >= size_b { (steep, flat) } else { (flat, steep) };
    (largest * norm, [slope_a * a.signum(), slope_b * b.signum()])
}

/// `(a^2 + b^2)^(1/2)` and its derivative.
fn circle_norm(a: f64, b: f64) -> (f64, [f64; 2]) {
    let norm = (a * a + b * b).sqrt();
    (norm, if norm > 0.0 { [a / norm, b / norm] } else { [0.0; 2] })
}

/// The sign, or 0 where only rounding gives one: then a whole edge or face reaches equally far.
fn sign(value: f64, tie: f64) -> f64 {
    if value.abs() <= tie { 0.0 } else { value.signum() }
}

/// Share of the largest component that is rounding.
const TIE: f64 = 1e-9;
