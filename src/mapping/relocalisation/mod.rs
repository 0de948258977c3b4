//! Where am I: the place of some objects in a map, from labels, sizes, headings and mutual distances alone.
//!
//! Whether a place is believed is a matter of probability, not of counts. Under a place every seen object is either one
//! of the map's, seen with the errors that both claim, or a new one. If the robot is somewhere else, objects are where
//! chance puts them: as densely as the map has objects of their label. The place itself is unknown beforehand, so that
//! the likelihood is integrated over it (Laplace's approximation): few objects that fit roughly fit somewhere in every
//! large map. A place is accepted when it is so much more probable than all others, and than none, that it is false
//! with a small probability, and when that does not hang on a single object, which may have been moved.

mod hypotheses;
mod landmark;
mod place;

pub use landmark::Landmark;

use crate::geometry::Pose;
use hypotheses::{Candidate, Candidates, proposals};
use landmark::{Body, Placement, likeness_of_size};
use nalgebra::Matrix4;
use place::Place;
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, fmt};

/// When a place counts as found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RelocalisationSettings {
    /// Probability that an accepted place is a false one.
    pub max_false_probability: f64,
    /// Share of seen objects that are not in the map: moved, new, or never there.
    pub new_object_probability: f64,
    /// Probability beforehand that the robot is not in the map at all.
    pub elsewhere_probability: f64,
    /// Standard deviation of a position in the map, besides what its covariance says (m).
    pub position_sigma_m: f64,
    /// The same of a heading (deg).
    pub heading_sigma_deg: f64,
    /// The same of a size, as a share of it.
    pub size_sigma_ratio: f64,
}

impl Default for RelocalisationSettings {
    fn default() -> Self {
        Self {
            max_false_probability: 1e-3,
            new_object_probability: 0.1,
            elsewhere_probability: 0.5,
            position_sigma_m: 0.05,
            heading_sigma_deg: 2.0,
            size_sigma_ratio: 0.08,
        }
    }
}

/// A place that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Relocalised {
    /// From the frame that the objects were seen in to the map.
    pub map_from_seen: Pose,
    /// Covariance of its heading and translation in the map (rad, m).
    pub covariance: Matrix4<f64>,
    /// Index of a seen object and of the one in the map that it is.
    pub matches: Vec<(usize, usize)>,
    /// Probability that it is false.
    pub false_probability: f64,
}

/// Why no place was found.
#[derive(Clone, Debug, PartialEq)]
pub enum NotRelocalised {
    /// Less than a place can be recognised by.
    TooFewObjects {
        /// Objects that were seen.
        seen: usize,
        /// What is needed at least.
        needed: usize,
    },
    /// The map has fewer objects than a place can be recognised by.
    TooSmallMap {
        /// Objects of the map.
        known: usize,
        /// What is needed at least.
        needed: usize,
    },
    /// No place explains what was seen much better than chance.
    NoMatch {
        /// Objects that fit the best place.
        matched: usize,
        /// Objects that were seen.
        seen: usize,
    },
    /// Several places explain it.
    Ambiguous {
        /// The best one: from the frame that the objects were seen in to the map.
        best: Pose,
        /// Another one that is too good to be ruled out.
        second: Pose,
        /// Probability of the best one.
        probability: f64,
    },
}

impl fmt::Display for NotRelocalised {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFewObjects { seen, needed } => {
                write!(
                    f,
                    "{seen} objects were seen, at least {needed} are needed to recognise a place"
                )
            }
            Self::TooSmallMap { known, needed } => write!(
                f,
                "the map has {known} objects, at least {needed} are needed to recognise a place"
            ),
            Self::NoMatch { matched, seen } => write!(
                f,
                "no place in the map explains the {seen} objects that were seen; the best explains {matched}"
            ),
            Self::Ambiguous { best, second, probability } => {
                let (a, b) = (best.translation.vector, second.translation.vector);
                write!(
                    f,
                    "what was seen fits several places, for instance with the start at ({:.2}, {:.2}) and at \
                     ({:.2}, {:.2}); the best has a probability of {probability:.3}",
                    a.x, a.y, b.x, b.y
                )
            }
        }
    }
}

