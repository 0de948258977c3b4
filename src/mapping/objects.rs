//! The map of objects.

use super::{
    Association, FusionSettings, GateSettings, MapObject, ObjectId, association::associate,
    fusion::Estimate,
};
use crate::{
    geometry::{Ellipsoid, Outline},
    time::Stamp,
};
use nalgebra::SMatrix;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How the map is kept.
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
    /// How they are fused.
    pub fusion: FusionSettings,
}

impl Default for MappingSettings {
    fn default() -> Self {
        Self {
            min_observations: 3,
            association: Association::default(),
            gate: GateSettings::default(),
            fusion: FusionSettings::default(),
        }
    }
}

/// A measurement in the map frame.
#[derive(Clone, Debug)]
pub struct Observation {
    /// The detector's labels with their probabilities, most probable first.
    pub labels: Vec<(String, f64)>,
    /// Identity given with the detection.
    pub track: Option<u64>,
    /// The measured ellipsoid in the map frame.
    pub ellipsoid: Ellipsoid,
    /// Covariance of `[rotation, translation, log semi-axes]`.
    pub covariance: SMatrix<f64, 9, 9>,
    /// What fills the object's extents.
    pub outline: Outline,
    /// `P_e` of the paper.
    pub probability: f64,
    /// Height of its support plane in the map frame (m).
    pub support_height_m: Option<f64>,
}

/// All objects, in the order in which they were first seen.
#[derive(Clone, Debug, Default)]
pub struct ObjectMap {
    objects: Vec<MapObject>,
    last_id: u64,
}

impl ObjectMap {
    /// Joins the measurements of one keyframe and returns the object of each, in order; none where identities are
    /// given and a measurement has none.
    pub fn observe(
        &mut self,
        stamp: Stamp,
        observations: &[Observation],
        settings: &MappingSettings,
    ) -> Vec<Option<ObjectId>> {
        let nearest = match settings.association {
            Association::Automatic => self.nearest(observations, &settings.gate),
            Association::Given => vec![None; observations.len()],
        };
        let mut ids = Vec::with_capacity(observations.len());
        for (observation, nearest) in observations.iter().zip(nearest) {
            let found = match (settings.association, observation.track) {
                (Association::Automatic, _) => nearest,
                (Association::Given, Some(track)) => {
                    self.objects.iter().position(|object| object.track == Some(track))
                }
                (Association::Given, None) => {
                    ids.push(None);
                    continue;
                }
            };
            let object = match found {
                Some(at) => &mut self.objects[at],
                None => self.add(stamp, observation),
            };
            if found.is_some() {
                object.estimate.update(
                    &observation.ellipsoid,
                    &observation.covariance,
                    &settings.fusion,
                );
            }
            object.join(stamp, observation);
            ids.push(Some(object.id));
        }
        ids
    }

    /// The object of each measurement by label and distance.
    fn nearest(&self, observations: &[Observation], gate: &GateSettings) -> Vec<Option<usize>> {
        let measured: Vec<(&str, Ellipsoid)> =
            observations.iter().map(|o| (o.labels[0].0.as_str(), o.ellipsoid)).collect();
        associate(&self.objects, &measured, gate)
    }

    /// Objects with enough measurements, in the order in which they were first seen.
    pub fn confirmed(&self, settings: &MappingSettings) -> impl Iterator<Item = &MapObject> {
        let needed = settings.min_observations;
        self.objects.iter().filter(move |o| o.observations >= needed)
    }

    /// All objects, also those seen too seldom to count.
    pub fn all(&self) -> &[MapObject] {
        &self.objects
    }

    fn add(&mut self, stamp: Stamp, first: &Observation) -> &mut MapObject {
        self.last_id += 1;
        self.objects.push(MapObject {
            id: ObjectId(self.last_id),
            track: first.track,
            outline: first.outline,
            observations: 0,
            first_seen: stamp,
            last_seen: stamp,
            support_height_m: None,
            support_heights: 0,
            estimate: Estimate::new(&first.ellipsoid, &first.covariance),
            votes: BTreeMap::new(),
            doubt: 1.0,
        });
        let last = self.objects.len() - 1;
        &mut self.objects[last]
    }
}

impl MapObject {
    fn join(&mut self, stamp: Stamp, observation: &Observation) {
        self.observations += 1;
        self.last_seen = self.last_seen.max(stamp);
        self.doubt = (self.doubt * (1.0 - 0.5 * observation.probability)).max(MIN_DOUBT);
        for (label, probability) in &observation.labels {
            *self.votes.entry(label.clone()).or_default() += probability;
        }
        if let Some(height) = observation.support_height_m {
            self.support_heights += 1;
            let weight = 1.0 / f64::from(self.support_heights);
            let known = self.support_height_m.unwrap_or(height);
            self.support_height_m = Some(known + weight * (height - known));
        }
    }
}

/// Detectors and depth can always be wrong together.
const MIN_DOUBT: f64 = 1e-3;
