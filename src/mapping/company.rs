//! What boxes at an object's place say of whether it is one thing, and where it seems to be.

use super::ObjectId;
use std::collections::BTreeMap;

/// Boxes besides an object's own.
#[derive(Clone, Debug, Default)]
pub(super) struct Company {
    /// How often it had a box beside one of these others: they are not the same.
    pub(super) beside: BTreeMap<ObjectId, u32>,
    /// In how many images a second box was in its place, less those in which there was none. One now and then is of what
    /// stands behind it; two things that were taken for one have one each time.
    crowded: u32,
    /// How many boxes were in its place that do not fit it.
    contradicted: u32,
    /// How many do.
    fitting: u32,
}

impl Company {
    /// That of an object which an earlier run saw so often.
    pub(super) fn remembered(observations: u32) -> Self {
        Self { fitting: observations.min(REMEMBERED), ..Self::default() }
    }

    /// Counts an image that shows the object.
    pub(super) fn see(&mut self, has_second_box: bool) {
        self.crowded =
            if has_second_box { self.crowded + 1 } else { self.crowded.saturating_sub(1) };
    }

    /// Counts a box in its place. Only the latest count: after hours of looking at it, it must not take hours to believe
    /// that it has changed.
    pub(super) fn judge(&mut self, fits: bool) {
        let (more, less) = if fits {
            (&mut self.fitting, &mut self.contradicted)
        } else {
            (&mut self.contradicted, &mut self.fitting)
        };
        if *more < REMEMBERED {
            *more += 1;
        } else {
            *less = less.saturating_sub(1);
        }
    }

    /// Whether more boxes in its place speak against it than for it.
    pub(super) fn is_discredited(&self) -> bool {
        self.contradicted > self.fitting
    }

    /// Forgets what spoke against it.
    pub(super) fn acquit(&mut self) {
        (self.contradicted, self.fitting) = (0, 0);
    }

    /// Whether it may be two things that were taken for one.
    pub(super) fn may_be_two(&self) -> bool {
        self.crowded >= BELIEVED_TWO
    }
}

/// Boxes in its place that are remembered.
const REMEMBERED: u32 = 20;
/// Images with a second box in an object before that is believed.
const BELIEVED_TWO: u32 = 3;
