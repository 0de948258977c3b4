//! What a sighting changes besides measurements: objects come to count, are merged, and go.

use super::{
    Association, MapObject, Notice, ObjectId, ObjectMap, ObjectState, Sighting,
    association::{Associated, Decision},
    existence::Miss,
    gate::overlap,
};
use crate::{geometry::Ellipsoid, time::Stamp};
use nalgebra::Point3;
use std::collections::BTreeMap;

/// What happened to an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObjectChange {
    /// From now on it counts.
    Confirmed(ObjectId),
    /// It is no longer there.
    Removed(ObjectId),
    /// Two were one: the first stays.
    Merged {
        /// The object that has all measurements now.
        kept: ObjectId,
        /// The identity that is no more.
        gone: ObjectId,
    },
    /// Measurements that had been given to the first were the second's.
    Split {
        /// The object that had them.
        from: ObjectId,
        /// The object that has them.
        into: ObjectId,
    },
}

/// What an object was that has left its place.
#[derive(Clone, Debug)]
pub(super) struct Departed {
    id: ObjectId,
    labels: BTreeMap<String, f64>,
    ellipsoid: Ellipsoid,
    since: Stamp,
}

impl Departed {
    fn new(object: &MapObject, since: Stamp) -> Self {
        Self { id: object.id, labels: object.labels(), ellipsoid: object.ellipsoid(), since }
    }

    fn distance_m(&self, object: &MapObject) -> f64 {
        nalgebra::distance(&self.ellipsoid.center(), &object.estimate().center())
    }
}

impl ObjectMap {
    /// Weighs what was seen and what was missed, after the graph has taken the measurements.
    pub(super) fn live(
        &mut self,
        sighting: &Sighting<'_>,
        associated: &Associated,
        found: &[Option<usize>],
        is_new_view: bool,
        notices: &mut Vec<Notice>,
    ) -> Vec<ObjectChange> {
        let mut seen: Vec<usize> = found.iter().copied().flatten().collect();
        seen.sort_unstable();
        seen.dedup();
        self.count_neighbours(&seen);
        for at in &seen {
            let company = &mut self.objects[*at].company;
            company.see(associated.crowded.contains(at));
            if !associated.contradicted.contains(at) {
                company.judge(true);
            }
        }
        for at in &associated.contradicted {
            self.objects[*at].company.judge(false);
        }
        let map_from_base = self.map_from_odom() * sighting.odom_from_base;
        let eye = map_from_base.translation.vector.into();
        self.weigh(associated, &seen, (sighting.stamp, is_new_view, eye), notices);
        let seen: Vec<ObjectId> = seen.into_iter().map(|at| self.objects[at].id).collect();
        let mut changes = Vec::new();
        self.settle(sighting.stamp, &mut changes);
        self.departed
            .retain(|departed| sighting.stamp.seconds_since(departed.since) < DEPARTED_FOR_S);
        if self.settings.association == Association::Automatic {
            self.merge_duplicates(&seen, &mut changes);
            self.split_fresh(&mut changes);
            self.find_moved(sighting, &mut changes);
        }
        changes
    }

    /// Objects with boxes of their own in one image are different.
    fn count_neighbours(&mut self, seen: &[usize]) {
        for (a, b) in seen.iter().flat_map(|a| seen.iter().map(move |b| (*a, *b))) {
            let apart = self.objects[a].estimate().center() - self.objects[b].estimate().center();
            if a != b && apart.norm() < NEIGHBOUR_M {
                let other = self.objects[b].id;
                *self.objects[a].company.beside.entry(other).or_default() += 1;
            }
        }
    }

    /// Which objects were found, and which should have been. Where one looks through the places of most of what should be
    /// visible, it is the robot that is elsewhere: furniture does not leave at once. Then nothing was missed.
    fn weigh(
        &mut self,
        associated: &Associated,
        seen: &[usize],
        (now, is_new_view, eye): (Stamp, bool, Point3<f64>),
        notices: &mut Vec<Notice>,
    ) {
        let expected: Vec<bool> = associated
            .prospects
            .iter()
            .filter(|(at, prospect)| {
                let object = &self.objects[**at];
                object.counts() && !object.moves && prospect.is_visible()
            })
            .map(|(at, prospect)| {
                !seen.contains(at) && self.objects[*at].existence.is_empty(prospect)
            })
            .collect();
        let empty = expected.iter().filter(|is_empty| **is_empty).count();
        let is_lost = expected.len() >= FEW && 2 * empty >= expected.len();
        if is_lost {
            notices.push(Notice::MostlyEmpty { empty, expected: expected.len() });
        }
        let is_open = |d: &Decision| matches!(d, Decision::Wait | Decision::Displaced(_));
        let is_clear = !associated.decisions.iter().any(is_open);
        let found: Vec<Ellipsoid> = seen.iter().map(|at| *self.objects[*at].estimate()).collect();
        for (at, prospect) in associated.prospects.iter().filter(|(_, p)| p.is_visible()) {
            if self.objects[*at].locked {
                continue;
            }
            let existence = &mut self.objects[*at].existence;
            if seen.contains(at) {
                existence.found(prospect);
            } else if !is_lost && (is_clear || !associated.shown.contains(at)) {
                let of_others = prospect.share_of(&found);
                let miss = Miss { prospect, of_others, now, is_new_view, eye };
                existence.missed(&miss, &self.settings.life);
            }
        }
    }

