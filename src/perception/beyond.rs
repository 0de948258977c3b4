//! What is past the end of what was seen of an object: nothing, more of the same surface, or something else.

use super::{
    Frame, Side, Sight,
    faces::sample_step_m,
    segmentation::{Segment, SurfacePoint},
};
use nalgebra::{Point3, Vector3};

/// What is past an end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beyond {
    /// How the face there is known.
    pub(super) side: Side,
    /// How much farther the object may reach where it ends at a wall (m).
    pub(super) gap_m: f64,
    /// Whether readings are missing next to much of it.
    pub(super) is_ragged: bool,
}

/// Looks past the outermost points.
pub(super) fn what_lies_beyond(
    frame: &Frame<'_>,
    segment: &Segment<'_>,
    rim: &[&SurfacePoint],
    outward: &Vector3<f64>,
) -> Beyond {
    let (mut free, mut against, mut surface, mut hidden) = (0, 0, 0, 0);
    let (mut gaps_m, mut ragged) = (0.0, 0);
    let every = rim.len().div_ceil(MAX_LOOKS).max(1);
    let looks = rim.iter().step_by(every);
    let total = looks.len();
    let top_m = segment.points.iter().map(|p| p.at.z).fold(f64::MIN, f64::max);
    let end = End { frame, outward, top_m };
    for p in looks {
        let step = (2.0 * sample_step_m(segment, p, outward)).max(4.0 * p.sigma_m).max(0.02);
        for reach in 1..=MAX_REACH {
            let beyond = p.at + outward * (step * f64::from(reach));
            let sight = frame.look_at(&beyond);
            ragged += usize::from(reach == 1 && matches!(sight, Sight::NoReading));
            match sight {
                Sight::Outside => break,
                // Kinect casts shadows of missing depth beside every edge: look further. If nothing comes there, but the
                // box has ended, what is behind is out of range.
                Sight::NoReading if reach < MAX_REACH => continue,
                Sight::NoReading => free += usize::from(is_outside_box(frame, segment, &beyond)),
                Sight::Measured { beyond_m } if beyond_m > 0.5 * step => free += 1,
                Sight::Measured { beyond_m } => match end.wall_gap_m(p, &beyond, beyond_m) {
                    Some(gap_m) => {
                        against += 1;
                        gaps_m += gap_m;
                    }
                    None if beyond_m > -0.5 * step => surface += 1,
                    None => hidden += 1,
                },
            }
            break;
        }
    }
    let side = if 2 * (free + against) > total {
        Side::Seen
    } else if surface > hidden && 3 * surface > total {
        Side::Cut
    } else if 3 * free > total && free > 2 * hidden {
        Side::Seen
    } else {
        Side::Hidden
    };
    let is_against = side == Side::Seen && against > free;
    let gap_m = if is_against { gaps_m / against as f64 } else { 0.0 };
    Beyond { side, gap_m, is_ragged: RAGGED * ragged > total }
}

/// An end of an object.
struct End<'a> {
    frame: &'a Frame<'a>,
    outward: &'a Vector3<f64>,
    /// Height of the object's top (m).
    top_m: f64,
}

impl End<'_> {
    /// From the last point that was seen to a wall (m), if what is seen where a point beyond would be, `beyond_m` behind it,
    /// is one: there the object ends. Something that hides the end is in front of it, or does not go on above the object.
    fn wall_gap_m(&self, last: &SurfacePoint, beyond: &Point3<f64>, beyond_m: f64) -> Option<f64> {
        let (depth_m, _) = self.frame.project(beyond)?;
        let wall = beyond * (1.0 + beyond_m / depth_m);
        let gap = wall - last.at;
        let along_m = gap.dot(self.outward);
        let above = Point3::new(wall.x, wall.y, self.top_m + ABOVE_M);
        let rises = || match self.frame.look_at(&above) {
            Sight::Measured { beyond_m } => beyond_m.abs() < AGAINST_M,
            _ => false,
        };
        let is_upright = self.outward.z == 0.0;
        (is_upright && along_m > 0.0 && gap.norm() < AGAINST_M && rises()).then_some(along_m)
    }
}

fn is_outside_box(frame: &Frame<'_>, segment: &Segment<'_>, point: &Point3<f64>) -> bool {
    frame.project(point).is_some_and(|(_, pixel)| !segment.rect.contains(pixel.x, pixel.y))
}

const MAX_LOOKS: usize = 80;
const MAX_REACH: u32 = 3;
/// An end is ragged where no reading is next to one in so many of its points.
const RAGGED: usize = 4;
/// An object may touch a wall that is no farther than this from the last point that was seen (m).
const AGAINST_M: f64 = 0.15;
/// Walls are higher than what stands against them by more than this (m).
const ABOVE_M: f64 = 0.3;
