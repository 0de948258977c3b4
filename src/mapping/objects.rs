//! The map: objects and poses in one graph.

use super::{
    Association, GateSettings, LabelSettings, LifeSettings, MapObject, Notice, ObjectChange,
    ObjectId, Observation, Sighting, SlamSettings, WallSighting,
    association::{Associated, Decision, Evidence},
    displacement::Displacement,
    gate::{KnownPose, Step},
    initial::InitialViews,
    life::Departed,
    loop_closing::RECENT_KEYFRAMES,
    odometry::{Chain, Place},
    walls::Walls,
};
use crate::{
    geometry::{Pose, Wall},
    graph::{Graph, NoiseError, PoseId},
    time::Stamp,
};
use nalgebra::{Matrix6, Point2};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Which measurements are one object, and when it counts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MappingSettings {
    /// Measurements after which an object counts.
    pub min_observations: u32,
    /// Who decides which measurements belong together; for tests and experiments, so not in the configuration.
    #[serde(skip)]
    pub association: Association,
    /// Which measurements belong together.
    pub gate: GateSettings,
    /// How classes are confused.
    pub labels: LabelSettings,
    /// When an object counts, and when it is gone.
    pub life: LifeSettings,
}

impl Default for MappingSettings {
    fn default() -> Self {
        Self {
            min_observations: 3,
            association: Association::default(),
            gate: GateSettings::default(),
            labels: LabelSettings::default(),
            life: LifeSettings::default(),
        }
    }
}

/// All objects, in the order in which they were first seen, and the poses they were seen from.
#[derive(Debug)]
pub struct ObjectMap {
    pub(super) settings: MappingSettings,
    pub(super) slam: SlamSettings,
    pub(super) graph: Graph,
    pub(super) chain: Chain,
    walls: Walls,
    pub(super) objects: Vec<MapObject>,
    /// What counted and has left its place.
    pub(super) departed: Vec<Departed>,
    /// What was seen too seldom to be an object, where only boxes count.
    initial: BTreeMap<u64, InitialViews>,
    pub(super) last_id: u64,
    /// Keyframes when it was last tried to close a loop.
    pub(super) loop_tried: usize,
}

/// What came of a sighting.
#[derive(Clone, Debug, PartialEq)]
pub struct Sighted {
    /// The object of each observation, in order; none where it was left out.
    pub objects: Vec<Option<ObjectId>>,
    /// What happened to objects that count, in order.
    pub changes: Vec<ObjectChange>,
    /// What was doubted.
    pub notices: Vec<Notice>,
    /// Why the graph could not use the sighting, if it could not.
    pub refused: Option<String>,
}

impl ObjectMap {
    /// An empty map.
    pub fn new(settings: MappingSettings, slam: SlamSettings) -> Self {
        Self {
            settings,
            slam,
            graph: Graph::new(slam.solver),
            chain: Chain::default(),
            walls: Walls::default(),
            objects: Vec::new(),
            departed: Vec::new(),
            initial: BTreeMap::new(),
            last_id: 0,
            loop_tried: 0,
        }
    }

    /// From now on these settings count; factors that are there stay as they are.
    pub fn change_settings(&mut self, settings: MappingSettings, slam: SlamSettings) {
        self.graph.change_settings(slam.solver);
        (self.settings, self.slam) = (settings, slam);
    }

    /// Joins what one keyframe saw: decides what it is and which factors it gives. Liao et al. 2020, section V.
    pub fn observe(&mut self, sighting: &Sighting<'_>) -> Sighted {
        let mut notices = Vec::new();
        match without_unusable(sighting, &mut notices) {
            None => self.take(sighting, notices),
            Some(sighting) => self.take(&sighting, notices),
        }
    }

    fn take(&mut self, sighting: &Sighting<'_>, mut notices: Vec<Notice>) -> Sighted {
        let (objects, keyframes) = (self.objects.len(), self.chain.count());
        let mut before = Vec::new();
        match self.join(sighting, &mut before) {
            Ok((associated, found)) => {
                let ids = found.iter().map(|at| at.map(|at| self.objects[at].id)).collect();
                let is_new_view = self.chain.count() > keyframes;
                let changes = self.live(sighting, &associated, &found, is_new_view, &mut notices);
                Sighted { objects: renamed(ids, &changes), changes, notices, refused: None }
            }
            Err(refused) => {
                self.graph.discard();
                self.chain.truncate(keyframes);
                self.objects.truncate(objects);
                before.into_iter().rev().for_each(|(at, object)| self.objects[at] = object);
                let objects = vec![None; sighting.observations.len()];
                let refused = Some(refused.to_string());
                Sighted { objects, changes: Vec::new(), notices, refused }
            }
        }
    }