/// Where the frame of the seen objects is expected in the map.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpectedPlace {
    /// `map_from_seen`.
    pub pose: Pose,
    /// Covariance of heading and translation in the map (rad, m).
    pub covariance: Matrix4<f64>,
}

/// The objects of a map, prepared for being recognised.
#[derive(Clone, Debug)]
pub struct Constellation {
    bodies: Vec<Body>,
    labels: Vec<BTreeMap<String, f64>>,
    /// Sum of the probabilities of a label.
    counts: BTreeMap<String, f64>,
    /// Ground that the map covers (m^2).
    area: f64,
    /// The largest mean horizontal variance of a centre (m^2).
    largest_variance: f64,
    settings: RelocalisationSettings,
}

impl Constellation {
    /// Prepares the objects of a map.
    pub fn new(landmarks: &[Landmark], settings: RelocalisationSettings) -> Self {
        let bodies: Vec<Body> = landmarks.iter().map(|l| Body::new(l, &settings)).collect();
        let mut counts: BTreeMap<String, f64> = BTreeMap::new();
        for (label, probability) in landmarks.iter().flat_map(|l| &l.labels) {
            *counts.entry(label.clone()).or_default() += probability;
        }
        let extent = |axis: usize| {
            let along = bodies.iter().map(|b| b.center[axis]);
            let (low, high) = along.fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
            (high - low).max(0.0) + 2.0 * MARGIN_M
        };
        let area = extent(0) * extent(1);
        let labels = landmarks.iter().map(|l| l.labels.clone()).collect();
        let variances = bodies.iter().map(Body::horizontal_variance);
        let largest_variance = variances.fold(0.0, f64::max);
        Self { bodies, labels, counts, area, largest_variance, settings }
    }

    /// Finds the place of the seen objects.
    ///
    /// # Errors
    /// A value that says why it is not known: too few objects, none or several places that fit.
    pub fn locate(
        &self,
        seen: &[Landmark],
        expected: Option<&ExpectedPlace>,
    ) -> Result<Relocalised, NotRelocalised> {
        let known = self.bodies.len();
        if known < MIN_OBJECTS {
            return Err(NotRelocalised::TooSmallMap { known, needed: MIN_OBJECTS });
        }
        if seen.len() < MIN_OBJECTS {
            return Err(NotRelocalised::TooFewObjects { seen: seen.len(), needed: MIN_OBJECTS });
        }
        let (bodies, candidates) = self.compared(seen);
        let proposed = proposals(&bodies, self, &candidates);
        let mut places: Vec<Place> = Vec::new();
        let hint = expected.map(|e| Placement::of_pose(&e.pose));
        for start in proposed.placements.iter().chain(&hint) {
            let Some(place) = Place::refined(start, &bodies, self, &candidates, expected) else {
                continue;
            };
            match places.iter_mut().find(|known| known.is_same(&place, &bodies)) {
                Some(known) if known.evidence >= place.evidence => {}
                Some(known) => *known = place,
                None => places.push(place),
            }
        }
        places.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        self.decide(&places, &bodies, proposed.complete_above)
    }

    /// The most probable place near an expected one, believed whatever speaks for others: who says where the robot is has
    /// the last word.
    pub fn place_near(&self, seen: &[Landmark], expected: &ExpectedPlace) -> Option<Relocalised> {
        let (bodies, candidates) = self.compared(seen);
        let start = Placement::of_pose(&expected.pose);
        let place = Place::refined(&start, &bodies, self, &candidates, Some(expected))?;
        let against = (self.odds_of_elsewhere() - place.evidence).exp();
        Some(place.relocalised(against / (1.0 + against)))
    }

