//! Which object a measurement belongs to.

use super::{
    MapObject, MappingSettings, Measured, Observation, View,
    assignment::{Costs, assign, rivals},
    gate::{Candidate, KnownPose, Step, joint_covariance, overlap},
    index::ObjectIndex,
    visibility::Prospect,
};
use crate::{
    geometry::{Ellipsoid, Pose, skew},
    graph::{Graph, PoseId},
    time::Stamp,
};
use nalgebra::{DMatrix, SMatrix};
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
    /// It is this one, which is elsewhere than was thought: what was measured of it before was something else.
    Anew(usize),
    New,
    /// It is probably this one, which was pushed: the next views will tell.
    Displaced(usize),
    /// It may be several objects, or one that it does not fit: later views will tell.
    Wait,
}

/// What was decided about a sighting.
#[derive(Default)]
pub(super) struct Associated {
    /// One for each observation.
    pub(super) decisions: Vec<Decision>,
    /// Objects that some box may show: nobody can say that they were missed.
    pub(super) shown: BTreeSet<usize>,
    /// Objects in which a second box was.
    pub(super) crowded: Vec<usize>,
    /// Objects where a box was that does not fit them.
    pub(super) contradicted: Vec<usize>,
    /// How the objects before the camera should look.
    pub(super) prospects: BTreeMap<usize, Prospect>,
}

impl Associated {
    /// Decisions that were made elsewhere.
    pub(super) fn given(decisions: Vec<Decision>) -> Self {
        Self { decisions, ..Self::default() }
    }
}

