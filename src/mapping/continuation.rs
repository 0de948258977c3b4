//! A map that is continued: what is seen has a frame of its own until its place in the saved map is recognised.
//!
//! A map of few objects is hardly ever recognised: chance explains what is seen as well. It is entered where the robot is
//! said to start. Without that it is set aside as soon as more is known than it says, and what was seen is the map.

use super::{
    Constellation, ExpectedPlace, Landmark, MapObject, NotRelocalised, ObjectChange, ObjectId,
    ObjectMap, RelocalisationSettings, Relocalised, SavedMap, loop_closing::expected_about,
};
use crate::geometry::Pose;
use nalgebra::Vector4;

/// A saved map that waits for its place to be recognised.
#[derive(Clone, Debug)]
pub struct Continuation {
    saved: SavedMap,
    constellation: Constellation,
    /// Where the robot starts: `map_from_base`, if that is known.
    start: Option<Pose>,
    expected: Option<ExpectedPlace>,
    /// Keyframes at the latest attempt.
    tried: usize,
    latest: NotRelocalised,
}

impl Continuation {
    /// The saved map, and where the robot is in it at the first frame (`map_from_base`) as far as that is known.
    pub fn new(saved: SavedMap, start: Option<Pose>, settings: RelocalisationSettings) -> Self {
        let landmarks: Vec<Landmark> = saved.objects.iter().map(|o| o.landmark()).collect();
        Self {
            constellation: Constellation::new(&landmarks, settings),
            saved,
            start,
            expected: None,
            tried: 0,
            latest: NotRelocalised::TooFewObjects { seen: 0, needed: 1 },
        }
    }

    /// The saved map, as it was.
    pub fn saved(&self) -> &SavedMap {
        &self.saved
    }

    /// The saved map, as it was.
    pub fn into_saved(self) -> SavedMap {
        self.saved
    }

    /// Why the place is not known yet.
    pub fn why(&self) -> &NotRelocalised {
        &self.latest
    }

    /// Whether the saved map has so few objects that it cannot be waited for.
    pub fn is_sparse(&self) -> bool {
        self.saved.objects.len() < FEW_OBJECTS
    }

    /// Whether `map` says more than the saved one, which then is set aside: it has few objects, its place was not
    /// recognised, and nobody knows where the robot started in it. At the end of a run, one object more is enough.
    pub fn is_outgrown_by(&self, map: &ObjectMap, is_last: bool) -> bool {
        let needed = if is_last { self.saved.objects.len() + 1 } else { FEW_OBJECTS };
        self.is_sparse() && self.expected.is_none() && map.lasting().count() >= needed
    }

    /// Somebody says where the robot is in the saved map: `map_from_base`. It is looked for there; what was seen so far, in
    /// which the base is at `seen_from_base` (nothing before the first image), moves there for the time being.
    pub fn place(&mut self, map: &mut ObjectMap, said: &Pose, seen_from_base: Option<Pose>) {
        let Some(seen_from_base) = seen_from_base else {
            self.start = Some(*said);
            return;
        };
        map.move_map(&(said * seen_from_base.inverse()));
        self.start = None;
        self.expect_robot_at(said);
    }

    /// What was seen has been moved to where the robot is said to be.
    fn expect_robot_at(&mut self, said: &Pose) {
        let sigmas = Vector4::new(START_YAW_RAD, START_M, START_M, START_M);
        self.expected = Some(expected_about(&said.translation.vector, &sigmas));
    }

    /// Looks whether the place can be recognised by now; if so, `map` has become a part of the saved one, in whose frame
    /// it is from now on. Objects that are in both have the saved identity.
    pub fn attempt(
        &mut self,
        map: &mut ObjectMap,
        is_last: bool,
    ) -> Option<(Relocalised, Vec<ObjectChange>)> {
        if let Some(start) = self.start.take().filter(|_| map.keyframes() > 0) {
            let map_from_seen = start * map.first_pose().inverse();
            map.move_map(&map_from_seen);
            self.expect_robot_at(&start);
        }
        if !is_last && map.keyframes() < self.tried + KEYFRAMES_BETWEEN_ATTEMPTS {
            return None;
        }
        self.tried = map.keyframes();
        let (ids, seen): (Vec<ObjectId>, Vec<Landmark>) =
            map.lasting().map(|object| (object.id, Landmark::from(object))).unzip();
        let found = match self.constellation.locate(&seen, self.expected.as_ref()) {
            Ok(found) => found,
            Err(why) => {
                self.latest = why;
                self.told_place(&seen, is_last)?
            }
        };
        let same = found.matches.iter().map(|(s, k)| (ids[*s], self.saved.objects[*k].id));
        let same: Vec<_> = same.map(|(seen, known)| (seen, ObjectId(known))).collect();
        let changes = map.enter(&self.saved, &found.map_from_seen, &same)?;
        Some((found, changes))
    }

