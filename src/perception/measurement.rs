//! What one frame says about one object.

use super::{Side, SymmetryPlane};
use crate::geometry::{Ellipsoid, FaceEvidence, Outline, Plane};
use nalgebra::SMatrix;
use thiserror::Error;

/// An ellipsoid estimated from one RGB-D frame and one box.
#[derive(Clone, Debug)]
pub struct EllipsoidMeasurement {
    /// In the camera's optical frame; upright, z up.
    pub ellipsoid: Ellipsoid,
    /// Covariance of `[rotation, translation, log semi-axes]`, a right perturbation in the object's frame.
    pub covariance: SMatrix<f64, 9, 9>,
    /// How the faces -x, +x, -y, +y, -z, +z are known.
    pub sides: [Side; 6],
    /// Where they are as far as this frame shows them, from the ellipsoid's centre along its own axes. The ellipsoid and its
    /// covariance have guesses for what was not seen, this has bounds.
    pub faces: [FaceEvidence; 6],
    /// Whether the left, upper, right and lower side of the box are where the object ends before what is behind it:
    /// neither hidden by something nearer nor cut by the image.
    pub silhouette: [bool; 4],
    /// What the object's class fills its extents with.
    pub outline: Outline,
    /// The paper's probabilities.
    pub probability: Probability,
    /// Mirror planes in the camera frame, if any found support in the depth image.
    pub symmetry: Vec<SymmetryPlane>,
    /// The plane the object stands on, in the camera frame.
    pub support: Option<Plane>,
    /// Points of the object that were used.
    pub points: usize,
}

/// Liao et al. 2020, eq. (9) and its parts, each in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probability {
    /// `P_det`: the detector's.
    pub detection: f64,
    /// `P_sym`: how well the mirrored points agree with the depth image.
    pub symmetry: f64,
    /// `P_fit`: how well the outline fits the completed points.
    pub fit: f64,
}

impl Probability {
    /// `P_e = P_det P_sym P_fit`. Liao et al. 2020, eq. (9).
    pub fn combined(&self) -> f64 {
        self.detection * self.symmetry * self.fit
    }
}

/// Why a box gave no ellipsoid. This is ordinary data, not a failure.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Refused {
    /// The box does not overlap the image.
    #[error("the box lies outside the image")]
    OutsideImage,
    /// The box or the object in it has too few depth readings.
    #[error("{got} points where {needed} are needed")]
    TooFewPoints {
        /// Points found.
        got: usize,
        /// Points asked for.
        needed: usize,
    },
    /// All points belong to support planes or to walls.
    #[error("nothing stands out from the support planes and walls")]
    NoCluster,
    /// The cluster at the box goes on far outside it: something in front of the object, or behind it.
    #[error("{:.0} % of the points lie outside the box", 100.0 * outside)]
    GoesOnOutsideBox {
        /// Share of the points outside the box.
        outside: f64,
    },
    /// The cluster fills too little of the box to be the object.
    #[error("the points fill only {:.0} % of the box", 100.0 * overlap)]
    FillsTooLittle {
        /// Intersection over union of the box and the points' extent in the image.
        overlap: f64,
    },
    /// What was taken for the object reaches out of the box where nothing hides it.
    #[error("it would reach out of the box by {:.0} % of the box", 100.0 * share)]
    LargerThanBox {
        /// How far it goes on outside, as a share of the box.
        share: f64,
    },
    /// The outline of the object is cut or hidden nearly everywhere.
    #[error("only {known} of the 4 upright sides can be told")]
    TooLittleSeen {
        /// Upright faces whose position is known.
        known: usize,
    },
}

impl Refused {
    /// A short key for counting.
    pub fn reason(&self) -> &'static str {
        match self {
            Self::OutsideImage => "outside_image",
            Self::TooFewPoints { .. } => "too_few_points",
            Self::NoCluster => "no_cluster",
            Self::GoesOnOutsideBox { .. } => "goes_on_outside_box",
            Self::FillsTooLittle { .. } => "fills_too_little",
            Self::LargerThanBox { .. } => "larger_than_box",
            Self::TooLittleSeen { .. } => "too_little_seen",
        }
    }
}
