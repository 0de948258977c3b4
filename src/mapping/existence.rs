//! Whether an object is there: log-odds from what was seen and what was not.

use super::visibility::Prospect;
use crate::time::Stamp;
use nalgebra::Point3;
use serde::{Deserialize, Serialize};

/// When an object counts, and when it is gone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LifeSettings {
    /// Probability that a detector finds an object that it can see.
    pub detection_probability: f64,
    /// Probability that it finds something where there is nothing.
    pub false_detection_probability: f64,
    /// Existence from which an object counts.
    pub confirmed_from: f64,
    /// Existence below which it is taken out of the map.
    pub removed_below: f64,
    /// Views from places at least so far apart are different (m).
    pub different_views_m: f64,
    /// Whether an object that was moved keeps its identity at its new place.
    pub moved_keeps_id: bool,
}

impl Default for LifeSettings {
    fn default() -> Self {
        Self {
            detection_probability: 0.8,
            false_detection_probability: 0.1,
            confirmed_from: 0.9,
            removed_below: 0.1,
            different_views_m: 0.1,
            moved_keeps_id: true,
        }
    }
}

/// Where an object is in its life; what is removed has left the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ObjectState {
    /// Not seen often enough to count.
    #[default]
    Tentative,
    /// It counts.
    Confirmed,
    /// It counts, but was not found where it should be.
    Stale,
}

/// The evidence for and against an object.
#[derive(Clone, Debug)]
pub(super) struct Existence {
    log_odds: f64,
    pub(super) state: ObjectState,
    /// How often it was found where it could be seen, and how often not.
    found: f64,
    missed: f64,
    /// Mean share of free rays that ended in it when it was found.
    filled: Option<f64>,
    /// Where it was last seen from as a view of its own, and how many there are.
    eye: Option<Point3<f64>>,
    views: u32,
    /// Where it was last missed from while others accounted for what stands in its place.
    missed_from: Option<Point3<f64>>,
    /// When one last looked through its place.
    empty_at: Option<Stamp>,
}

/// An image that does not show an object where it should be.
pub(super) struct Miss<'a> {
    pub(super) prospect: &'a Prospect,
    /// Share of what stands in its place that belongs to objects with a box in this image.
    pub(super) of_others: f64,
    /// When the image was made.
    pub(super) now: Stamp,
    /// False while the robot stands still: a detector that is blind to an object stays blind.
    pub(super) is_new_view: bool,
    /// Where the robot is in the map.
    pub(super) eye: Point3<f64>,
}

impl Default for Existence {
    fn default() -> Self {
        Self {
            log_odds: log_odds(PRIOR),
            state: ObjectState::Tentative,
            found: 0.0,
            missed: 0.0,
            filled: None,
            eye: None,
            views: 0,
            missed_from: None,
            empty_at: None,
        }
    }
}

impl Existence {
    /// Of an object that counted in an earlier run.
    pub(super) fn remembered(probability: f64) -> Self {
        let mut remembered = Self { state: ObjectState::Confirmed, views: 2, ..Self::default() };
        remembered.log_odds = log_odds(probability).clamp(0.0, MAX_LOG_ODDS);
        remembered
    }

    pub(super) fn probability(&self) -> f64 {
        1.0 / (1.0 + (-self.log_odds).exp())
    }

    /// A measurement of this probability in a box of this score was joined to it, made from a place in the map.
    pub(super) fn measured(
        &mut self,
        (score, probability): (f64, f64),
        eye: &Point3<f64>,
        life: &LifeSettings,
    ) {
        let a_box = Event {
            if_there: life.detection_probability,
            if_not: life.false_detection_probability,
        };
        // A doubtful measurement says less, but a box is a box, as far as its score says.
        let by_score = log_odds(score.clamp(FALSE_SCORE, SURE_SCORE)) - log_odds(FALSE_SCORE);
        self.add(a_box.log_ratio().min(by_score) * (0.5 + 0.5 * probability));
        if self.eye.is_none_or(|last| nalgebra::distance(&last, eye) > life.different_views_m) {
            self.eye = Some(*eye);
            self.views += 1;
        }
    }

    /// A box is where it should be, and this is what the depth image shows there.
    pub(super) fn found(&mut self, prospect: &Prospect) {
        self.found += 1.0;
        let filled = prospect.filled();
        let known = self.filled.unwrap_or(filled);
        self.filled = Some(known + (filled - known) / self.found.min(MEMORY));
    }

    /// Whether one looks through where it should be.
    pub(super) fn is_empty(&self, prospect: &Prospect) -> bool {
        prospect.filled() < EMPTY * self.filled.unwrap_or(USUALLY_FILLED)
    }

    /// Whether less of it stands where it should be than usual.
    pub(super) fn is_left(&self, prospect: &Prospect) -> bool {
        prospect.filled() < STANDS * self.filled.unwrap_or(USUALLY_FILLED)
    }

