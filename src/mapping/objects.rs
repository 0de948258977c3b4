//! The map: objects and poses in one graph.

use super::{
    Association, GateSettings, MapObject, ObjectId, Observation, Sighting, SlamSettings,
    association::associate, initial::InitialViews, odometry::Chain,
};
use crate::{
    geometry::{Ellipsoid, Pose},
    graph::{Graph, PoseId},
    time::Stamp,
};
use nalgebra::SMatrix;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Which measurements are one object.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MappingSettings {
    /// Measurements after which an object counts.
    pub min_observations: u32,
    /// Who decides which measurements belong together; for tests and experiments, so not in the configuration.
    #[serde(skip)]
    pub association: Association,
    /// Which measurements belong together.
    pub gate: GateSettings,
}

impl Default for MappingSettings {
    fn default() -> Self {
        Self {
            min_observations: 3,
            association: Association::default(),
            gate: GateSettings::default(),
        }
    }
}

/// All objects, in the order in which they were first seen, and the poses they were seen from.
#[derive(Debug)]
pub struct ObjectMap {
    settings: MappingSettings,
    slam: SlamSettings,
    graph: Graph,
    chain: Chain,
    objects: Vec<MapObject>,
    /// What was seen too seldom to be an object, where only boxes count.
    initial: BTreeMap<u64, InitialViews>,
    last_id: u64,
}

/// What came of a sighting.
#[derive(Clone, Debug, PartialEq)]
pub struct Sighted {
    /// The object of each observation, in order; none where it was left out.
    pub objects: Vec<Option<ObjectId>>,
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
            objects: Vec::new(),
            initial: BTreeMap::new(),
            last_id: 0,
        }
    }

    /// Joins what one keyframe saw: decides what it is and which factors it gives. Liao et al. 2020, section V.
    pub fn observe(&mut self, sighting: &Sighting) -> Sighted {
        let (objects, keyframes) = (self.objects.len(), self.chain.len());
        let mut before = Vec::new();
        match self.join(sighting, &mut before) {
            Ok(objects) => Sighted { objects, refused: None },
            Err(refused) => {
                self.graph.discard();
                self.chain.truncate(keyframes);
                self.objects.truncate(objects);
                before.into_iter().rev().for_each(|(at, object)| self.objects[at] = object);
                let objects = vec![None; sighting.observations.len()];
                Sighted { objects, refused: Some(refused.to_string()) }
            }
        }
    }

    /// What [`ObjectMap::observe`] does; `before` gets the objects that change, as they were.
    fn join(
        &mut self,
        sighting: &Sighting,
        before: &mut Vec<(usize, MapObject)>,
    ) -> Result<Vec<Option<ObjectId>>, Box<dyn std::error::Error>> {
        let known = self.objects.len();
        let Sighting { stamp, odom_from_base, odometry_covariance, observations } = sighting;
        let covariance = odometry_covariance.as_deref();
        let at = (*stamp, odom_from_base);
        let (pose, keyframe_from_base) =
            self.chain.keyframe(&mut self.graph, at, covariance, &self.slam)?;
        let map_from_base = self.graph.pose(pose) * keyframe_from_base;
        let mut found = self.associated(observations, &map_from_base);
        for (observation, found) in observations.iter().zip(&mut found) {
            // Another observation of this sighting may have begun it.
            *found = found.or_else(|| self.tracked(observation));
            if found.is_none() {
                *found =
                    self.begin(*stamp, observation, (pose, &keyframe_from_base), &map_from_base)?;
            }
            let Some(at) = *found else { continue };
            let object = &mut self.objects[at];
            before.extend((at < known).then(|| (at, object.clone())));
            object.join(*stamp, observation, &map_from_base);
            object.tie(&mut self.graph, observation, (pose, &keyframe_from_base), &self.slam)?;
        }
        self.graph.update()?;
        self.refresh(found.iter().copied().flatten());
        Ok(found.into_iter().map(|at| at.map(|at| self.objects[at].id)).collect())
    }

    /// The object of each observation, as far as there is one.
    fn associated(&self, observations: &[Observation], map_from_base: &Pose) -> Vec<Option<usize>> {
        if self.settings.association == Association::Given {
            return observations.iter().map(|o| self.tracked(o)).collect();
        }
        let measured = observations.iter().enumerate().filter_map(|(at, o)| {
            let ellipsoid = o.measured.as_ref()?.ellipsoid.transformed(map_from_base);
            Some((at, (o.labels[0].0.as_str(), ellipsoid)))
        });
        let (places, measured): (Vec<usize>, Vec<(&str, Ellipsoid)>) = measured.unzip();
        let mut found = vec![None; observations.len()];
        for (at, object) in
            places.iter().zip(associate(&self.objects, &measured, &self.settings.gate))
        {
            found[*at] = object;
        }
        found
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
        (pose, keyframe_from_base): (PoseId, &Pose),
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
                let place = (pose, *keyframe_from_base);
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
        object.found(&mut self.graph, &initial, only_boxes, &self.slam)?;
        if let Some(views) = observation.track.and_then(|track| self.initial.remove(&track)) {
            for (place, view) in views.earlier() {
                object.join(stamp, view, map_from_base);
                object.tie(&mut self.graph, view, (place.0, &place.1), &self.slam)?;
            }
        }
        self.objects.push(object);
        Ok(Some(self.objects.len() - 1))
    }

    /// Takes over what the graph says now.
    fn refresh(&mut self, seen: impl Iterator<Item = usize>) {
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

    /// The latest keyframe's pose in the map and its covariance: `[rotation, translation]`, a right perturbation (rad, m).
    pub fn latest_pose(&self) -> Option<(Pose, SMatrix<f64, 6, 6>)> {
        self.chain.latest(&self.graph)
    }

    /// Poses in the graph.
    pub fn keyframes(&self) -> usize {
        self.chain.len()
    }

    /// Objects with enough measurements, in the order in which they were first seen.
    pub fn confirmed(&self) -> impl Iterator<Item = &MapObject> {
        let needed = self.settings.min_observations;
        self.objects.iter().filter(move |o| o.observations >= needed)
    }

    /// All objects, also those seen too seldom to count.
    pub fn all(&self) -> &[MapObject] {
        &self.objects
    }
}

const MAX_FINAL_ITERATIONS: usize = 20;
const FINAL_DECREASE: f64 = 1e-6;