    /// The measurements' part of [`ObjectMap::observe`]; `before` gets the objects that change, as they were.
    fn join(
        &mut self,
        sighting: &Sighting<'_>,
        before: &mut Vec<(usize, MapObject)>,
    ) -> Result<Joined, Box<dyn std::error::Error>> {
        let (known, keyframes) = (self.objects.len(), self.chain.count());
        let Sighting { stamp, odom_from_base, odometry_covariance, observations, .. } = sighting;
        let covariance = odometry_covariance.as_deref();
        let step = self.chain.step(&self.graph, odom_from_base, covariance, &self.slam);
        let at = (*stamp, odom_from_base);
        let thinned = {
            let waiting = |pose| self.initial.values().any(|views| views.are_from(pose));
            self.chain.thin(&mut self.graph, waiting)?
        };
        let mut loose: Vec<PoseId> = self.chain.last().into_iter().collect();
        let hints = (step.as_ref(), &self.slam);
        let place = self.chain.keyframe(&mut self.graph, at, covariance, hints)?;
        let is_new = self.chain.count() > keyframes && self.slam.optimize_poses && self.slam.walls;
        let walls: &[WallSighting] = if is_new { &sighting.walls } else { &[] };
        let walls = self.walls.tie(&mut self.graph, (&place, step.as_ref()), walls, &self.slam)?;
        let map_from_base = place.map_from_base(&self.graph);
        let associated = self.associated(sighting, step, (place.keyframe.pose, &map_from_base));
        let shown = Displacement::new(self, observations, &associated.decisions, &place);
        let mut found = Vec::with_capacity(observations.len());
        for (of, observation) in observations.iter().enumerate() {
            let decision = &associated.decisions[of];
            let at = match decision {
                Decision::Object(at) | Decision::Anew(at) => Some(*at),
                Decision::Wait => None,
                Decision::Displaced(at) if self.objects[*at].moves => Some(*at),
                Decision::Displaced(at) => {
                    before.push((*at, self.objects[*at].clone()));
                    let forgotten = self.displaced(*at, observation, &place)?;
                    let was_pushed = forgotten.is_some();
                    loose.extend(forgotten.unwrap_or_default());
                    was_pushed.then_some(*at)
                }
                // Another observation of this sighting may have begun it.
                Decision::New => match self.tracked(observation) {
                    Some(at) => Some(at),
                    None => self.begin(*stamp, observation, &place, &map_from_base)?,
                },
            };
            found.push(at);
            let Some(at) = at else { continue };
            let object = &mut self.objects[at];
            before.extend((at < known).then(|| (at, object.clone())));
            if let (Decision::Anew(_), Some(measured)) = (decision, &observation.measured) {
                let in_map = measured.ellipsoid.transformed(&map_from_base);
                loose.extend(object.begin_anew(&mut self.graph, &in_map));
            }
            object.join(*stamp, observation, &map_from_base, &self.settings);
            let looks = object.looks.count();
            loose.extend(object.tie(&mut self.graph, observation, &place, &self.slam)?);
            let of_pose = (object.looks.count() > looks).then(|| shown.of_pose(of)).flatten();
            loose.extend(object.follow_little(&mut self.graph, of_pose)?);
        }
        self.graph.update()?;
        self.chain.forget(thinned);
        loose.extend(self.walls.settle(walls));
        self.chain.note_loose(loose);
        self.refresh(found.iter().copied().flatten());
        for at in found.iter().copied().flatten() {
            self.objects[at].judge_place(&self.graph, place.keyframe.pose);
        }
        Ok((associated, found))
    }