    /// It should be visible and there is no box.
    pub(super) fn missed(&mut self, miss: &Miss<'_>, life: &LifeSettings) {
        let usual = self.filled.unwrap_or(USUALLY_FILLED);
        let filled = miss.prospect.filled();
        if self.is_empty(miss.prospect) {
            // Images that follow each other from one place are wrong alike.
            let is_news = self.empty_at.is_none_or(|at| miss.now.seconds_since(at) >= NEWS_AFTER_S);
            if miss.is_new_view || is_news {
                self.add(LOOKED_THROUGH.log_ratio());
                self.empty_at = Some(miss.now);
            }
            return;
        }
        if !miss.is_new_view {
            return;
        }
        let stands = self.state != ObjectState::Tentative && filled > STANDS * usual;
        let is_others = stands && miss.of_others > MOSTLY;
        if is_others {
            // Then nothing tells a detector that is blind to it from an object that never was: only views that differ count.
            let is_near =
                |last: Point3<f64>| nalgebra::distance(&last, &miss.eye) <= life.different_views_m;
            if self.missed_from.is_some_and(is_near) {
                return;
            }
            self.missed_from = Some(miss.eye);
        } else {
            self.missed += 1.0;
        }
        // The detector may be worse at this object than at others.
        let known = (self.found + PRIOR_FOUND) / (self.found + self.missed + PRIOR_SEEN);
        let chance = known.clamp(LEAST_CHANCE, life.detection_probability.max(LEAST_CHANCE));
        let no_box =
            Event { if_there: 1.0 - chance, if_not: 1.0 - life.false_detection_probability };
        self.add(
            no_box.log_ratio().min(0.0) * if stands && !is_others { STANDING_SHARE } else { 1.0 },
        );
    }

    /// Takes the state that the evidence makes; whether the object is still there.
    pub(super) fn settle(&mut self, observations: u32, needed: u32, life: &LifeSettings) -> bool {
        let more = needed.saturating_add(MORE_FROM_ONE_PLACE);
        let enough = observations >= needed && (self.views > 1 || observations >= more);
        let is_sure = self.log_odds >= log_odds(life.confirmed_from);
        self.state = match self.state {
            ObjectState::Tentative if enough && is_sure => ObjectState::Confirmed,
            ObjectState::Confirmed if self.log_odds < 0.0 => ObjectState::Stale,
            ObjectState::Stale if is_sure => ObjectState::Confirmed,
            same => same,
        };
        self.log_odds > log_odds(life.removed_below)
    }

    /// What another object that is the same thing adds.
    pub(super) fn absorb(&mut self, other: &Self) {
        self.add((other.log_odds - log_odds(PRIOR)).max(0.0));
        self.found += other.found;
        self.missed = self.missed.min(other.missed);
        self.views += other.views;
        self.filled = self.filled.or(other.filled);
        if self.state == ObjectState::Tentative {
            self.state = other.state;
        }
    }

    fn add(&mut self, change: f64) {
        self.log_odds = (self.log_odds + change).clamp(-MAX_LOG_ODDS, MAX_LOG_ODDS);
    }
}

/// Something that an image shows, and how probable that is where the object is and where it is not. What images say of
/// existence is the ratio of the two (Bayes).
struct Event {
    if_there: f64,
    if_not: f64,
}

impl Event {
    fn log_ratio(&self) -> f64 {
        (self.if_there / self.if_not).ln()
    }
}

fn log_odds(probability: f64) -> f64 {
    (probability / (1.0 - probability)).ln()
}

/// Measurements that are needed besides where all are from one place.
const MORE_FROM_ONE_PLACE: u32 = 2;
/// Before anything is known of a first box.
const PRIOR: f64 = 0.3;
/// Detectors and depth can always be wrong together; and what was there for days can be carried away.
const MAX_LOG_ODDS: f64 = 5.0;
/// Sightings over which the usual share of rays is averaged.
const MEMORY: f64 = 10.0;
/// Of the rays through an object's box, as long as nothing is known.
const USUALLY_FILLED: f64 = 0.4;
/// Where less than this share of the usual is left, the object is not.
const EMPTY: f64 = 0.25;
/// A look through the place of an object: poses and estimates are wrong by its width now and then.
const LOOKED_THROUGH: Event = Event { if_there: 0.08, if_not: 0.97 };
/// A robot that stands still looks anew after so long (s).
const NEWS_AFTER_S: f64 = 1.0;
/// Detectors that find an object more seldom than this would hardly have found it at all.
const LEAST_CHANCE: f64 = 0.15;
/// Score that false boxes usually have: such a box says nothing,
const FALSE_SCORE: f64 = 0.1;
/// and no score says more than this one.
const SURE_SCORE: f64 = 0.99;
/// Where more than this share of the usual is left, something stands there...
const STANDS: f64 = 0.6;
/// ...and a box that is missing says less,
const STANDING_SHARE: f64 = 0.2;
/// unless more than this share of what stands there belongs to others.
const MOSTLY: f64 = 0.7;
/// What is known of a detector's chances before: two of two and a half.
const PRIOR_FOUND: f64 = 2.0;
const PRIOR_SEEN: f64 = 2.5;
