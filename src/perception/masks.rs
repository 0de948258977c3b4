//! What the masks of an image leave to each of its boxes.

use super::{
    Detection, Frame, Mask,
    mask::{BORDER_PX, BORDER_SHARE},
    segmentation::SurfacePoint,
};

/// The masks of an image's boxes, in order.
pub(super) struct Masks<'a> {
    frame: &'a Frame<'a>,
    of_boxes: Vec<Option<OfBox<'a>>>,
}

/// A mask, whose border is drawn inexactly.
struct OfBox<'a> {
    mask: &'a Mask,
    /// What is inside all the same,
    at_least: Mask,
    /// and all that may be inside.
    at_most: Mask,
    border_px: i32,
}

impl<'a> Masks<'a> {
    pub(super) fn new(frame: &'a Frame<'a>, detections: &'a [Detection]) -> Self {
        let of_box = |detection: &'a Detection| {
            let mask = detection.mask.as_ref()?;
            let longer_px = detection.rect.width().max(detection.rect.height());
            let border_px = (BORDER_PX + BORDER_SHARE * longer_px).ceil();
            Some(OfBox {
                mask,
                at_least: mask.shrunk(border_px),
                at_most: mask.grown(border_px),
                border_px: border_px.min(MOST_PX) as i32,
            })
        };
        Self { frame, of_boxes: detections.iter().map(of_box).collect() }
    }

    /// Whether a point is not of the object of box `at`: outside of its mask, as far as borders are exact, or inside another's and
    /// not its own.
    pub(super) fn forbid(&self, at: usize, p: &SurfacePoint) -> bool {
        let is_in = |mask: &Mask| mask.contains(f64::from(p.u), f64::from(p.v));
        let is_others = || self.of_boxes.iter().flatten().any(|other| is_in(other.mask));
        match &self.of_boxes[at] {
            None => is_others(),
            Some(own) if is_in(&own.at_least) => false,
            Some(own) if is_in(own.mask) => own.is_behind(self.frame, p),
            Some(own) => {
                !is_in(&own.at_most)
                    || is_others()
                    || !own.goes_on(self.frame, p, &|u, v| own.mask.contains(u, v))
            }
        }
    }
}

impl OfBox<'_> {
    /// Whether a reading near the border of the mask is of a surface that goes on outside, and not of what is further inside.
    fn is_behind(&self, frame: &Frame<'_>, p: &SurfacePoint) -> bool {
        !self.goes_on(frame, p, &|u, v| self.at_least.contains(u, v))
            && self.goes_on(frame, p, &|u, v| !self.at_most.contains(u, v))
    }

    /// Whether some reading near by has about the same depth, in a part of the image.
    fn goes_on(
        &self,
        frame: &Frame<'_>,
        p: &SurfacePoint,
        is_part: &dyn Fn(f64, f64) -> bool,
    ) -> bool {
        let depth = |u: i32, v: i32| frame.depth().at(u, v).map(f64::from);
        let Some(own_m) = depth(p.u, p.v) else { return false };
        let tolerance_m = SAME_SURFACE_M + 4.0 * p.sigma_m;
        DIRECTIONS.iter().any(|(du, dv)| {
            (1..=2 * self.border_px).any(|px| {
                let (u, v) = (p.u + px * du, p.v + px * dv);
                is_part(u.into(), v.into())
                    && depth(u, v).is_some_and(|m| (m - own_m).abs() < tolerance_m)
            })
        })
    }
}

const DIRECTIONS: [(i32, i32); 8] =
    [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];
/// Readings of neighbouring pixels that differ by less, noise aside, are of one surface (m).
const SAME_SURFACE_M: f64 = 0.02;
/// No border is wider (px).
const MOST_PX: f64 = 30.0;
