//! What the detector's box says of where an object ends.
//!
//! Depth cameras see nothing of handles, leaves and table feet, or of what is out of their range; a detector does. Its
//! box bounds all that is visible, so the external cuboid of the true object reaches at least as far as each side of
//! the box. Where an estimate falls short of that, one of its faces lies farther out: the one that can explain it with
//! the least unusual size. The converse does not hold: a box ends where something else hides the object.

use super::{
    ClassPrior, Frame, Refused, Side,
    faces::{Face, Faces},
    segmentation::Segment,
};
use crate::geometry::{Outline, Rect};
use nalgebra::Point3;

impl Faces {
    /// Moves faces outwards until the estimate reaches all sides of the detector's box.
    pub(super) fn reach_box(
        &mut self,
        frame: &Frame<'_>,
        segment: &Segment<'_>,
        prior: &ClassPrior,
    ) {
        for _ in 0..2 {
            for side in BoxSide::ALL {
                if !segment.is_cut_by_image(side) {
                    self.reach_side(frame, segment, side, prior);
                }
            }
        }
    }

    /// Takes back what was guessed until the object stays in the box, wherever nothing hides what would be outside. What
    /// contradicts the box that much is no better known than by as much as was taken back.
    ///
    /// # Errors
    /// When the object does not stay in the box even so: it is not the one the detector means.
    pub(super) fn stay_in_box(
        &mut self,
        frame: &Frame<'_>,
        segment: &Segment<'_>,
        outline: Outline,
    ) -> Result<(), Refused> {
        let mut share = 0.0;
        for kept in [1.0, 0.75, 0.5, 0.25, 0.0] {
            let mut faces = *self;
            for face in faces.faces.iter_mut().filter(|f| !f.side.is_known()) {
                let taken_back_m = (1.0 - kept) * face.guessed_m;
                face.position_m -= taken_back_m;
                face.sigma_m = face.sigma_m.hypot(taken_back_m);
            }
            share = faces.share_outside(frame, segment, outline);
            if share < MAX_OUTSIDE {
                *self = faces;
                return Ok(());
            }
        }
        Err(Refused::LargerThanBox { share })
    }

    /// Whether the left, upper, right and lower side of the box stand out against what is behind.
    pub(super) fn silhouette(&self, frame: &Frame<'_>, segment: &Segment<'_>) -> [bool; 4] {
        [BoxSide::Left, BoxSide::Upper, BoxSide::Right, BoxSide::Lower].map(|side| {
            !segment.is_cut_by_image(side)
                && self.share_hidden_beyond(frame, segment, side) < MAX_HIDDEN
        })
    }

    /// Beside something nearer, a part of the object may be hidden that is higher than what was seen: the back rest of a chair of
    /// which one leg and the seat show. So it is where what was seen is much lower than things of its class are.
    pub(super) fn doubt_low_top(
        &mut self,
        frame: &Frame<'_>,
        segment: &Segment<'_>,
        prior: &ClassPrior,
    ) {
        let is_low = prior.size_m.is_some_and(|[_, _, m]| self.extent_m(2) < LOW_SHARE * m);
        let is_hidden = |side| self.share_hidden_beyond(frame, segment, side) > MOSTLY_HIDDEN;
        let top = self.faces[TOP].side;
        if is_low && top == Side::Seen && [BoxSide::Left, BoxSide::Right].into_iter().any(is_hidden)
        {
            self.faces[TOP].side = Side::Hidden;
        }
    }

    /// How much of what is just outside of this side of the box shows something nearer, behind which the object may go on.
    fn share_hidden_beyond(&self, frame: &Frame<'_>, segment: &Segment<'_>, side: BoxSide) -> f64 {
        let beyond_px = SILHOUETTE_SIGMAS * side.sigma_px(&segment.rect);
        side.share_hidden(frame, segment, beyond_px, self.depth_range_m())
    }

    /// Between the nearest and the farthest that the object may be, along the view (m).
    fn depth_range_m(&self) -> [f64; 2] {
        let (center, radius) = (self.pose().translation.vector.x, self.semi_axes_m().xy().norm());
        [center - radius, center + radius]
    }