    /// Takes the states that follow, and takes out what is gone.
    fn settle(&mut self, now: Stamp, changes: &mut Vec<ObjectChange>) {
        let (needed, life) = (self.settings.min_observations, self.settings.life);
        let mut gone = Vec::new();
        for object in self.objects.iter_mut().filter(|object| !object.locked) {
            let before = object.state();
            // What nobody knows the place of is not on the map.
            let is_given = self.settings.association == Association::Given;
            let is_placed = object.is_placed() || is_given && !object.is_glimpsed();
            let needed = match (is_placed, object.is_glimpsed()) {
                (true, false) => needed,
                (true, true) if object.stands() => needed,
                (true, true) => needed.saturating_add(MORE_GLIMPSES),
                (false, _) => u32::MAX,
            };
            if is_given {
                if object.observations >= needed {
                    object.existence.state = ObjectState::Confirmed;
                }
            } else if !object.existence.settle(object.observations, needed, &life) {
                gone.push(object.id);
            }
            // Nothing speaks against what is out of the depth camera's reach: it is forgotten.
            let is_vague = object.is_glimpsed() && !object.counts();
            // Nobody knows where a person is who left the image a minute ago.
            if (is_vague || object.moves) && now.seconds_since(object.last_seen) > GLIMPSE_S {
                gone.push(object.id);
            }
            if before == ObjectState::Tentative && object.counts() {
                changes.push(ObjectChange::Confirmed(object.id));
            }
        }
        for id in gone {
            let departed = self.position(id).map(|at| &self.objects[at]);
            let departed = departed.filter(|object| object.counts() && !object.moves);
            let departed = departed.map(|object| Departed::new(object, now));
            if self.remove(id).is_ok() && departed.is_some() {
                self.departed.extend(departed);
                changes.push(ObjectChange::Removed(id));
            }
        }
    }

    /// Merges each of these with what is the same thing.
    fn merge_duplicates(&mut self, ids: &[ObjectId], changes: &mut Vec<ObjectChange>) {
        for id in ids {
            let Some(at) = self.position(*id) else { continue };
            let other = (0..self.objects.len()).find(|other| self.are_one(at, *other));
            if let Some(other) = other {
                let (a, b) = (&self.objects[at], &self.objects[other]);
                // The one that is locked, the one that counts, then the one that is known for longer.
                let order = |o: &MapObject| (!o.locked, !o.counts(), o.id);
                let (kept, gone) = if order(a) < order(b) { (a.id, b.id) } else { (b.id, a.id) };
                let counted = self.position(gone).is_some_and(|at| self.objects[at].counts());
                if self.merge(kept, gone).is_ok() && counted {
                    changes.push(ObjectChange::Merged { kept, gone });
                }
            }
        }
    }

    /// Gives what has come to count the measurements that its neighbours had of it.
    fn split_fresh(&mut self, changes: &mut Vec<ObjectChange>) {
        let fresh: Vec<ObjectId> = changes
            .iter()
            .filter_map(|c| match c {
                ObjectChange::Confirmed(id) => Some(*id),
                _ => None,
            })
            .collect();
        for into in fresh {
            let Some(at) = self.position(into) else { continue };
            // Where a glimpse is says little about whose it is.
            let is_measured = |id: &ObjectId| {
                self.position(*id).is_some_and(|at| !self.objects[at].is_glimpsed())
            };
            let neighbours = self.objects[at].company.beside.keys().copied();
            let measured: Vec<ObjectId> = neighbours.filter(is_measured).collect();
            for from in measured {
                if self.split(from, into).is_ok_and(|moved| moved > 0) {
                    changes.push(ObjectChange::Split { from, into });
                }
            }
        }
    }

