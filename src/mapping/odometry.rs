//! The chain of keyframe poses.

use super::SlamSettings;
use crate::{
    geometry::{Pose, interpolate},
    graph::{Graph, Noise, NoiseError, PoseId, PosePrior, RelativePose, step_covariance},
    time::Stamp,
};
use nalgebra::SMatrix;

/// A pose of the graph and the odometry it came with.
#[derive(Clone, Debug)]
struct Keyframe {
    stamp: Stamp,
    pose: PoseId,
    odom_from_base: Pose,
    covariance: Option<Box<[f64; 36]>>,
}

/// All keyframes in the order in which they came.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain {
    keyframes: Vec<Keyframe>,
}

impl Chain {
    /// The keyframe for a pose of odometry, and that pose in the keyframe's frame: the last keyframe as long as the robot
    /// stands still, a new one otherwise.
    pub(super) fn keyframe(
        &mut self,
        graph: &mut Graph,
        (stamp, odom_from_base): (Stamp, &Pose),
        covariance: Option<&[f64; 36]>,
        settings: &SlamSettings,
    ) -> Result<(PoseId, Pose), NoiseError> {
        let last =
            self.keyframes.last().map(|last| (last, last.odom_from_base.inv_mul(odom_from_base)));
        if let Some((last, step)) = last {
            let still = step.translation.vector.norm() < settings.min_translation_m
                && step.rotation.angle() < settings.min_rotation_deg.to_radians();
            if still {
                return Ok((last.pose, step));
            }
        }
        let pose = graph.add_pose(self.map_from_odom(graph) * odom_from_base);
        match last.filter(|_| settings.optimize_poses) {
            None => {
                graph.add_factor(PosePrior::new(pose, *odom_from_base, Noise::from_sigmas(KNOWN)?));
            }
            Some((last, step)) => {
                let from = (&last.odom_from_base, last.covariance.as_deref());
                let (noise, _) =
                    step_covariance(from, (odom_from_base, covariance), &settings.motion);
                let noise = Noise::from_covariance(&noise)?;
                graph.add_factor(RelativePose::new(last.pose, pose, &step, noise));
            }
        }
        self.keyframes.push(Keyframe {
            stamp,
            pose,
            odom_from_base: *odom_from_base,
            covariance: covariance.map(|c| Box::new(*c)),
        });
        Ok((pose, Pose::identity()))
    }

    /// What corrects odometry now. It jumps when the graph learns something; `odom` itself never does (REP 105).
    pub(super) fn map_from_odom(&self, graph: &Graph) -> Pose {
        self.keyframes.last().map_or_else(Pose::identity, |last| correction(graph, last))
    }

    /// What corrects odometry at a time, after all that is known now: between keyframes it changes evenly.
    ///
    /// `after` is the number of keyframes there were at that time.
    pub(super) fn map_from_odom_at(&self, graph: &Graph, stamp: Stamp, after: usize) -> Pose {
        let before = after.checked_sub(1).and_then(|at| self.keyframes.get(at));
        match (before, self.keyframes.get(after)) {
            (None, None) => Pose::identity(),
            (Some(only), None) | (None, Some(only)) => correction(graph, only),
            (Some(before), Some(next)) => {
                let (way, whole) =
                    (stamp.seconds_since(before.stamp), next.stamp.seconds_since(before.stamp));
                let fraction = if whole > 0.0 { (way / whole).clamp(0.0, 1.0) } else { 0.0 };
                interpolate(&correction(graph, before), &correction(graph, next), fraction)
            }
        }
    }

    /// Forgets all but the first keyframes.
    pub(super) fn truncate(&mut self, count: usize) {
        self.keyframes.truncate(count);
    }

    /// The latest keyframe's pose and its covariance, `[rotation, translation]` in the base frame.
    pub(super) fn latest(&self, graph: &Graph) -> Option<(Pose, SMatrix<f64, 6, 6>)> {
        let pose = self.keyframes.last()?.pose;
        let covariance = graph.covariance(&[pose.into()]).fixed_view::<6, 6>(0, 0).into_owned();
        Some((graph.pose(pose), covariance))
    }

    pub(super) fn len(&self) -> usize {
        self.keyframes.len()
    }
}

fn correction(graph: &Graph, keyframe: &Keyframe) -> Pose {
    graph.pose(keyframe.pose) * keyframe.odom_from_base.inverse()
}

/// Where the map begins is a matter of definition (rad, m).
const KNOWN: [f64; 6] = [1e-4; 6];