    /// An object is seen where it was not: if that has been so for long enough, it was pushed there. Returns the poses of
    /// what was forgotten for that.
    fn displaced(
        &mut self,
        at: usize,
        observation: &Observation,
        place: &Place,
    ) -> Result<Option<Vec<PoseId>>, NoiseError> {
        let Some(measured) = &observation.measured else { return Ok(None) };
        let in_map = measured.ellipsoid.transformed(&place.map_from_base(&self.graph));
        let object = &mut self.objects[at];
        object.look(&self.graph, (measured, &in_map), place);
        object.follow(&mut self.graph, false)
    }

    /// What each observation is taken for.
    fn associated(
        &self,
        sighting: &Sighting<'_>,
        step: Option<Step>,
        (pose, map_from_base): (PoseId, &Pose),
    ) -> Associated {
        if self.settings.association == Association::Given {
            let known = |o| self.tracked(o).map_or(Decision::New, Decision::Object);
            return Associated::given(sighting.observations.iter().map(known).collect());
        }
        let step = step.unwrap_or(Step {
            pose: None,
            map_from_pose: *map_from_base,
            pose_from_base: Pose::identity(),
            covariance: Matrix6::zeros(),
        });
        let evidence = Evidence {
            objects: &self.objects,
            graph: &self.graph,
            settings: &self.settings,
            step: &step,
            known_pose: step.pose.map(|pose| KnownPose::new(&self.graph, pose)),
            long_ago: self.chain.stamp_before(RECENT_KEYFRAMES),
            pose,
            map_from_base,
            view: sighting.view.as_ref(),
        };
        evidence.associate(&sighting.observations)
    }

    /// Which objects the boxes of a sighting show, without joining them: nothing where that is not clear, or where one
    /// shows something new.
    pub fn recognise(&self, sighting: &Sighting<'_>) -> Vec<Option<ObjectId>> {
        let covariance = sighting.odometry_covariance.as_deref();
        let step = self.chain.step(&self.graph, &sighting.odom_from_base, covariance, &self.slam);
        let Some((pose, step)) = step.and_then(|step| Some((step.pose?, step))) else {
            return vec![None; sighting.observations.len()];
        };
        let map_from_base = step.map_from_pose * step.pose_from_base;
        let associated = self.associated(sighting, Some(step), (pose, &map_from_base));
        let known = |decision| match decision {
            Decision::Object(at) | Decision::Anew(at) => Some(self.objects[at].id),
            Decision::New | Decision::Wait | Decision::Displaced(_) => None,
        };
        associated.decisions.into_iter().map(known).collect()
    }

    /// The object of the same given identity.
    fn tracked(&self, observation: &Observation) -> Option<usize> {
        let track =
            observation.track.filter(|_| self.settings.association == Association::Given)?;
        self.objects.iter().position(|object| object.track == Some(track))
    }

    /// A new object, if the observation suffices for one.
    fn begin(
        &mut self,
        stamp: Stamp,
        observation: &Observation,
        place: &Place,
        map_from_base: &Pose,
    ) -> Result<Option<usize>, Box<dyn std::error::Error>> {
        if self.settings.association == Association::Given && observation.track.is_none() {
            return Ok(None);
        }
        let initial = match &observation.measured {
            Some(measured) if self.slam.observations => {
                measured.ellipsoid.transformed(map_from_base)
            }
            // Boxes alone make an object once there are enough of them, if it is known that they belong together.
            _ => {
                let Some(track) = observation.track.filter(|_| self.slam.boxes) else {
                    return Ok(None);
                };
                let views = self.initial.entry(track).or_default();
                match views.add(&self.graph, place, observation) {
                    Some(initial) => initial,
                    None => return Ok(None),
                }
            }
        };
        self.last_id += 1;
        let id = ObjectId(self.last_id);
        let mut object =
            MapObject::new(id, stamp, observation, (self.graph.add_ellipsoid(initial), &initial));
        let only_boxes = observation.measured.is_none() || !self.slam.observations;
        object.found(&mut self.graph, (observation, &initial), only_boxes, &self.slam)?;
        if let Some(views) = observation.track.and_then(|track| self.initial.remove(&track)) {
            for (place, view) in views.earlier() {
                object.join(stamp, view, map_from_base, &self.settings);
                object.tie(&mut self.graph, view, place, &self.slam)?;
            }
        }
        self.objects.push(object);
        Ok(Some(self.objects.len() - 1))
    }

