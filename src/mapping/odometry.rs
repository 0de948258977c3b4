//! The chain of keyframe poses.

use super::{SlamSettings, gate::Step};
use crate::{
    geometry::{Pose, interpolate},
    graph::{FactorId, Graph, Noise, NoiseError, PoseId, PosePrior, RelativePose, step_covariance},
    time::Stamp,
};

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
    /// What holds the first pose where the map was defined to begin.
    anchor: Option<FactorId>,
    /// Where the map was moved to since it was odometry's frame.
    moved: Pose,
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
                let held = self.moved * odom_from_base;
                let anchor = PosePrior::new(pose, held, Noise::from_sigmas(KNOWN)?);
                let anchor = graph.add_factor(anchor);
                if self.keyframes.is_empty() && settings.optimize_poses {
                    self.anchor = Some(anchor);
                }
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

    /// The way from the last keyframe to a pose of odometry; nothing before the first one.
    pub(super) fn step(
        &self,
        graph: &Graph,
        odom_from_base: &Pose,
        covariance: Option<&[f64; 36]>,
        settings: &SlamSettings,
    ) -> Option<Step> {
        let last = self.keyframes.last()?;
        let from = (&last.odom_from_base, last.covariance.as_deref());
        let (noise, _) = step_covariance(from, (odom_from_base, covariance), &settings.motion);
        Some(Step {
            pose: Some(last.pose),
            map_from_pose: graph.pose(last.pose),
            pose_from_base: last.odom_from_base.inv_mul(odom_from_base),
            covariance: noise,
        })
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

    /// The first pose.
    pub(super) fn first(&self, graph: &Graph) -> Option<Pose> {
        self.keyframes.first().map(|first| graph.pose(first.pose))
    }

    /// The last pose.
    pub(super) fn last(&self) -> Option<PoseId> {
        self.keyframes.last().map(|last| last.pose)
    }

    /// The last pose that is not later than a stamp.
    pub(super) fn at(&self, stamp: Stamp) -> Option<PoseId> {
        let after = self.keyframes.partition_point(|keyframe| keyframe.stamp <= stamp);
        after.checked_sub(1).map(|at| self.keyframes[at].pose)
    }

    /// When there were so many keyframes less than now.
    pub(super) fn stamp_before(&self, keyframes: usize) -> Option<Stamp> {
        let at = self.keyframes.len().checked_sub(keyframes + 1)?;
        Some(self.keyframes[at].stamp)
    }

    /// The map has moved.
    pub(super) fn move_map(&mut self, new_from_old: &Pose) {
        self.moved = new_from_old * self.moved;
    }

    /// Something else says from now on where the map is: the first pose is only held upright.
    pub(super) fn loosen(&mut self, graph: &mut Graph) {
        let (Some(anchor), Some(first)) = (self.anchor.take(), self.keyframes.first()) else {
            return;
        };
        graph.remove_factor(anchor);
        if let Ok(noise) = Noise::from_sigmas(UPRIGHT) {
            graph.add_factor(PosePrior::new(first.pose, graph.pose(first.pose), noise));
        }
    }

    /// Forgets all but the first keyframes.
    pub(super) fn truncate(&mut self, count: usize) {
        self.keyframes.truncate(count);
        self.anchor = self.anchor.filter(|_| count > 0);
    }

    pub(super) fn len(&self) -> usize {
        self.keyframes.len()
    }
}

fn correction(graph: &Graph, keyframe: &Keyframe) -> Pose {
    graph.pose(keyframe.pose) * keyframe.odom_from_base.inverse()
}

/// A robot stands upright; the rest is open (rad, m).
const UPRIGHT: [f64; 6] = [1e-3, 1e-3, 1.0, 1.0, 1.0, 1.0];
/// Where the map begins is a matter of definition (rad, m).
const KNOWN: [f64; 6] = [1e-4; 6];