    /// Whether two objects are the same thing: in one place, with names that detectors confuse, and hardly ever seen
    /// side by side. What fills the same space is the same whatever it is called. Where one was only glimpsed nobody knows
    /// how far off it is: there the same boxes do instead of the same place.
    fn are_one(&self, a: usize, b: usize) -> bool {
        let (a, b) = (&self.objects[a], &self.objects[b]);
        let apart_m = (a.estimate().center() - b.estimate().center()).norm();
        let reach_m = a.estimate().semi_axes.norm() + b.estimate().semi_axes.norm();
        if a.id == b.id || apart_m > reach_m.max(NEIGHBOUR_M) {
            return false;
        }
        let beside = a.company.beside.get(&b.id).copied().unwrap_or(0);
        let often = f64::from(beside) / f64::from(a.observations.min(b.observations).max(1));
        if often > BESIDE_IN_EACH_OTHER {
            return false;
        }
        let labels = &self.settings.labels;
        let is_alike = labels.is_alike(labels.cost_of_same(a.belief(), b.belief()));
        let shows = |glimpsed: &MapObject, other: &MapObject| {
            other.counts() && glimpsed.is_only_glimpsed_as(other, &self.graph)
        };
        let is_never_beside = apart_m < NEIGHBOUR_M && beside == 0;
        if is_never_beside && is_alike && (shows(a, b) || shows(b, a)) {
            return true;
        }
        let (of_smaller, of_both) = overlap(a.estimate(), b.estimate());
        if often > BESIDE && of_smaller < IN_EACH_OTHER {
            return false;
        }
        // What does not count may have begun with a wrong measurement, and of a glimpse nobody knows which space it fills.
        let is_vague = a.is_glimpsed() || b.is_glimpsed();
        let is_sure = !is_vague && a.counts() && b.counts();
        let needed = if beside == 0 && is_sure { NEVER_APART } else { SAME_PLACE };
        !is_vague && of_both > SAME_SPACE || is_alike && of_smaller > needed
    }

    /// Gives what has come to count the identity of what has left its place lately, if it is like it: of several the nearest.
    fn find_moved(&mut self, sighting: &Sighting<'_>, changes: &mut Vec<ObjectChange>) {
        if !self.settings.life.moved_keeps_id || self.departed.is_empty() {
            return;
        }
        for at in 0..self.objects.len() {
            let object = &self.objects[at];
            // It may have been seen at its new place before one looked at the old one.
            let age = sighting.stamp.seconds_since(object.first_seen);
            if !object.counts() || object.locked || age > MOVED_WITHIN_S {
                continue;
            }
            let alike = (0..self.departed.len())
                .filter(|d| self.is_like(object, &self.departed[*d]))
                .map(|d| (self.departed[d].distance_m(object), d));
            let Some((_, nearest)) = alike.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
            let (kept, gone) = (self.departed.remove(nearest).id, object.id);
            self.objects[at].id = kept;
            changes.retain(|change| *change != ObjectChange::Confirmed(gone));
            changes.push(ObjectChange::Merged { kept, gone });
        }
    }

    fn is_like(&self, object: &MapObject, departed: &Departed) -> bool {
        let labels = &self.settings.labels;
        let sizes = object.ellipsoid().semi_axes.component_div(&departed.ellipsoid.semi_axes);
        object.id > departed.id
            && departed.distance_m(object) < DEPARTED_WITHIN_M
            && labels.is_alike(labels.cost_of_same(object.belief(), &departed.labels))
            && sizes.iter().all(|ratio| ratio.ln().abs() < SAME_SIZE.ln())
    }
}

/// Objects farther apart are not asked whether they are the same (m).
const NEIGHBOUR_M: f64 = 2.0;
/// Detectors give two boxes for one thing now and then: that seldom, as a share of the measurements.
const BESIDE: f64 = 0.25;
/// Things of which one has so much of itself in the other,
const IN_EACH_OTHER: f64 = 0.6;
/// where two boxes for one thing come more often: half of it has boxes of its own.
const BESIDE_IN_EACH_OTHER: f64 = 0.5;
/// Overlap, as a share of the smaller, of things that may be the same.
const SAME_PLACE: f64 = 0.4;
/// The same for things that were never seen side by side.
const NEVER_APART: f64 = 0.2;
/// Overlap, as a share of both together, of things that are the same.
const SAME_SPACE: f64 = 0.45;
/// Glimpses that are needed besides where no floor says how far off it is: they are much surer of a place together than one
/// by one.
const MORE_GLIMPSES: u32 = 2;
/// Where there are too few glimpses to place an object, they are remembered for so long (s).
const GLIMPSE_S: f64 = 60.0;
/// What was moved is as large as it was, up to this factor.
const SAME_SIZE: f64 = 1.35;
/// Things are carried about within a home (m), in one go: what was gone for longer (s) does not come back as what it was.
const DEPARTED_WITHIN_M: f64 = 10.0;
const DEPARTED_FOR_S: f64 = 600.0;
/// Of fewer objects than this, most may be carried away at once.
const FEW: usize = 3;
/// It is found at its new place so long before it is missed at the old one (s).
const MOVED_WITHIN_S: f64 = 120.0;
