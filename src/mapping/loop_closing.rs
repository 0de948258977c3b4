//! Loops that association cannot close: odometry has drifted so far that what was seen long ago looks new.

use super::{
    Constellation, ExpectedPlace, Landmark, MapObject, ObjectChange, ObjectId, ObjectMap,
    RelocalisationSettings, Relocalised,
};
use crate::{
    geometry::Pose,
    graph::{Noise, PoseId, RelativePose},
    time::Stamp,
};
use nalgebra::{Matrix4, Vector3, Vector4};

impl ObjectMap {
    /// Looks whether objects that were seen first of late are all displaced by the same motion from objects of long ago; if so
    /// they are merged, and the way between bends. Returns what was merged.
    pub fn close_loop(&mut self, settings: &RelocalisationSettings) -> Vec<ObjectChange> {
        let keyframes = self.chain.count();
        if !self.slam.optimize_poses || keyframes < self.loop_tried + KEYFRAMES_BETWEEN_ATTEMPTS {
            return Vec::new();
        }
        self.loop_tried = keyframes;
        let Some(since) = self.chain.stamp_before(RECENT_KEYFRAMES) else { return Vec::new() };
        let pick = |is_picked: &dyn Fn(&MapObject) -> bool| -> (Vec<ObjectId>, Vec<Landmark>) {
            let picked = self.lasting().filter(|object| is_picked(object));
            picked.map(|object| (object.id, Landmark::from(object))).unzip()
        };
        let (recent_ids, recent) = pick(&|object| object.first_seen >= since);
        let (old_ids, old) = pick(&|object| object.last_seen < since);
        let settings = RelocalisationSettings { elsewhere_probability: NO_LOOP, ..*settings };
        let expected = expected(&recent);
        let Ok(found) = Constellation::new(&old, settings).locate(&recent, Some(&expected)) else {
            return Vec::new();
        };
        let pairs = found.matches.iter().map(|(s, k)| (old_ids[*k], recent_ids[*s]));
        let pairs: Vec<(ObjectId, ObjectId)> = pairs.collect();
        self.bend(&found, &pairs, since)
    }

    /// Puts the latest pose where it was recognised, lets the graph bend the way there, and merges what is the same.
    fn bend(
        &mut self,
        found: &Relocalised,
        pairs: &[(ObjectId, ObjectId)],
        since: Stamp,
    ) -> Vec<ObjectChange> {
        let seen_by = pairs.iter().filter_map(|(old, _)| {
            Some(self.objects[self.position(*old)?].last_seen).filter(|stamp| *stamp < since)
        });
        let ends = seen_by.max().and_then(|stamp| self.chain.at(stamp)).zip(self.chain.last());
        let Some((from, to)) = ends else { return Vec::new() };
        let closure =
            self.closure(from, to, &found.map_from_seen).map(|f| self.graph.add_factor(f));
        // Objects alone do not pull the way round: to a robust kernel, what is a metre off is an outlier.
        if self.graph.optimize(MAX_ITERATIONS, DECREASE).is_err() {
            return Vec::new();
        }
        let mut changes = Vec::new();
        for (kept, gone) in pairs.iter().copied() {
            if self.merge(kept, gone).is_ok() {
                changes.push(ObjectChange::Merged { kept, gone });
            }
        }
        // From now on the objects say it, and their measurements must not count twice.
        closure.into_iter().for_each(|factor| self.graph.remove_factor(factor));
        // OK because odometry holds all poses without it.
        let _ = self.graph.optimize(MAX_ITERATIONS, DECREASE);
        self.refresh(0..self.objects.len());
        changes
    }

    /// The step between two poses if the second one is moved.
    fn closure(&self, from: PoseId, to: PoseId, moved: &Pose) -> Option<RelativePose> {
        let step = self.graph.pose(from).inv_mul(&(moved * self.graph.pose(to)));
        Some(RelativePose::new(from, to, &step, Noise::from_sigmas(CLOSURE).ok()?))
    }
}

/// Drift turns and moves what was seen about where the robot is, not about the map's origin.
fn expected(recent: &[Landmark]) -> ExpectedPlace {
    let sum: Vector3<f64> = recent.iter().map(|l| l.ellipsoid.center().coords).sum();
    let pivot = sum / recent.len().max(1) as f64;
    expected_about(&pivot, &DRIFT)
}

/// What was seen is where it is, up to a turn about this point and a shift, with standard deviations of heading and place
/// (rad, m).
pub(super) fn expected_about(pivot: &Vector3<f64>, sigmas: &Vector4<f64>) -> ExpectedPlace {
    let mut about_pivot = Matrix4::identity();
    (about_pivot[(1, 0)], about_pivot[(2, 0)]) = (pivot.y, -pivot.x);
    let own = Matrix4::from_diagonal(&sigmas.component_mul(sigmas));
    let covariance = about_pivot * own * about_pivot.transpose();
    ExpectedPlace { pose: Pose::identity(), covariance }
}

/// New keyframes after which it is tried again.
const KEYFRAMES_BETWEEN_ATTEMPTS: usize = 5;
/// What was seen within so many keyframes is recent.
pub(super) const RECENT_KEYFRAMES: usize = 50;
/// Probability beforehand that there is no loop to close.
const NO_LOOP: f64 = 0.9;
/// What drift there may be (rad, m).
const DRIFT: Vector4<f64> = Vector4::new(0.3, 1.5, 1.5, 0.1);
/// How exactly the way is bent before the objects take over (rad, m).
const CLOSURE: [f64; 6] = [0.02, 0.02, 0.03, 0.1, 0.1, 0.05];
const MAX_ITERATIONS: usize = 15;
const DECREASE: f64 = 1e-4;
