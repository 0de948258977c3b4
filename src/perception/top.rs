//! What carries things is as wide as its top: tables stand behind chairs, and below the top there are legs.

use super::{
    ClassPrior, Frame, SegmentationSettings, Side, SupportPlane,
    crop::Crop,
    faces::Faces,
    segmentation::{Segment, SurfacePoint},
};
use crate::geometry::Rect;
use std::borrow::Cow;

/// Whether a plane is seen in the upper part of a box: what an object carries has a box of its own, so its top is there.
/// The seats of the chairs before a table are lower.
pub(super) fn reaches_upper_side(plane: &SupportPlane, rect: &Rect) -> bool {
    let is_between = |u: i32| (rect.x_min..=rect.x_max).contains(&f64::from(u));
    plane.inliers.iter().any(|p| is_between(p.u) && is_in_upper_part(p.v, rect))
}

fn is_in_upper_part(v: i32, rect: &Rect) -> bool {
    (rect.y_min..=rect.y_min + UPPER_SHARE * rect.height()).contains(&f64::from(v))
}

/// The points of a crop that are a part of the top of what carries things, where all that is in its box makes no object:
/// chairs stand before a table, and between them one sees a corner of its top, a leg, and the room behind. Of upright things
/// every height is seen alike, of a level top many points at one; and what an object carries has a box of its own, so that its
/// top is what is highest in the box.
pub(super) fn part_of_top<'a>(
    (frame, planes): (&Frame<'_>, &'a [SupportPlane]),
    crop: &Crop,
    prior: &ClassPrior,
    settings: &SegmentationSettings,
) -> Option<Segment<'a>> {
    let [_, _, usual_m] = prior.size_m.filter(|_| prior.carries)?;
    let floor = planes.iter().max_by(|a, b| a.plane.offset.total_cmp(&b.plane.offset))?;
    let is_as_high =
        |p: &&SurfacePoint| (floor.height_of(&p.at) / usual_m).ln().abs() < HEIGHT_SPREAD;
    let inside = crop.points.iter().filter(|p| p.is_in(&crop.rect));
    let mut points: Vec<SurfacePoint> = inside.filter(is_as_high).copied().collect();
    points.sort_by(|a, b| a.at.z.total_cmp(&b.at.z));
    let lowest_m = points.first()?.at.z;
    let spread_m = points.last()?.at.z - lowest_m;
    let end = |first: usize| points.partition_point(|p| p.at.z < points[first].at.z + LEVEL_M);
    let first = (0..points.len()).max_by_key(|first| end(*first) - first)?;
    let (count, above) = (end(first) - first, points.len() - end(first));
    let upright = (points.len() - count) as f64 * LEVEL_M / (spread_m - LEVEL_M).max(LEVEL_M);
    let is_level = count as f64 > LEVEL_SHARE * upright && count > HIGHEST_SHARE * above;
    let top = &points[first..first + count];
    if !is_level || !top.iter().any(|p| is_in_upper_part(p.v, &crop.rect)) {
        return None;
    }
    let top = crop.main_cluster(top, settings)?;
    let is_enough = top.len() >= crop.samples(settings.min_points / PART);
    is_enough.then(|| Segment { is_part_of_top: true, ..crop.segment(frame, top, Some(floor)) })
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
/// Tops are as high as usual up to this much (logarithm).
const HEIGHT_SPREAD: f64 = 0.15;
/// Points of a top differ in height by no more than this (m).
const LEVEL_M: f64 = 0.04;
/// A top has so many times the points that upright things have at its height,
const LEVEL_SHARE: f64 = 2.0;
/// and at least this many times those that are higher.
const HIGHEST_SHARE: usize = 4;
/// Of a part of a top, so much fewer points are enough.
const PART: usize = 4;