    /// What is seen, ready to be compared, and what of the map each may be.
    fn compared(&self, seen: &[Landmark]) -> (Vec<Body>, Vec<Candidates>) {
        let bodies: Vec<Body> = seen.iter().map(|l| Body::new(l, &self.settings)).collect();
        let of_each = seen.iter().zip(&bodies).map(|(l, body)| self.candidates(l, body));
        let candidates = of_each.collect();
        (bodies, candidates)
    }

    /// Logarithm of the odds beforehand that the robot is not in the map.
    fn odds_of_elsewhere(&self) -> f64 {
        let elsewhere = self.settings.elsewhere_probability;
        (elsewhere / (1.0 - elsewhere)).ln()
    }

    /// Objects of the map that have a label in common with a seen one, and a size that could be the same.
    fn candidates(&self, seen: &Landmark, body: &Body) -> Candidates {
        let of_known = |(known, labels): (usize, &BTreeMap<String, f64>)| {
            let common = seen.labels.iter().filter_map(|(label, p)| {
                let expected = self.counts.get(label)?.max(LEAST_COUNT);
                Some(p * labels.get(label)? * self.area / expected)
            });
            let odds: f64 = common.sum();
            let size = [false, true]
                .map(|swapped| likeness_of_size(body, &self.bodies[known], swapped))
                .into_iter()
                .fold(f64::MIN, f64::max);
            let evidence = odds.ln();
            let x = self.bodies[known].center.x;
            (odds > 0.0 && size > MIN_LIKENESS).then_some(Candidate { known, evidence, x })
        };
        Candidates::new(self.labels.iter().enumerate().filter_map(of_known).collect())
    }

    /// Whether the best place is beyond doubt, with whichever object left out.
    fn decide(
        &self,
        places: &[Place],
        bodies: &[Body],
        complete_above: usize,
    ) -> Result<Relocalised, NotRelocalised> {
        let seen = bodies.len();
        let none = self.odds_of_elsewhere();
        let Some(best) = places.first() else {
            return Err(NotRelocalised::NoMatch { matched: 0, seen });
        };
        let matched = best.matches.len();
        let limit = self.settings.max_false_probability.ln();
        let against_none = none - best.evidence;
        let is_too_weak = against_none + best.largest_contribution() > limit;
        // Objects in a row fit many places that are not this one, so that nothing may contradict them.
        let is_row = matched + 1 < seen && best.fits_mirrored(bodies, self);
        if is_too_weak || matched < MIN_OBJECTS || is_row {
            return Err(NotRelocalised::NoMatch { matched, seen });
        }
        let others = places[1..].iter();
        let rivals = others.map(|other| other.evidence - best.evidence);
        let all: f64 = rivals.chain([against_none]).map(f64::exp).sum();
        let false_probability = all / (1.0 + all);
        let rival = places[1..].iter().find(|other| {
            let (advantage, without_one) = best.advantage(other);
            -advantage > limit || -without_one > SECOND_OPINION.ln()
        });
        match rival {
            Some(second) => Err(NotRelocalised::Ambiguous {
                best: best.placement.pose(),
                second: second.placement.pose(),
                probability: 1.0 - false_probability,
            }),
            None if false_probability.ln() > limit => {
                Err(NotRelocalised::NoMatch { matched, seen })
            }
            // Places that nobody has looked at may explain as much.
            None if matched < complete_above + 1 => Err(NotRelocalised::NoMatch { matched, seen }),
            None => Ok(best.relocalised(false_probability)),
        }
    }
}

/// Two objects fix a place, a third one confirms it.
const MIN_OBJECTS: usize = 3;
/// A rival has to be this improbable also by what all objects but one say: one can have been moved, or measured badly.
const SECOND_OPINION: f64 = 0.05;
/// The robot may be so far outside of the objects' extents (m).
const MARGIN_M: f64 = 1.0;
/// Sizes that are less alike than this are of different objects.
const MIN_LIKENESS: f64 = -10.0;
/// Objects of a label that a map has at least, however little it believes in them: any detector gives any name now and then.
const LEAST_COUNT: f64 = 0.05;
