//! The outline a class of objects has inside its extents.

use thiserror::Error;

/// The shape that fills an object's extents: semi-axes are always half extents, whatever the outline.
///
/// All are superquadrics (Barr 1981) with the exponents of [`Outline::exponents`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outline {
    /// The paper's model.
    Ellipsoid,
    /// Most furniture.
    Cuboid,
    /// An upright cylinder.
    Cylinder,
    /// Anything between, by exponents `e1` (profile) and `e2` (footprint) in `[0.1, 1]`.
    Superquadric(f64, f64),
}

/// Why exponents are not an outline.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum OutlineError {
    /// Outside the range in which the outline is convex and well conditioned.
    #[error("superquadric exponents ({e1}, {e2}) are not between 0.1 and 1")]
    Exponents {
        /// Profile exponent.
        e1: f64,
        /// Footprint exponent.
        e2: f64,
    },
}