    /// The place in a map of few objects, where the robot is said to have started: once something in it is seen, or after
    /// so much time that it would have been.
    fn told_place(&self, seen: &[Landmark], is_last: bool) -> Option<Relocalised> {
        let expected = self.expected.as_ref().filter(|_| self.is_sparse())?;
        let place = self.constellation.place_near(seen, expected)?;
        let is_ripe = is_last || self.tried >= KEYFRAMES_OF_TRUST;
        (is_ripe || !place.matches.is_empty()).then_some(place)
    }
}

impl ObjectMap {
    /// New objects get identities above those of a saved map.
    pub fn continuing(mut self, saved: &SavedMap) -> Self {
        let highest = saved.objects.iter().map(|object| object.id).max();
        self.last_id = self.last_id.max(highest.unwrap_or(0));
        self
    }

    /// Where the robot was at the first keyframe.
    pub(super) fn first_pose(&self) -> Pose {
        self.chain.first(&self.graph).unwrap_or_default()
    }

    /// Gives everything in another frame.
    pub(super) fn move_map(&mut self, new_from_old: &Pose) {
        self.graph.move_map(new_from_old);
        self.chain.move_map(new_from_old);
        self.objects.iter_mut().for_each(|object| object.move_map(new_from_old));
    }

    /// Becomes a part of a saved map: everything moves to its frame, its objects join as priors, and those that are the
    /// same are merged into the saved ones. Returns what was merged; nothing if the graph could not be solved, and then
    /// all is as it was.
    fn enter(
        &mut self,
        saved: &SavedMap,
        map_from_seen: &Pose,
        same: &[(ObjectId, ObjectId)],
    ) -> Option<Vec<ObjectChange>> {
        let known = self.objects.len();
        self.move_map(map_from_seen);
        for object in &saved.objects {
            let Ok(object) = MapObject::remembered(object, &mut self.graph, &self.slam) else {
                continue;
            };
            self.objects.push(object);
        }
        if self.graph.update().is_err() {
            self.graph.discard();
            self.objects.truncate(known);
            self.move_map(&map_from_seen.inverse());
            return None;
        }
        let mut changes = Vec::new();
        for (gone, kept) in same.iter().copied() {
            // One that cannot be merged stays beside the other, where association may still find it.
            if self.merge(kept, gone).is_ok() {
                changes.push(ObjectChange::Merged { kept, gone });
            }
        }
        // Only now: the objects of the saved map hold the poses. One alone would let them turn about it.
        if same.len() >= HOLDING_OBJECTS {
            self.chain.loosen(&mut self.graph);
        }
        // OK because the merged objects determine the poses that the first one's prior determined before.
        let _ = self.graph.optimize(MAX_ITERATIONS, DECREASE);
        self.objects.sort_by_key(|object| object.id);
        self.refresh([].into_iter());
        Some(changes)
    }
}

/// New keyframes after which it is tried again.
const KEYFRAMES_BETWEEN_ATTEMPTS: usize = 3;
/// No place is recognised in a map of fewer objects than these: three have to fit, and any of them may have been moved.
const FEW_OBJECTS: usize = 5;
/// After so many keyframes without anything of a map of few objects, the robot is believed to be where it was put.
const KEYFRAMES_OF_TRUST: usize = 30;
/// Objects that determine poses without a prior of the first one.
const HOLDING_OBJECTS: usize = 2;
/// How well people know where they have put a robot (m).
const START_M: f64 = 0.3;
/// The same for its heading (rad).
const START_YAW_RAD: f64 = 0.2;
const MAX_ITERATIONS: usize = 10;
const DECREASE: f64 = 1e-4;