/// All that an association looks at.
pub(super) struct Evidence<'a> {
    pub(super) objects: &'a [MapObject],
    pub(super) graph: &'a Graph,
    pub(super) settings: &'a MappingSettings,
    pub(super) step: &'a Step,
    /// Of the pose that the step begins at; nothing in a graph without poses.
    pub(super) known_pose: Option<KnownPose>,
    /// What was seen since then has drifted with the robot.
    pub(super) long_ago: Option<Stamp>,
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
        let bodies = self.bodies(observations);
        let doubtful = self.doubtful(observations, &bodies);
        // Neighbours have neighbours in common.
        let mut known = BTreeMap::new();
        let fits: Vec<Fits> = (observations.iter().zip(&doubtful))
            .map(|(observation, is_doubtful)| match &observation.measured {
                Some(measured) if !is_doubtful => {
                    self.fits((observation, measured), &index, &prospects, &mut known)
                }
                _ => Fits {
                    in_image: self.in_image(observation, &prospects),
                    is_doubtful: *is_doubtful,
                    ..Fits::default()
                },
            })
            .collect();
        let own: Vec<Option<f64>> = bodies.iter().map(|body| body.as_ref().map(|b| b.1)).collect();
        let costs: Costs = fits.iter().map(|fits| fits.costs.clone()).collect();
        let assigned = assign(&costs, self.settings.gate.new_object_cost);
        let mut associated = Associated { prospects, ..Associated::default() };
        for (at, observation) in observations.iter().enumerate() {
            let is_usable = observation.measured.is_some() && !doubtful[at];
            let decision = match assigned[at] {
                _ if !is_usable => Decision::Wait,
                Some(object) => self.clear((&costs, &fits), &assigned, (at, object)),
                None => {
                    self.new_or_wait((&fits[at], own[at].is_some()), &assigned, &mut associated)
                }
            };
            let decision = self.anew((decision, own[at]), &fits[at], &mut associated);
            let is_open = is_usable && matches!(decision, Decision::New | Decision::Wait);
            let body = bodies[at].as_ref().filter(|_| is_open).map(|(body, _)| body);
            let pushed = body.and_then(|body| {
                let taken: Vec<usize> = assigned.iter().copied().flatten().collect();
                self.pushed((observation, body), &taken, &associated.prospects)
            });
            associated.shown.extend(pushed);
            let decision = pushed.map_or(decision, Decision::Displaced);
            associated
                .shown
                .extend(fits[at].explaining.keys().filter(|_| decision == Decision::Wait));
            associated.decisions.push(decision);
        }
        associated.shown.extend(assigned.iter().copied().flatten());
        self.boxes_alone(observations, &mut associated);
        associated
    }

    /// The assigned object, if no other one would do as well, and no box says that it is another one: of things that stand
    /// behind each other, the points of the nearer fill the box of the farther.
    fn clear(
        &self,
        (costs, fits): (&Costs, &[Fits]),
        assigned: &[Option<usize>],
        (at, object): (usize, usize),
    ) -> Decision {
        let gate = &self.settings.gate;
        let in_image = &fits[at].in_image;
        let share = in_image.get(&object).copied().unwrap_or(1.0);
        let is_better = |other: &&usize| in_image[other] > share + BETTER_OVERLAP;
        let by_box = in_image.keys().filter(is_better).copied();
        // Another box overlaps this object as well as its own box, and better than the object that it was given.
        let claims = |(fits, own): (&Fits, &Option<usize>)| {
            let overlap = |object: usize| fits.in_image.get(&object).copied().unwrap_or(0.0);
            match *own {
                Some(own) => {
                    own != object
                        && overlap(object) > overlap(own) + BETTER_OVERLAP
                        && overlap(object) > share - BETTER_OVERLAP
                }
                // Its measurement may be that of the same thing.
                None => fits.is_doubtful && overlap(object) > share + BETTER_OVERLAP,
            }
        };
        if fits.iter().zip(assigned).any(claims) {
            return Decision::Wait;
        }
        let limits = (gate.new_object_cost, gate.ambiguity);
        let mut others = by_box.chain(rivals(costs, assigned, at, limits));
        let is_unclear = others.any(|other| self.is_alternative(object, other));
        if is_unclear { Decision::Wait } else { Decision::Object(object) }
    }

    /// Boxes that overlap what is to be expected of their object much less than what was measured in them contradict it.
    /// After more of those than of boxes that fit, the object begins anew where it was measured last.
    fn anew(
        &self,
        (decision, own): (Decision, Option<f64>),
        fits: &Fits,
        associated: &mut Associated,
    ) -> Decision {
        let Decision::Object(object) = decision else { return decision };
        let share = fits.in_image.get(&object).copied();
        let is_poor = share.is_some_and(|share| share < POORLY * own.unwrap_or(1.0));
        if !is_poor {
            return decision;
        }
        associated.contradicted.push(object);
        let is_wrong = own.is_some() && self.objects[object].is_discredited();
        if is_wrong { Decision::Anew(object) } else { decision }
    }

    /// Whether a measurement of one object has to wait because it may be the other's. Objects that overlap are none of
    /// each other: they will be merged. Nor is what does not count and never had a box beside it: that may well be the
    /// same thing, begun a second time, and if boxes waited for it neither would ever count.
    fn is_alternative(&self, object: usize, other: usize) -> bool {
        let (object, other) = (&self.objects[object], &self.objects[other]);
        let is_known = other.counts() || object.company.beside.contains_key(&other.id);
        is_known && overlap(object.estimate(), other.estimate()).0 <= SAME_PLACE
    }

    /// What fits no object is new, unless there is an object in its place. One that was contradicted more often than it
    /// was measured before it came to count is none: it began with a wrong measurement. One that another box of this
    /// image shows is none, but for where they overlap much: then one of the two is wrong, and it takes several images
    /// to believe that one object is two.
    fn new_or_wait(
        &self,
        (fits, is_measured): (&Fits, bool),
        assigned: &[Option<usize>],
        associated: &mut Associated,
    ) -> Decision {
        let is_taken = |object: &usize| assigned.contains(&Some(*object));
        let taken = fits.explaining.iter().find(|(o, share)| is_taken(o) && **share > SAME_PLACE);
        associated.crowded.extend(taken.map(|(object, _)| *object));
        let is_none = |object: &MapObject| !object.counts() && object.is_discredited();
        let blocking: Vec<usize> = (fits.explaining.keys().copied())
            .filter(|object| !is_taken(object) && !is_none(&self.objects[*object]))
            .collect();
        let may_be_two = |object: &usize| self.objects[*object].company.may_be_two();
        let is_waiting =
            taken.is_some_and(|(object, _)| !may_be_two(object)) || !blocking.is_empty();
        let wrong = match blocking[..] {
            [only] if self.objects[only].is_discredited() && taken.is_none() && is_measured => {
                Some(only)
            }
            _ => None,
        };
        associated.contradicted.extend(blocking);
        match wrong {
            Some(wrong) => Decision::Anew(wrong),
            None if is_waiting => Decision::Wait,
            None => Decision::New,
        }
    }

    /// The object that a measurement which fits none shows, if one was pushed: the nearest of those that are alike, were not
    /// found in this image, and cannot be where they were, as this stands there or one looks through their places. Others
    /// are where they should be: where all stand elsewhere, it is the robot that does.
    fn pushed(
        &self,
        (observation, body): (&Observation, &Ellipsoid),
        taken: &[usize],
        prospects: &BTreeMap<usize, Prospect>,
    ) -> Option<usize> {
        let labels = &self.settings.labels;
        let may_be = |(at, object): (usize, &MapObject)| {
            let known = object.estimate();
            let apart = body.center() - known.center();
            let is_near = apart.xy().norm() < PUSHED_M && apart.z.abs() < PUSHED_UP_M;
            if taken.len() < FITTING_OTHERS
                || taken.contains(&at)
                || !is_near
                || !object.counts()
                || object.is_glimpsed()
                || object.locked
            {
                return None;
            }
            let sorted = |e: &Ellipsoid| [e.semi_axes.xy().max(), e.semi_axes.xy().min()];
            let (a, b) = (sorted(body), sorted(known));
            let is_as_large = (0..2).all(|i| (a[i] / b[i]).ln().abs() < SAME_SIZE.ln());
            let is_alike = labels.is_alike(labels.cost(&observation.labels, object.belief()));
            let is_left = prospects.get(&at).is_some_and(|prospect| {
                prospect.is_visible() && object.existence.is_left(prospect)
            });
            let is_there = overlap(body, known).0 > TOUCHING;
            (is_as_large && is_alike && (is_left || is_there)).then(|| (apart.norm(), at))
        };
        let all = self.objects.iter().enumerate().filter_map(may_be);
        all.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, at)| at)
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

    /// What was measured, in the map, and how much its box overlaps that of what is to be expected of it. Not of glimpses.
    fn bodies(&self, observations: &[Observation]) -> Vec<Option<(Ellipsoid, f64)>> {
        let body = |observation: &Observation| {
            let measured = observation.measured.as_ref().filter(|m| m.glimpse.is_none())?;
            let view = self.view?;
            let body = measured.ellipsoid.transformed(self.map_from_base);
            let own = Prospect::new(view, self.map_from_base, &body, observation.outline);
            let share = own.zip(observation.rect).map_or(0.0, |(o, rect)| o.rect.overlap(&rect));
            Some((body, share))
        };
        observations.iter().map(body).collect()
    }

    /// Boxes that say nothing new: of two in one place, the one that fits its own measurement worse. Detectors that are
    /// not sure of a class give a thing two boxes, and what is mostly hidden is measured by the points of what hides it.
    fn doubtful(
        &self,
        observations: &[Observation],
        bodies: &[Option<(Ellipsoid, f64)>],
    ) -> Vec<bool> {
        let labels = &self.settings.labels;
        let belief = |o: &Observation| labels.posterior(&o.labels.iter().cloned().collect());
        let yields = |at: usize, other: usize| {
            let (Some((body, share)), Some((first, best))) = (&bodies[at], &bodies[other]) else {
                return false;
            };
            (*share, other) < (*best, at)
                && (body.center() - first.center()).norm()
                    < body.semi_axes.norm() + first.semi_axes.norm()
                && overlap(body, first).0 > SAME_PLACE
                && labels
                    .is_alike(labels.cost(&observations[at].labels, &belief(&observations[other])))
        };
        let all = 0..observations.len();
        all.clone().map(|at| all.clone().any(|other| other != at && yields(at, other))).collect()
    }

    /// What it costs an observation to be each of the objects near it; `known` has what was asked of the graph before.
    fn fits(
        &self,
        (observation, measured): (&Observation, &Measured),
        index: &ObjectIndex,
        prospects: &BTreeMap<usize, Prospect>,
        known: &mut BTreeMap<usize, DMatrix<f64>>,
    ) -> Fits {
        let mut fits = Fits { in_image: self.in_image(observation, prospects), ..Fits::default() };
        let in_map = measured.ellipsoid.transformed(self.map_from_base);
        let gate = &self.settings.gate;
        // Where only the direction is known, the image says what is near.
        let is_unsure = |at: &usize| measured.glimpse.is_some() || self.objects[*at].is_glimpsed();
        let aligned = fits.in_image.iter().filter(|(at, share)| **share > ALIGNED && is_unsure(at));
        let mut near: BTreeSet<usize> = aligned.map(|(at, _)| *at).collect();
        near.extend(index.near(&in_map, REACH_M));
        near.extend((0..self.objects.len()).filter(|at| self.objects[*at].is_adrift()));
        let old = |at: &usize| self.long_ago.is_some_and(|then| self.objects[*at].last_seen < then);
        near.extend(index.near(&in_map, self.reach_m(measured)).into_iter().filter(old));
        for at in near {
            let object = &self.objects[at];
            let called = self.settings.labels.cost(&observation.labels, object.belief());
            // Of what may be anywhere, only the name tells whether it is the same.
            let compares_boxes = observation.compares_box(object);
            let is_vague = compares_boxes || object.is_adrift();
            let is_alike = self.settings.labels.is_alike(called);
            if called >= gate.new_object_cost || is_vague && !is_alike {
                continue;
            }
            let candidate =
                Candidate::new((observation, measured), self.step, (self.pose, object), gate);
            let joint = known
                .entry(at)
                .or_insert_with(|| joint_covariance(self.graph, self.known_pose.as_ref(), object));
            let apart = candidate.cost(self.graph, self.step, (object, joint));
            let seen = observation.rect.as_ref().zip(prospects.get(&at));
            let image = seen.map(|(rect, prospect)| rect.overlap(&prospect.rect));
            let image_cost = image.map_or(NO_BOX_COST, |share| -share.max(LEAST_OVERLAP).ln());
            let box_cost = if compares_boxes { 0.0 } else { image_cost };
            let (of_smaller, _) = overlap(&in_map, object.estimate());
            // Single frames are wrong by more than they say now and then: what stands in the same place and looks the
            // same is the same, however unlikely.
            let is_there = of_smaller > SAME_PLACE || image.is_some_and(|share| share > SAME_BOX);
            let most = if is_there { WORST_COST } else { f64::MAX };
            let shy = if object.counts() { 0.0 } else { TENTATIVE_COST };
            fits.costs.insert(at, apart.min(most) + box_cost + called + shy);
            let is_there = of_smaller > TOUCHING
                || image.is_some_and(|share| {
                    share > gate.min_box_overlap && (of_smaller > 0.0 || is_unsure(&at))
                });
            if is_there && is_alike {
                fits.explaining.insert(at, of_smaller);
            }
        }
        fits
    }

    /// How far from a measurement its object may be found if it was not seen for long (m): a robot that comes back finds
    /// all that it knows as far off as it has drifted, and the graph knows how far that may be.
    fn reach_m(&self, measured: &Measured) -> f64 {
        let mut moved = SMatrix::<f64, 3, 6>::zeros();
        moved.fixed_view_mut::<3, 3>(0, 0).copy_from(&-skew(measured.ellipsoid.center().coords));
        moved.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
        let Some(pose) = &self.known_pose else { return REACH_M };
        let drift = moved * pose.covariance * moved.transpose();
        let sigma = drift.symmetric_eigenvalues().max().max(0.0).sqrt();
        (REACH_M + DRIFT_SIGMAS * sigma).min(MOST_REACH_M)
    }

    /// How much of the boxes of objects that may be called so a box overlaps.
    fn in_image(
        &self,
        observation: &Observation,
        prospects: &BTreeMap<usize, Prospect>,
    ) -> BTreeMap<usize, f64> {
        let Some(rect) = &observation.rect else { return BTreeMap::new() };
        let labels = &self.settings.labels;
        let is_alike = |at: &usize| {
            labels.is_alike(labels.cost(&observation.labels, self.objects[*at].belief()))
        };
        let shares = prospects.iter().filter(|(at, _)| is_alike(at));
        shares.map(|(at, prospect)| (*at, rect.overlap(&prospect.rect))).collect()
    }

    /// Boxes without a measurement: what they show is there, and no more.
    fn boxes_alone(&self, observations: &[Observation], associated: &mut Associated) {
        for (at, observation) in observations.iter().enumerate() {
            if associated.decisions[at] != Decision::Wait {
                continue;
            }
            let shares = self.in_image(observation, &associated.prospects);
            let least = self.settings.gate.min_box_overlap;
            let shown = shares.into_iter().filter(|(_, share)| *share > least);
            associated.shown.extend(shown.map(|(object, _)| object));
        }
    }
}