    /// How far the outline goes on outside the box where it could be seen, as a share of the box.
    fn share_outside(&self, frame: &Frame<'_>, segment: &Segment<'_>, outline: Outline) -> f64 {
        let rect = &segment.rect;
        let depth = self.depth_range_m();
        let mut most = 0.0_f64;
        for side in BoxSide::ALL {
            // Which of its legs shows where a part of a top does, nobody knows.
            let is_unknown = segment.is_part_of_top && side == BoxSide::Lower;
            if is_unknown || segment.is_cut_by_image(side) {
                continue;
            }
            let Some(end) = self.projected(frame, side, outline) else { continue };
            let over_px = end - side.of(rect) - 2.0 * TELLING_SIGMAS * side.sigma_px(rect);
            if over_px > 0.0 && side.share_hidden(frame, segment, over_px, depth) < 0.5 {
                most = most.max(over_px / side.extent(rect));
            }
        }
        most
    }

    fn reach_side(
        &mut self,
        frame: &Frame<'_>,
        segment: &Segment<'_>,
        side: BoxSide,
        prior: &ClassPrior,
    ) {
        let rect = &segment.rect;
        let sigma_px = side.sigma_px(rect);
        let short_px =
            |faces: &Self| Some(side.of(rect) - faces.projected(frame, side, prior.outline)?);
        let Some(missing_px) = short_px(self) else { return };
        if missing_px < TELLING_SIGMAS * sigma_px {
            return;
        }
        let mut best: Option<(f64, usize, f64)> = None;
        let mut second = f64::INFINITY;
        for i in 0..6 {
            if self.faces[i].side == Side::Support {
                continue;
            }
            let Some(outward_m) = self.needed_m(i, missing_px, &short_px) else { continue };
            let cost = self.oddity(i, outward_m, prior);
            match best {
                Some((least, ..)) if cost >= least => second = second.min(cost),
                _ => {
                    second = best.map_or(second, |(least, ..)| least);
                    best = Some((cost, i, outward_m));
                }
            }
        }
        let Some((least, i, outward_m)) = best else { return };
        let ambiguity = (AMBIGUITY * (0.5 * (least - second)).exp()).max(OUTLINE_SHARE);
        let face = self.faces[i];
        let noise_m = outward_m * sigma_px / missing_px;
        let is_higher_part = i == TOP && face.side == Side::Seen;
        let (outward_m, spread_m) = if is_higher_part {
            self.higher_part(frame, segment, side, outward_m)
        } else {
            (outward_m, 0.0)
        };
        // Where something nearer is beside it, it reaches so far at least.
        let is_open = self.share_hidden_beyond(frame, segment, side) > MOSTLY_HIDDEN;
        let unknown_m = if face.side.is_known() { 0.0 } else { OPEN_SHARE * face.sigma_m };
        let open_m =
            if is_open { unknown_m.max(OPEN_EXTENT_SHARE * self.extent_m(i / 2)) } else { 0.0 };
        let own_m = noise_m.hypot(ambiguity * outward_m).hypot(MIN_SIGMA_M);
        self.faces[i] = Face {
            position_m: face.position_m + outward_m,
            sigma_m: own_m.hypot(open_m).hypot(spread_m),
            side: Side::Outline,
            guessed_m: 0.0,
            seen: face.seen,
        };
    }

    /// A part of the object is higher than the end of the top that was seen: the headboard of a bed, out of depth's range. It may be
    /// anywhere between the object's near and its far end, and is the higher the farther off it is. The mean way up to
    /// it, of which `least_m` is the least, and the standard deviation of that (m).
    fn higher_part(
        &self,
        frame: &Frame<'_>,
        segment: &Segment<'_>,
        side: BoxSide,
        least_m: f64,
    ) -> (f64, f64) {
        let (pose, half) = (self.pose(), self.semi_axes_m());
        let needed_m = |(x, y): (f64, f64)| {
            let out = |up_m: f64| {
                let at = pose * Point3::new(x * half.x, y * half.y, half.z + up_m);
                frame.project(&at).map(|(_, pixel)| side.outwards(pixel.x, pixel.y))
            };
            let from = out(least_m)?;
            let slope = (out(least_m + PROBE_M)? - from) / PROBE_M;
            (slope > 0.0).then(|| least_m + (side.of(&segment.rect) - from) / slope)
        };
        let most_m = CORNERS.into_iter().filter_map(needed_m).fold(least_m, f64::max);
        let range_m = (most_m - least_m).min(MAX_GROWTH * self.largest_extent_m());
        (least_m + 0.5 * range_m, range_m / 12.0_f64.sqrt())
    }

