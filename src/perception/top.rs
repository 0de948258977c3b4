//! What carries things is as wide as its top: tables stand behind chairs, and below the top there are legs.

use super::{
    ClassPrior, Frame, Side, Sight, SupportPlane,
    faces::{Faces, outward},
    footprint::quantile,
    segmentation::{Segment, SurfacePoint},
    silhouette::BoxSide,
};
use crate::geometry::Rect;
use nalgebra::Vector3;
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

    /// Beyond each upright face, how far the object may reach at most (m): no farther beyond one that is known; infinite
    /// where nothing limits it.
    ///
    /// A top goes on level until the object ends. Where it would be in front of what was measured, the object has ended, even
    /// if what hides the end itself is nearer: a table between two chairs does not reach past them. Of what has no top,
    /// one does not know how it goes on.
    pub(super) fn room_m(
        &self,
        frame: &Frame<'_>,
        segment: &Segment<'_>,
        prior: &ClassPrior,
    ) -> [f64; 4] {
        let points = segment.widest(prior);
        let every = points.len().div_ceil(MAX_LOOKS).max(1);
        let bound = BoxSide::widened(&segment.rect);
        std::array::from_fn(|i| {
            let face = self.faces[i];
            if face.side.is_known() {
                return 0.0;
            }
            if !prior.carries {
                return f64::INFINITY;
            }
            let outward = outward(self.yaw, i);
            let room_m = |p: &SurfacePoint| {
                let to_end_m = (face.position_m - p.at.coords.dot(&outward)).max(0.0);
                let mut steps = (1..=STEPS).map(|step| STEP_M * f64::from(step));
                let ended = steps.find(|m| has_ended(p, outward * (to_end_m + m), frame, &bound));
                ended.unwrap_or(f64::INFINITY)
            };
            let mut rooms_m: Vec<f64> = points.iter().step_by(every).map(room_m).collect();
            quantile(&mut rooms_m, LIMITING_SHARE)
        })
    }
}

/// Whether the camera looks through where a top would be if it went on so far from one of its points, or sees nothing there
/// outside the object's box `bound`: what is behind is out of range.
fn has_ended(from: &SurfacePoint, by: Vector3<f64>, frame: &Frame<'_>, bound: &Rect) -> bool {
    let at = from.at + by;
    match frame.look_at(&at) {
        Sight::Measured { beyond_m } => {
            // At a grazing angle, a surface that is off by a degree is soon seen far behind itself.
            let below_m = beyond_m * at.z.abs() / at.coords.norm();
            beyond_m > FREE_M + 3.0 * from.sigma_m && below_m > OFF_M + OFF_SLOPE * by.norm()
        }
        Sight::NoReading => {
            frame.project(&at).is_some_and(|(_, pixel)| !bound.contains(pixel.x, pixel.y))
        }
        Sight::Outside => false,
    }
}

/// How far down a box its upper part reaches, as a share of its height.
const UPPER_SHARE: f64 = 0.25;
/// A top is no thicker than this (m).
const TOP_M: f64 = 0.05;
/// Points that are looked at.
const MAX_LOOKS: usize = 60;
/// How finely space is looked through (m), and in how many steps.
const STEP_M: f64 = 0.05;
const STEPS: u32 = 40;
/// Where the camera sees this much farther than a point, there is nothing at the point (m),
const FREE_M: f64 = 0.1;
/// if what it sees is this far below the top (m), and this much more for each metre that the top was continued.
const OFF_M: f64 = 0.03;
const OFF_SLOPE: f64 = 0.02;
/// So large a share of the top has to end for the object to end.
const LIMITING_SHARE: f64 = 0.25;
