//! How far an object can go on behind what hides it: not into space that the camera looks through.

use super::{
    ClassPrior, Frame, Sight,
    faces::{Faces, outward},
    footprint::quantile,
    segmentation::{Segment, SurfacePoint},
    silhouette::BoxSide,
};
use crate::geometry::Rect;
use nalgebra::{Unit, Vector3};

impl Faces {
    /// Beyond each upright face, how far the object may reach at most (m); infinite where nothing limits it.
    ///
    /// A surface that was seen goes on as it is until the object ends. Where it would be in front of what was measured, the
    /// object has ended, even if what hides the end itself is nearer: a table top between two chairs does not reach past them.
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
            let outward = outward(self.yaw, i);
            let mut ends: Vec<f64> = (points.iter().step_by(every))
                .map(|p| {
                    let normal = if prior.carries { Some(Vector3::z_axis()) } else { p.normal };
                    let surface = Surface { last: p, normal, outward };
                    let to_end_m = (face.position_m - p.at.coords.dot(&outward)).max(0.0);
                    let steps = (1..=STEPS).map(|step| STEP_M * f64::from(step));
                    let mut free =
                        steps.filter(|room_m| surface.has_ended(to_end_m + room_m, frame, &bound));
                    free.next().unwrap_or(f64::INFINITY)
                })
                .collect();
            quantile(&mut ends, LIMITING_SHARE)
        })
    }
}

/// A surface that goes on from where it was seen.
struct Surface<'a> {
    last: &'a SurfacePoint,
    normal: Option<Unit<Vector3<f64>>>,
    outward: Vector3<f64>,
}

impl Surface<'_> {
    /// Whether the camera looks through where it would be `along_m` farther, or sees nothing there outside the object's box
    /// `bound`: what is behind is out of range.
    fn has_ended(&self, along_m: f64, frame: &Frame<'_>, bound: &Rect) -> bool {
        let at = self.last.at + self.outward * along_m;
        match frame.look_at(&at) {
            Sight::Measured { beyond_m } => {
                // At a grazing angle, a surface that is off by a degree is soon seen far behind itself.
                let range_m = at.coords.norm();
                let facing = self.normal.map_or(range_m, |n| n.dot(&at.coords).abs()) / range_m;
                beyond_m > FREE_M + 3.0 * self.last.sigma_m
                    && beyond_m * facing > OFF_M + OFF_SLOPE * along_m
            }
            Sight::NoReading => {
                frame.project(&at).is_some_and(|(_, pixel)| !bound.contains(pixel.x, pixel.y))
            }
            Sight::Outside => false,
        }
    }
}

/// Points that are looked at.
const MAX_LOOKS: usize = 60;
/// How finely space is looked through (m), and in how many steps.
const STEP_M: f64 = 0.05;
const STEPS: u32 = 40;
/// Where the camera sees this much farther than a point, there is nothing at the point (m),
const FREE_M: f64 = 0.1;
/// if what it sees is this far off the surface (m), and this much more for each metre that the surface was continued.
const OFF_M: f64 = 0.03;
const OFF_SLOPE: f64 = 0.02;
/// So large a share of the surface has to end for the object to end.
const LIMITING_SHARE: f64 = 0.25;
