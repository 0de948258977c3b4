//! An object that a detector has measured in space.

use super::{DetectionError, detection::most_probable_first};
use crate::geometry::Pose;
use nalgebra::Vector3;

/// A detector's box in space, or only the place of an object.
#[derive(Clone, Debug, PartialEq)]
pub struct Detection3d {
    /// The frame in which it is.
    pub frame_id: String,
    /// Its pose in that frame.
    pub frame_from_object: Pose,
    /// Full extents along its own axes (m); nothing where only its place is known.
    pub extents_m: Option<Vector3<f64>>,
    /// Class names with probabilities in (0, 1], most probable first; never empty.
    hypotheses: Vec<(String, f64)>,
}

impl Detection3d {
    /// A detection from what is said of it; hypotheses are class names with probabilities in any order.
    ///
    /// # Errors
    /// When its frame has no name, its pose is not finite, an extent is below zero, zero or not finite, or no hypothesis has a name and a
    /// probability in (0, 1].
    pub fn new(
        frame_id: String,
        frame_from_object: Pose,
        extents_m: Option<Vector3<f64>>,
        hypotheses: Vec<(String, f64)>,
    ) -> Result<Self, DetectionError> {
        if frame_id.is_empty() {
            return Err(DetectionError::NoFrame);
        }
        let at = frame_from_object.translation.vector;
        if !at.iter().all(|x| x.is_finite() && x.abs() < FAR_M)
            || !frame_from_object.rotation.coords.iter().all(|x| x.is_finite())
        {
            return Err(DetectionError::BadPlace);
        }
        let is_extent = |extent: &f64| extent.is_finite() && *extent > 0.0 && *extent < FAR_M;
        if !extents_m.iter().flatten().all(is_extent) {
            return Err(DetectionError::BadExtents);
        }
        let hypotheses = most_probable_first(hypotheses)?;
        Ok(Self { frame_id, frame_from_object, extents_m, hypotheses })
    }

    /// The most probable class.
    pub fn label(&self) -> &str {
        &self.hypotheses[0].0
    }

    /// Probability of [`Detection3d::label`].
    pub fn probability(&self) -> f64 {
        self.hypotheses[0].1
    }

    /// All classes with their probabilities, most probable first.
    pub fn hypotheses(&self) -> &[(String, f64)] {
        &self.hypotheses
    }
}

/// Nothing indoors is so far off or so large (m).
const FAR_M: f64 = 1e4;
