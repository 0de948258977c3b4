//! Which object a measurement belongs to.

use super::{
    MapObject, MappingSettings, Observation, View,
    assignment::{Costs, assign, rival},
    gate::{Candidate, Step, overlap},
    index::ObjectIndex,
    visibility::Prospect,
};
use crate::{
    geometry::Pose,
    graph::{Graph, PoseId},
};
use std::collections::{BTreeMap, BTreeSet};

/// Who decides which measurement belongs to which object.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Association {
    /// The map.
    #[default]
    Automatic,
    /// The detections' own identities ([`crate::perception::Detection::track`]); what has none is left out. The paper
    /// joins by hand, so its figures can only be compared like this.
    Given,
}

/// What a box is taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Decision {
    Object(usize),
    New,
    /// It may be several objects, or one that it does not fit: later views will tell.
    Wait,
}

/// What was decided about a sighting.
pub(super) struct Associated {
    /// One for each observation.
    pub(super) decisions: Vec<Decision>,
    /// Objects that some box may show: nobody can say that they were missed.
    pub(super) shown: BTreeSet<usize>,
    /// How the objects before the camera should look.
    pub(super) prospects: BTreeMap<usize, Prospect>,
}

impl Associated {
    /// Decisions that were made elsewhere.
    pub(super) fn given(decisions: Vec<Decision>) -> Self {
        Self { decisions, shown: BTreeSet::new(), prospects: BTreeMap::new() }
    }
}

/// All that an association looks at.
pub(super) struct Evidence<'a> {
    pub(super) objects: &'a [MapObject],
    pub(super) graph: &'a Graph,
    pub(super) settings: &'a MappingSettings,
    pub(super) step: &'a Step,
    /// The keyframe's.
    pub(super) pose: PoseId,
    pub(super) map_from_base: &'a Pose,
    pub(super) view: Option<&'a View<'a>>,
}

