//! Where faces are that were not seen, going by the class, by what was seen of the object, and by the room there is.

use super::{ClassPrior, Frame, Side, faces::Faces, segmentation::Segment};

/// How far things of a class usually reach along an axis.
#[derive(Clone, Copy)]
struct Usual {
    extent_m: f64,
    sigma_m: f64,
}

impl Faces {
    /// The same with guesses of what was not seen.
    pub(super) fn guessed(
        &self,
        frame: &Frame<'_>,
        segment: &Segment<'_>,
        prior: &ClassPrior,
    ) -> Self {
        let mut out = *self;
        let room_m = out.room_m(frame, segment, prior);
        out.at_most_m = std::array::from_fn(|i| out.faces[i].position_m + room_m[i]);
        out.guess_what_is_hidden(prior, room_m);
        out
    }

    /// The same with those faces that only `other` knows: mirror images, and what its box says.
    pub(super) fn knowing(&self, other: &Self) -> Self {
        let mut out = *self;
        for (own, other) in out.faces.iter_mut().zip(&other.faces) {
            if matches!(other.side, Side::Mirrored | Side::Outline) {
                *own = *other;
            }
        }
        out
    }

    /// Unseen faces lie somewhere beyond the last point: as far as the class's usual size asks for, or, where
    /// that is not known, further by a share of how large what was seen is, give or take more than that.
    fn guess_what_is_hidden(&mut self, prior: &ClassPrior, room_m: [f64; 4]) {
        let extents: [f64; 3] = std::array::from_fn(|axis| self.extent_m(axis));
        let usual = prior.size_m.map(|size| self.usual_sizes(size, room_m));
        let largest_m = extents.into_iter().fold(0.0, f64::max);
        let round_m = self.diameter_m(prior);
        // The bottom is settled by what the object stands on.
        for i in [0, 1, 2, 3, 5] {
            let axis = i / 2;
            let (guess, sigma_m) = match (self.faces[i].side, usual) {
                (side, _) if side.is_known() => continue,
                _ if axis < 2 && round_m.is_some() => {
                    let diameter_m = round_m.unwrap_or_default();
                    (diameter_m - extents[axis], ROUND_SPREAD * diameter_m)
                }
                (_, Some(usual)) => (usual[axis].extent_m - extents[axis], usual[axis].sigma_m),
                (_, None) => {
                    let beyond_m = HIDDEN_SHARE * largest_m;
                    (beyond_m, HIDDEN_SPREAD * beyond_m)
                }
            };
            let least_m = if axis < 2 && round_m.is_some() { 0.0 } else { MIN_GUESS_SIGMA_M };
            // What there is no room for at one end is at the other.
            let (own_m, other_m) = match i {
                0..4 => (room_m[i], room_m[i ^ 1]),
                _ => (f64::INFINITY, 0.0),
            };
            let share_m = (0.5 * guess).max(guess - other_m).clamp(0.0, own_m);
            let face = &mut self.faces[i];
            face.position_m += share_m;
            face.guessed_m += share_m;
            face.sigma_m = face.sigma_m.hypot(sigma_m.min(own_m)).max(least_m);
        }
    }

    /// The class's usual extents along the axes, as far as what was seen tells which of them is the longer one: an
    /// extent with a hidden end may be any part of the usual one, but not much more.
    fn usual_sizes(&self, [long, short, height]: [f64; 3], room_m: [f64; 4]) -> [Usual; 3] {
        let oddity = |axis: usize, usual: f64| {
            let least_m = self.extent_m(axis);
            let most_m = least_m + room_m[2 * axis] + room_m[2 * axis + 1];
            let off = |extent_m: f64| (extent_m / usual).ln() / SIZE_SPREAD;
            off(least_m).max(0.0).powi(2) + off(most_m).min(0.0).powi(2)
        };
        let along = oddity(0, long) + oddity(1, short);
        let across = oddity(0, short) + oddity(1, long);
        let is_along = 1.0 / (1.0 + (0.5 * (along - across)).exp());
        let unclear_m = (is_along * (1.0 - is_along)).sqrt() * (long - short);
        let either = |share: f64| {
            let extent_m = share * long + (1.0 - share) * short;
            Usual { extent_m, sigma_m: (SIZE_SPREAD * extent_m).hypot(unclear_m) }
        };
        let upright = Usual { extent_m: height, sigma_m: SIZE_SPREAD * height };
        [either(is_along), either(1.0 - is_along), upright]
    }

    /// How wide something round is, if both its ends along one horizontal axis are known (m).
    fn diameter_m(&self, prior: &ClassPrior) -> Option<f64> {
        let is_closed = |axis: &usize| {
            self.faces[2 * axis..2 * axis + 2].iter().all(|face| face.side.is_known())
        };
        (0..2).find(is_closed).filter(|_| prior.outline.is_round()).map(|axis| self.extent_m(axis))
    }
}

/// Objects of one class differ in size by about this share.
const SIZE_SPREAD: f64 = 0.25;
/// Round things have handles and leaves: their two widths differ by about this share.
const ROUND_SPREAD: f64 = 0.25;
/// Guesses are not better than this (m).
const MIN_GUESS_SIGMA_M: f64 = 0.05;
/// Of a class without a usual size, what was not seen goes on by this share of the largest extent that was seen: what
/// shows of a cabinet between a door and the image's border is a sliver of it, but as high as the whole.
const HIDDEN_SHARE: f64 = 0.3;
/// Standard deviation of that, as a share of it.
const HIDDEN_SPREAD: f64 = 1.5;