    /// Takes over what the graph says now.
    pub(super) fn refresh(&mut self, seen: impl Iterator<Item = usize>) {
        self.objects.iter_mut().for_each(|object| object.take_estimate(&self.graph));
        for at in seen {
            self.objects[at].take_covariance(&self.graph, &self.slam);
        }
    }

    /// Solves everything once more and computes all covariances: what ends a run.
    pub fn finish(&mut self) {
        // OK because every update has succeeded before: there is nothing new that could be undetermined.
        let _ = self.graph.optimize(MAX_FINAL_ITERATIONS, FINAL_DECREASE);
        self.refresh(0..self.objects.len());
    }

    /// What corrects odometry now: `map_from_odom`.
    pub fn map_from_odom(&self) -> Pose {
        self.chain.map_from_odom(&self.graph)
    }

    /// What corrects odometry at a time when there were so many keyframes, after all that is known now.
    pub fn map_from_odom_at(&self, stamp: Stamp, keyframes: usize) -> Pose {
        self.chain.map_from_odom_at(&self.graph, stamp, keyframes)
    }

    /// Covariance of the base in the map now, of `[rotation, translation]`, a right perturbation of its pose; nothing
    /// before the first keyframe.
    pub fn base_covariance(&self, odom_from_base: &Pose) -> Option<Matrix6<f64>> {
        self.chain.covariance(&self.graph, odom_from_base, &self.slam)
    }

    /// Keyframes there have been.
    pub fn keyframes(&self) -> usize {
        self.chain.count()
    }

    /// Those of them whose poses the graph still has.
    pub fn poses(&self) -> usize {
        self.chain.kept()
    }

    /// Terms of the graph's cost.
    pub fn factors(&self) -> usize {
        self.graph.factor_count()
    }

    /// Objects that count, in the order in which they were first seen.
    pub fn confirmed(&self) -> impl Iterator<Item = &MapObject> {
        self.objects.iter().filter(|object| object.counts())
    }

    /// Walls that poses are tied to, in the order in which they were first seen.
    pub fn walls(&self) -> impl Iterator<Item = Wall> + '_ {
        self.walls.all(&self.graph)
    }

    /// From where to where each of [`ObjectMap::walls`] has been seen, seen from above (m).
    pub fn wall_ends(&self) -> impl Iterator<Item = [Point2<f64>; 2]> + '_ {
        self.walls.ends(&self.graph)
    }

    /// Those of them that stay where they are: what outlives a run, and what a place is recognised by.
    pub fn lasting(&self) -> impl Iterator<Item = &MapObject> {
        self.confirmed().filter(|object| !object.moves)
    }

    /// All objects, also those seen too seldom to count.
    pub fn all(&self) -> &[MapObject] {
        &self.objects
    }
}

/// What was decided about a sighting, and the object of each observation.
type Joined = (Associated, Vec<Option<usize>>);

/// The sighting without measurements whose covariance is none, if there are any: the other boxes are as good without them.
fn without_unusable<'a>(
    sighting: &Sighting<'a>,
    notices: &mut Vec<Notice>,
) -> Option<Sighting<'a>> {
    let is_unusable = |observation: &Observation| {
        observation.measured.as_ref().is_some_and(|measured| !measured.is_usable())
    };
    let unusable = sighting.observations.iter().filter(|o| is_unusable(o)).count();
    if unusable == 0 {
        return None;
    }
    notices.push(Notice::Unusable { measurements: unusable });
    let mut usable = sighting.clone();
    let measured = usable.observations.iter_mut().filter(|o| is_unusable(o));
    measured.for_each(|observation| observation.measured = None);
    Some(usable)
}

/// Identities after merges.
fn renamed(mut ids: Vec<Option<ObjectId>>, changes: &[ObjectChange]) -> Vec<Option<ObjectId>> {
    for change in changes {
        if let ObjectChange::Merged { kept, gone } = change {
            ids.iter_mut().flatten().filter(|id| **id == *gone).for_each(|id| *id = *kept);
        }
    }
    ids
}

const MAX_FINAL_ITERATIONS: usize = 20;
const FINAL_DECREASE: f64 = 1e-6;
