//! What was known of objects at each time.

use super::rounded;
use crate::{
    geometry::{Outline, Pose, yaw_of},
    mapping::{MapObject, ObjectId},
};
use serde::Serialize;
use std::collections::BTreeMap;

/// A change of less is not written down: of place (m), turn (rad), size (m), standard deviation (rad, m, or a share of the size).
const TOLERANCE: [f64; 4] = [0.004, 0.01, 0.004, 0.01];
/// Changes of all objects, at most; then changes have to be twice as large.
const MAX_STATES: usize = 25_000;

/// An object over time.
#[derive(Debug, Serialize)]
pub(super) struct Track {
    label: String,
    outline: Outline,
    /// `[t, x, y, z, yaw, a, b, c]` from time `t` on with standard deviations as they were known then: of the heading (rad), of
    /// the place along the object's own axes (m), and of each semi-axis as a share of it. Or `[t]` alone: it is not in the map
    /// any more.
    states: Vec<Vec<f64>>,
}

/// All objects that ever counted.
#[derive(Debug)]
pub(super) struct Tracks {
    by_object: BTreeMap<ObjectId, Track>,
    states: usize,
    tolerance: f64,
}

impl Tracks {
    pub(super) fn new() -> Self {
        Self { by_object: BTreeMap::new(), states: 0, tolerance: 1.0 }
    }

    /// Takes note of the objects at a time.
    pub(super) fn note<'a>(&mut self, t: f64, objects: impl Iterator<Item = &'a MapObject>) {
        let now: BTreeMap<ObjectId, &MapObject> =
            objects.map(|object| (object.id, object)).collect();
        for (id, track) in &mut self.by_object {
            if !now.contains_key(id) && track.states.last().is_some_and(|state| state.len() > 1) {
                track.states.push(vec![rounded(t)]);
                self.states += 1;
            }
        }
        for (id, object) in now {
            let new = || Track {
                label: object.label().to_owned(),
                outline: object.outline,
                states: Vec::new(),
            };
            let track = self.by_object.entry(id).or_insert_with(new);
            let state = state(t, object);
            if track.states.last().is_none_or(|last| differs(last, &state, self.tolerance)) {
                object.label().clone_into(&mut track.label);
                track.states.push(state);
                self.states += 1;
            }
        }
        if self.states > MAX_STATES {
            self.thin();
        }
    }

    fn thin(&mut self) {
        self.tolerance *= 2.0;
        for track in self.by_object.values_mut() {
            let mut kept: Vec<Vec<f64>> = Vec::new();
            for state in track.states.drain(..) {
                if kept.last().is_none_or(|last| differs(last, &state, self.tolerance)) {
                    kept.push(state);
                }
            }
            track.states = kept;
        }
        self.states = self.by_object.values().map(|track| track.states.len()).sum();
    }

    /// The map got another frame.
    pub(super) fn move_map(&mut self, new_from_old: &Pose) {
        let states = self.by_object.values_mut().flat_map(|track| &mut track.states);
        for state in states.filter(|state| state.len() > 1) {
            let at = new_from_old * nalgebra::Point3::new(state[1], state[2], state[3]);
            (state[1], state[2], state[3]) = (rounded(at.x), rounded(at.y), rounded(at.z));
            state[4] = rounded(state[4] + yaw_of(new_from_old));
        }
    }

    /// How much changes had to be for the sake of the size, beside what is always left out.
    pub(super) fn coarseness(&self) -> f64 {
        self.tolerance
    }

    pub(super) fn finish(self) -> BTreeMap<u64, Track> {
        self.by_object.into_iter().map(|(id, track)| (id.0, track)).collect()
    }
}

fn state(t: f64, object: &MapObject) -> Vec<f64> {
    let (body, covariance) = (object.ellipsoid(), object.covariance());
    let (at, half) = (body.center(), body.semi_axes);
    let known = [t, at.x, at.y, at.z, yaw_of(&body.pose), half.x, half.y, half.z];
    let sigmas = (2..9).map(|index| covariance[(index, index)].max(0.0).sqrt());
    known.into_iter().chain(sigmas).map(rounded).collect()
}

fn differs(a: &[f64], b: &[f64], tolerance: f64) -> bool {
    let [place, turn, size, sigma] = TOLERANCE.map(|least| least * tolerance);
    let limits = [f64::INFINITY, place, place, place, turn, size, size, size];
    let limits = limits.into_iter().chain([sigma; 7]);
    a.len() != b.len() || a.iter().zip(b).zip(limits).any(|((a, b), limit)| (a - b).abs() > limit)
}