    /// How far face `i` has to go out for nothing to be missing; nothing when no reasonable distance does.
    fn needed_m(
        &self,
        i: usize,
        missing_px: f64,
        short_px: &impl Fn(&Self) -> Option<f64>,
    ) -> Option<f64> {
        let moved = |outward_m: f64| {
            let mut faces = *self;
            faces.faces[i].position_m += outward_m;
            faces
        };
        let most_m = MAX_GROWTH * self.largest_extent_m();
        let mut outward_m = 0.0;
        let mut missing = missing_px;
        // Newton's method; the projection is nearly linear.
        for _ in 0..4 {
            let slope = (missing - short_px(&moved(outward_m + PROBE_M))?) / PROBE_M;
            if slope * most_m < 0.5 * missing_px {
                return None;
            }
            outward_m = (outward_m + missing / slope).clamp(0.0, most_m);
            missing = short_px(&moved(outward_m))?;
        }
        (missing.abs() < 0.25 * missing_px && outward_m > 0.0).then_some(outward_m)
    }

    /// How unusual the object becomes when face `i` goes out.
    fn oddity(&self, i: usize, outward_m: f64, prior: &ClassPrior) -> f64 {
        let axis = i / 2;
        let (before, after) = (self.extent_m(axis), self.extent_m(axis) + outward_m);
        let growth = ((after / before).ln() / GROWTH_SPREAD).powi(2);
        let known = if self.faces[i].side.is_known() { KNOWN_COST } else { 0.0 };
        let unusual = prior.size_m.map_or(0.0, |size| {
            let usual = self.usual_extents_m(size)[axis];
            let off = |extent: f64| ((extent - usual) / (SIZE_SPREAD * usual)).powi(2);
            off(after) - off(before)
        });
        growth + known + unusual
    }

    fn largest_extent_m(&self) -> f64 {
        (0..3).map(|axis| self.extent_m(axis)).fold(0.0, f64::max)
    }

    /// The coordinate, growing outwards, of the outermost point of the outline towards a side of the image (px).
    fn projected(&self, frame: &Frame<'_>, side: BoxSide, outline: Outline) -> Option<f64> {
        let (pose, half) = (self.pose(), self.semi_axes_m());
        let ring: &[(f64, f64)] = if outline.is_round() { &CIRCLE } else { &CORNERS };
        let mut outermost = f64::MIN;
        for (x, y) in ring {
            for z in [-half.z, half.z] {
                let at = pose * Point3::new(x * half.x, y * half.y, z);
                let (depth, pixel) = frame.project(&at)?;
                if depth < MIN_DEPTH_M {
                    return None;
                }
                outermost = outermost.max(side.outwards(pixel.x, pixel.y));
            }
        }
        Some(outermost)
    }
}

/// A side of a box in the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BoxSide {
    Left,
    Right,
    Upper,
    Lower,
}

impl BoxSide {
    pub(super) const ALL: [Self; 4] = [Self::Left, Self::Right, Self::Upper, Self::Lower];

    /// The coordinate of a pixel that grows towards this side (px).
    pub(super) fn outwards(self, x: f64, y: f64) -> f64 {
        match self {
            Self::Left => -x,
            Self::Right => x,
            Self::Upper => -y,
            Self::Lower => y,
        }
    }

    /// Where the box ends, as [`BoxSide::outwards`] (px).
    pub(super) fn of(self, rect: &Rect) -> f64 {
        self.outwards(
            if self == Self::Left { rect.x_min } else { rect.x_max },
            if self == Self::Upper { rect.y_min } else { rect.y_max },
        )
    }

    /// The box with what a detector may have cut off.
    pub(super) fn widened(rect: &Rect) -> Rect {
        let by = |side: Self| TELLING_SIGMAS * side.sigma_px(rect);
        let (x, y) = (by(Self::Left), by(Self::Upper));
        Rect {
            x_min: rect.x_min - x,
            y_min: rect.y_min - y,
            x_max: rect.x_max + x,
            y_max: rect.y_max + y,
        }
    }

    /// Extent of the box across this side (px).
    fn extent(self, rect: &Rect) -> f64 {
        match self {
            Self::Left | Self::Right => rect.width(),
            Self::Upper | Self::Lower => rect.height(),
        }
    }

    fn sigma_px(self, rect: &Rect) -> f64 {
        BOX_SIGMA_PX.hypot(BOX_SIGMA_SHARE * self.extent(rect))
    }

