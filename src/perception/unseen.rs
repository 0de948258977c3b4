//! What a depth camera cannot have seen of an object.

use super::{
    ClassPrior, Side,
    faces::{Face, Faces},
};
use crate::geometry::Outline;

impl Faces {
    /// Depth cameras see nothing of handles and leaves: where something round ends is less sure than where its points do.
    pub(super) fn allow_for_handles(&mut self, outline: Outline) {
        if outline.is_round() {
            let unseen_m = HANDLE_SHARE * self.extent_m(0).max(self.extent_m(1));
            for face in &mut self.faces[..4] {
                face.sigma_m = face.sigma_m.hypot(unseen_m);
            }
        }
    }

    /// Whether it is thinner along a horizontal axis than things of its usual size are: not all of the object.
    pub(super) fn is_sliver(&self, [_, short, _]: [f64; 3]) -> bool {
        (0..2).any(|axis| self.extent_m(axis) < SLIVER_SHARE * short)
    }

    /// Where none of the upright faces was seen, what was seen may be any part of the object, or something beside it:
    /// the standard deviation of where it is along either horizontal axis, besides that of its faces (m).
    pub(super) fn place_sigma_m(&self, prior: &ClassPrior) -> f64 {
        let is_seen = |face: &Face| matches!(face.side, Side::Seen | Side::Mirrored);
        match prior.size_m {
            Some([long, ..]) if !self.faces[..4].iter().any(is_seen) => long,
            _ => 0.0,
        }
    }
}

/// Handles and leaves reach this much farther, as a share of the width.
const HANDLE_SHARE: f64 = 0.1;
/// What is thinner than this share of the shorter usual extent is a sliver.
const SLIVER_SHARE: f64 = 0.25;
