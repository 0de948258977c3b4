//! What carries things is as wide as its top: tables stand behind chairs, and below the top there are legs.

use super::{
    ClassPrior, Side, SupportPlane,
    faces::Faces,
    segmentation::{Segment, SurfacePoint},
};
use crate::geometry::Rect;
use std::borrow::Cow;

/// Whether a plane is seen in the upper part of a box: what an object carries has a box of its own, so its top is there.
/// The seats of the chairs before a table are lower.
pub(super) fn reaches_upper_side(plane: &SupportPlane, rect: &Rect) -> bool {
    let upper = Rect { y_max: rect.y_min + UPPER_SHARE * rect.height(), ..*rect };
    plane.inliers.iter().any(|p| upper.contains(f64::from(p.u), f64::from(p.v)))
}

impl Segment<'_> {
    /// The points that tell how far it reaches: of what carries things those of its top.
    pub(super) fn widest(&self, prior: &ClassPrior) -> Cow<'_, [SurfacePoint]> {
        if !prior.carries {
            return Cow::Borrowed(&self.points);
        }
        let top_m = self.points.iter().map(|p| p.at.z).fold(f64::MIN, f64::max);
        self.points.iter().filter(|p| p.at.z > top_m - TOP_M).copied().collect()
    }
}

impl Faces {
    /// Whether the top of what carries things was not seen: the wall behind a table is, below its top.
    pub(super) fn lacks_its_top(&self, prior: &ClassPrior) -> bool {
        prior.carries && self.faces[5].side != Side::Seen
    }
}

/// How far down a box its upper part reaches, as a share of its height.
const UPPER_SHARE: f64 = 0.25;
/// A top is no thicker than this (m).
const TOP_M: f64 = 0.05;
