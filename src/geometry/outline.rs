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
    /// Anything between, by exponents `e1` (profile) and `e2` (footprint) in `(0, 1]`.
    Superquadric(f64, f64),
}

impl Outline {
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
