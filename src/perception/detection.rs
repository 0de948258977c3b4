//! A detector's 2D box.

use super::Mask;
use crate::geometry::Rect;
use thiserror::Error;

/// One box of a 2D detector, in pixels of the image it was detected in.
#[derive(Clone, Debug, PartialEq)]
pub struct Detection {
    /// The box; it may reach beyond the image, but not lie outside it.
    pub rect: Rect,
    /// Identity of what it shows, where a tracker or a simulator gives one; a plain detector does not.
    pub track: Option<u64>,
    /// Which pixels of the box are the object, where the detector says it.
    pub mask: Option<Mask>,
    /// Class names with probabilities in (0, 1], most probable first; never empty.
    hypotheses: Vec<(String, f64)>,
}

/// Why numbers are not a detection.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DetectionError {
    /// A side is not finite, or the box is inverted or empty.
    #[error("the box is inverted, empty or not finite")]
    BadBox,
    /// No class, or no probability in (0, 1].
    #[error("the detection names no class with a probability between 0 and 1")]
    NoClass,
    /// Of a detection in space: no frame.
    #[error("the detection does not say in which frame it is")]
    NoFrame,
    /// Of a detection in space: a pose that is none.
    #[error("the place of the detection is not finite, or out of this world")]
    BadPlace,
    /// Of a detection in space: a size that is none.
    #[error("an extent of the detection is not finite, or not above zero")]
    BadExtents,
}

impl Detection {
    /// A detection from its box and its class hypotheses in any order, without an identity and a mask.
    ///
    /// # Errors
    /// When no hypothesis has a name and a probability in (0, 1].
    pub fn new(rect: Rect, hypotheses: Vec<(String, f64)>) -> Result<Self, DetectionError> {
        let hypotheses = most_probable_first(hypotheses)?;
        Ok(Self { rect, track: None, mask: None, hypotheses })
    }

    /// Keeps the most probable names; how many it had besides.
    pub fn keep_names(&mut self, most: usize) -> usize {
        let more = self.hypotheses.len().saturating_sub(most.max(1));
        self.hypotheses.truncate(most.max(1));
        more
    }

    /// The most probable class.
    pub fn label(&self) -> &str {
        &self.hypotheses[0].0
    }

    /// Probability of [`Detection::label`], the paper's `P_det`.
    pub fn probability(&self) -> f64 {
        self.hypotheses[0].1
    }

    /// All classes with their probabilities, most probable first.
    pub fn hypotheses(&self) -> &[(String, f64)] {
        &self.hypotheses
    }
}

/// Class names with probabilities in (0, 1].
pub(super) fn most_probable_first(
    mut hypotheses: Vec<(String, f64)>,
) -> Result<Vec<(String, f64)>, DetectionError> {
    hypotheses.retain(|(name, p)| !name.is_empty() && *p > 0.0 && *p <= 1.0);
    hypotheses.sort_by(|a, b| b.1.total_cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    if hypotheses.is_empty() { Err(DetectionError::NoClass) } else { Ok(hypotheses) }
}