impl Evidence<'_> {
    /// The best assignment of boxes to objects where it is clear.
    pub(super) fn associate(&self, observations: &[Observation]) -> Associated {
        let index = ObjectIndex::new(self.objects);
        let prospects = self.prospects(&index);
        let echoes = self.echoes(observations);
        let fits: Vec<Fits> = (observations.iter().zip(&echoes))
            .map(|(observation, echo)| match echo {
                None => self.fits(observation, &index, &prospects),
                Some(_) => Fits::default(),
            })
            .collect();
        let costs: Costs = fits.iter().map(|fits| fits.costs.clone()).collect();
        let alone = self.settings.gate.new_object_cost;
        let assigned = assign(&costs, alone);
        let mut associated =
            Associated { decisions: Vec::new(), shown: BTreeSet::new(), prospects };
        for at in 0..observations.len() {
            let decision = match assigned[at] {
                Some(object) => self.clear(&costs, &assigned, at, object, &mut associated.shown),
                None => new_or_wait(&fits[at], &assigned, &mut associated.shown),
            };
            associated.decisions.push(match observations[at].measured {
                Some(_) => decision,
                None => Decision::Wait,
            });
        }
        // The second box round a thing is what the first one is.
        for (at, echo) in echoes.iter().enumerate() {
            if echo.is_some() {
                associated.decisions[at] = Decision::Wait;
            }
        }
        associated.shown.extend(assigned.iter().copied().flatten());
        self.boxes_alone(observations, &mut associated);
        associated
    }

    /// The assigned object, if no other one would do as well. Objects that overlap are no alternatives: they will be
    /// merged.
    fn clear(
        &self,
        costs: &Costs,
        assigned: &[Option<usize>],
        at: usize,
        object: usize,
        shown: &mut BTreeSet<usize>,
    ) -> Decision {
        let gate = &self.settings.gate;
        let limits = (gate.new_object_cost, gate.ambiguity);
        match rival(costs, assigned, at, limits) {
            Some(other) if !self.are_in_one_place(object, other) => {
                shown.insert(other);
                Decision::Wait
            }
            _ => Decision::Object(object),
        }
    }

    fn are_in_one_place(&self, a: usize, b: usize) -> bool {
        overlap(self.objects[a].estimate(), self.objects[b].estimate()).0 > SAME_PLACE
    }

    fn prospects(&self, index: &ObjectIndex) -> BTreeMap<usize, Prospect> {
        let Some(view) = self.view else { return BTreeMap::new() };
        let map_from_camera = self.map_from_base * view.base_from_camera;
        let (right, below) =
            (f64::from(view.camera.width()) - 1.0, f64::from(view.camera.height()) - 1.0);
        let corners = [(0.0, 0.0), (right, 0.0), (0.0, below), (right, below)];
        let corners = corners.map(|(u, v)| view.camera.ray(u, v));
        let before = index.before(&map_from_camera, corners, view.max_range_m);
        let prospect = |at: usize| {
            let object = &self.objects[at];
            Prospect::new(view, self.map_from_base, object.estimate(), object.outline)
        };
        before.into_iter().filter_map(|at| Some((at, prospect(at)?))).collect()
    }

    /// For each box another one of the same thing, if there is one: detectors that are not sure of a class give two.
    fn echoes(&self, observations: &[Observation]) -> Vec<Option<usize>> {
        let is_echo = |at: usize, other: usize| {
            let (echo, first) = (&observations[at], &observations[other]);
            let (Some(echo_rect), Some(first_rect)) = (&echo.rect, &first.rect) else {
                return false;
            };
            let by_label = |o: &Observation| (o.labels[0].1, o.measured.is_some());
            let is_weaker = (by_label(echo).1, by_label(echo).0, other)
                < (by_label(first).1, by_label(first).0, at);
            is_weaker
                && echo.labels[0].0 != first.labels[0].0
                && echo_rect.overlap(first_rect) > ECHO_OVERLAP
        };
        let all = 0..observations.len();
        all.clone()
            .map(|at| all.clone().find(|other| *other != at && is_echo(at, *other)))
            .collect()
    }

    /// What it costs an observation to be each of the objects near it.
    fn fits(
        &self,
        observation: &Observation,
        index: &ObjectIndex,
        prospects: &BTreeMap<usize, Prospect>,
    ) -> Fits {
        let mut fits = Fits::default();
        let Some(measured) = &observation.measured else { return fits };
        let in_map = measured.ellipsoid.transformed(self.map_from_base);
        let gate = &self.settings.gate;
        for at in index.near(&in_map, REACH_M) {
            let object = &self.objects[at];
            let called = self.settings.labels.cost(&observation.labels, object.belief());
            if called >= gate.new_object_cost {
                continue;
            }
            let candidate = Candidate::new(measured, self.step, (self.pose, object), gate);
            let apart = 0.5 * candidate.squared_distance(self.graph, self.step, object);
            let seen = observation.rect.as_ref().zip(prospects.get(&at));
            let image = seen.map(|(rect, prospect)| rect.overlap(&prospect.rect));
            let box_cost = image.map_or(NO_BOX_COST, |share| -share.max(LEAST_OVERLAP).ln());
            let (of_smaller, _) = overlap(&in_map, object.estimate());
            // Single frames are wrong by more than they say now and then: what stands in the same place and looks the
            // same is the same, however unlikely.
            let most = if of_smaller > SAME_PLACE { WORST_COST } else { f64::MAX };
            let shy = if object.counts() { 0.0 } else { TENTATIVE_COST };
            fits.costs.insert(at, apart.min(most) + box_cost + called + shy);
            let is_there = of_smaller > TOUCHING
                || image.is_some_and(|share| share > gate.min_box_overlap && of_smaller > 0.0);
            if is_there && self.settings.labels.is_alike(called) {
                fits.explaining.push(at);
            }
        }
        fits
    }

    /// Boxes without a measurement: what they show is there, and no more.
    fn boxes_alone(&self, observations: &[Observation], associated: &mut Associated) {
        for (at, observation) in observations.iter().enumerate() {
            if associated.decisions[at] != Decision::Wait {
                continue;
            }
            let Some(rect) = &observation.rect else { continue };
            for (object, prospect) in &associated.prospects {
                let called =
                    self.settings.labels.cost(&observation.labels, self.objects[*object].belief());
                if rect.overlap(&prospect.rect) > self.settings.gate.min_box_overlap
                    && self.settings.labels.is_alike(called)
                {
                    associated.shown.insert(*object);
                }
            }
        }
    }
}

/// What an observation may be.
#[derive(Default)]
struct Fits {
    costs: BTreeMap<usize, f64>,
    /// Objects that are where it is and may be called so, whatever the gate says.
    explaining: Vec<usize>,
}

/// What fits no object is new, unless there is an object in its place that no other box shows.
fn new_or_wait(fits: &Fits, assigned: &[Option<usize>], shown: &mut BTreeSet<usize>) -> Decision {
    let is_free = |object: &&usize| !assigned.contains(&Some(**object));
    match fits.explaining.iter().find(is_free) {
        Some(object) => {
            shown.insert(*object);
            Decision::Wait
        }
        None => Decision::New,
    }
}

/// Bodies of one thing in two frames are never farther apart (m): what the gate is asked about.
const REACH_M: f64 = 0.3;
/// The most that geometry can cost where the measurement and the object overlap by so much of the smaller.
const WORST_COST: f64 = 10.0;
const SAME_PLACE: f64 = 0.4;
/// Overlap from which an object may be what a box shows.
const TOUCHING: f64 = 0.2;
/// Where the box or what to expect of it is not known, as much as for a box that overlaps by an eighth.
const NO_BOX_COST: f64 = 2.0;
const LEAST_OVERLAP: f64 = 0.02;
/// Of two that fit alike, the one that counts.
const TENTATIVE_COST: f64 = 0.5;
/// Boxes of different labels that overlap by so much are one thing.
const ECHO_OVERLAP: f64 = 0.75;