/// What an observation may be.
#[derive(Default)]
struct Fits {
    costs: BTreeMap<usize, f64>,
    /// Objects that are where it is and may be called so, whatever the gate says, and how much of the smaller is common.
    explaining: BTreeMap<usize, f64>,
    /// How much its box overlaps those of objects that may be called so.
    in_image: BTreeMap<usize, f64>,
    /// Whether another box of the image shows what was measured in it.
    is_doubtful: bool,
}

/// Furniture is pushed by so much at a time (m), on its floor;
const PUSHED_M: f64 = 0.6;
const PUSHED_UP_M: f64 = 0.15;
/// so many others are found where they were,
const FITTING_OTHERS: usize = 2;
/// and it stays as wide, up to this factor.
const SAME_SIZE: f64 = 1.5;
/// Bodies of one thing in two frames that follow each other are never farther apart (m): what the gate is asked about.
const REACH_M: f64 = 0.3;
/// What drift, as the graph knows it, adds to that for what was not seen for long, in standard deviations,
const DRIFT_SIGMAS: f64 = 3.0;
/// up to here (m): where it is larger, several objects together have to say the place.
const MOST_REACH_M: f64 = 2.0;
/// Boxes that overlap by so much may be in one direction.
const ALIGNED: f64 = 0.1;
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
/// A box that overlaps an object's by so much may show it, wherever the points in it are.
const SAME_BOX: f64 = 0.6;
/// The box says that it is another object where it overlaps that one's by so much more.
const BETTER_OVERLAP: f64 = 0.1;
/// What was measured in a box explains it so much better than the object that it was given does, or less.
const POORLY: f64 = 0.65;
