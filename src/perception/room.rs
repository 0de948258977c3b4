//! How far an object can reach where its end was not seen: not into a wall, and a top not past where one looks through it.

use super::{
    ClassPrior, Frame, Sight, WallSegment,
    faces::{Faces, outward},
    footprint::quantile,
    segmentation::{Segment, SurfacePoint},
    silhouette::BoxSide,
};
use crate::geometry::Rect;
use nalgebra::{Point3, Vector3};

impl Faces {
    /// Beyond each upright face, how far the object may reach at most (m): no farther beyond one that is known; infinite
    /// where nothing limits it.
    ///
    /// A top goes on level until the object ends. Where it would be in front of what was measured, the object has ended, even
    /// if what hides the end itself is nearer: a table between two chairs does not reach past them. Of what has no top,
    /// one knows only that it ends at the wall.
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
            let before_wall_m = self.before_wall_m(segment, i, &outward);
            if !prior.carries {
                return before_wall_m;
            }
            let room_m = |p: &SurfacePoint| {
                let to_end_m = (face.position_m - p.at.coords.dot(&outward)).max(0.0);
                let mut steps = (1..=STEPS).map(|step| STEP_M * f64::from(step));
                let ended = steps.find(|m| has_ended(p, outward * (to_end_m + m), frame, &bound));
                ended.unwrap_or(f64::INFINITY)
            };
            let mut rooms_m: Vec<f64> = points.iter().step_by(every).map(room_m).collect();
            quantile(&mut rooms_m, LIMITING_SHARE).min(before_wall_m)
        })
    }

    /// How far it is from the middle of upright face `i` to the next wall (m); infinite where none is seen.
    fn before_wall_m(&self, segment: &Segment<'_>, i: usize, outward: &Vector3<f64>) -> f64 {
        let center = Point3::from(self.pose().translation.vector);
        let middle = center + outward * (0.5 * self.extent_m(i / 2));
        let distances = segment.walls.iter().filter_map(|wall| {
            // Few walls are in the way, and only of those all points have to be looked at.
            wall.distance_along_m(&middle, outward).filter(|_| !is_taken_for(segment, wall))
        });
        distances.fold(f64::INFINITY, f64::min)
    }
}

/// Whether a wall is nothing but what was seen of the object: the back of a couch, the doors of a wardrobe.
fn is_taken_for(segment: &Segment<'_>, wall: &WallSegment) -> bool {
    let before = segment.points.iter().filter(|p| wall.before_m(&p.at) > ITSELF_M).count();
    (before as f64) < BEFORE_SHARE * segment.points.len() as f64
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

/// What is nearer to a wall than this is a part of it (m),
const ITSELF_M: f64 = 0.1;
/// and the wall is another thing if at least this share of the object is before it.
const BEFORE_SHARE: f64 = 0.3;
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