    /// How much of the strip beyond this side, `over_px` wide, shows something nearer than `depth_m` or a surface that
    /// goes on where the object is, instead of what is behind or under it.
    fn share_hidden(
        self,
        frame: &Frame<'_>,
        segment: &Segment<'_>,
        over_px: f64,
        depth_m: [f64; 2],
    ) -> f64 {
        let rect = &segment.rect;
        let mut hidden = 0;
        for i in 0..PROBES {
            let along = (i as f64 + 0.5) / PROBES as f64;
            for out in [0.3, 0.7] {
                let out = side_px(over_px, out);
                let (x, y) = match self {
                    Self::Left => (rect.x_min - out, rect.y_min + along * rect.height()),
                    Self::Right => (rect.x_max + out, rect.y_min + along * rect.height()),
                    Self::Upper => (rect.x_min + along * rect.width(), rect.y_min - out),
                    Self::Lower => (rect.x_min + along * rect.width(), rect.y_max + out),
                };
                let on_support = |at: &Point3<f64>| {
                    segment.support.is_some_and(|s| s.height_of(at) < SUPPORT_MARGIN_M)
                };
                match frame.point_in_level(x as i32, y as i32) {
                    Some(at) if at.x < depth_m[0] => hidden += 1,
                    Some(at) if at.x < depth_m[1] && !on_support(&at) => hidden += 1,
                    _ => (),
                }
            }
        }
        f64::from(hidden) / (2 * PROBES) as f64
    }
}

fn side_px(over_px: f64, share: f64) -> f64 {
    2.0 + share * over_px
}

const PROBES: usize = 12;
/// Beyond a side that is a silhouette no more than this share is hidden,
const MAX_HIDDEN: f64 = 0.15;
/// looked at as far out as this,
const SILHOUETTE_SIGMAS: f64 = 4.0;
/// and beyond a side that says nothing of where the object ends more than this.
const MOSTLY_HIDDEN: f64 = 0.5;
/// What is hidden there, as a share of how little was known of the end before.
const OPEN_SHARE: f64 = 0.25;
/// or as a share of the object: sizes differ by a quarter, to either end by half of that.
const OPEN_EXTENT_SHARE: f64 = 0.125;
/// The upper face.
const TOP: usize = 5;
/// Hardly a thing of a class has less than this share of the usual height: sizes differ by a quarter.
const LOW_SHARE: f64 = 0.6;
/// What is no higher than this above the support plane is the support plane (m).
const SUPPORT_MARGIN_M: f64 = 0.05;
/// An outline may overshoot the object itself by this share of the box: corners are seldom filled.
const MAX_OUTSIDE: f64 = 0.15;
const CORNERS: [(f64, f64); 4] = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)];
/// Twelve points of the unit circle.
const CIRCLE: [(f64, f64); 12] = [
    (1.0, 0.0),
    (HALF_ROOT_3, 0.5),
    (0.5, HALF_ROOT_3),
    (0.0, 1.0),
    (-0.5, HALF_ROOT_3),
    (-HALF_ROOT_3, 0.5),
    (-1.0, 0.0),
    (-HALF_ROOT_3, -0.5),
    (-0.5, -HALF_ROOT_3),
    (0.0, -1.0),
    (0.5, -HALF_ROOT_3),
    (HALF_ROOT_3, -0.5),
];
const HALF_ROOT_3: f64 = 0.866_025_403_784_438_6;
/// Detectors are sure of a side to this much (px),
const BOX_SIGMA_PX: f64 = 1.5;
/// and this share of the box.
const BOX_SIGMA_SHARE: f64 = 0.015;
/// What is missing is more than noise.
const TELLING_SIGMAS: f64 = 2.0;
/// The box tells how far the object reaches, but not whether all of that belongs to one face, where another one explains
/// it as well.
const AMBIGUITY: f64 = 0.5;
/// Outlines fill their corners, objects do not: what one face explains alone is known to this share.
const OUTLINE_SHARE: f64 = 0.15;
const MIN_SIGMA_M: f64 = 0.015;
/// No face is missed by more than this share of the object.
const MAX_GROWTH: f64 = 1.0;
/// Objects seldom grow by more than this share.
const GROWTH_SPREAD: f64 = 0.4;
/// A face that was seen is seldom the one that is missing.
const KNOWN_COST: f64 = 1.0;
const SIZE_SPREAD: f64 = 0.25;
const PROBE_M: f64 = 0.01;
const MIN_DEPTH_M: f64 = 0.1;
