//! The chain of keyframe poses.

use super::{SlamSettings, gate::Step};
use crate::{
    geometry::{Pose, adjoint, interpolate},
    graph::{FactorId, Graph, Noise, NoiseError, PoseId, PosePrior, RelativePose, step_covariance},
    time::Stamp,
};
use nalgebra::Matrix6;
use std::collections::VecDeque;

/// A pose of the graph and the odometry it came with.
#[derive(Clone, Debug)]
struct Keyframe {
    /// How many keyframes there had been before.
    number: usize,
    stamp: Stamp,
    pose: PoseId,
    odom_from_base: Pose,
    covariance: Option<Box<[f64; 36]>>,
    /// From the keyframe before, unless it is held by a prior.
    leg: Option<Leg>,
}

/// Which keyframe something was seen from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct KeyframeId {
    pub(super) pose: PoseId,
    /// How many keyframes there had been before.
    pub(super) number: usize,
}

impl KeyframeId {
    /// How long what was seen from it is kept: as often as its number can be halved. What is left is spread evenly over the
    /// whole drive, from the same keyframes for all objects and walls, so that few poses have to be kept.
    pub(super) fn worth(self) -> u32 {
        self.number.trailing_zeros()
    }
}

/// Where the robot is, from a keyframe.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) keyframe: KeyframeId,
    pub(super) keyframe_from_base: Pose,
}

impl Place {
    pub(super) fn map_from_base(&self, graph: &Graph) -> Pose {
        graph.pose(self.keyframe.pose) * self.keyframe_from_base
    }
}

/// The way between two keyframes, by odometry.
#[derive(Clone, Debug)]
struct Leg {
    from_from_to: Pose,
    /// Of `[rotation, translation]`, a right perturbation.
    covariance: Matrix6<f64>,
}

impl Leg {
    /// This one, and then another one.
    fn then(&self, next: &Leg) -> Self {
        let carried = adjoint(&next.from_from_to.inverse());
        Self {
            from_from_to: self.from_from_to * next.from_from_to,
            covariance: carried * self.covariance * carried.transpose() + next.covariance,
        }
    }
}

/// The keyframes that the graph has, in the order in which they came.
///
/// A keyframe that only odometry ties to others tells the map nothing, and is thinned out: the steps to it and from it
/// become one, which is what eliminating its pose would give. So the graph grows with the map and not with the way driven.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain {
    keyframes: Vec<Keyframe>,
    /// How many there have been.
    count: usize,
    /// Those that may have become superfluous.
    loose: VecDeque<PoseId>,
    /// What holds the first pose where the map was defined to begin.
    anchor: Option<FactorId>,
    /// Where the map was moved to since it was odometry's frame.
    moved: Pose,
}

impl Chain {
    /// The keyframe for a pose of odometry: the last one as long as the robot stands still, a new one otherwise. `step`
    /// is what [`Chain::step`] says of that pose.
    pub(super) fn keyframe(
        &mut self,
        graph: &mut Graph,
        (stamp, odom_from_base): (Stamp, &Pose),
        covariance: Option<&[f64; 36]>,
        (step, settings): (Option<&Step>, &SlamSettings),
    ) -> Result<Place, NoiseError> {
        let last = self.keyframes.last().zip(step);
        if let Some((last, step)) = last {
            let way = step.pose_from_base;
            let still = way.translation.vector.norm() < settings.min_translation_m
                && way.rotation.angle() < settings.min_rotation_deg.to_radians();
            if still {
                let keyframe = KeyframeId { pose: last.pose, number: last.number };
                return Ok(Place { keyframe, keyframe_from_base: way });
            }
        }
        let pose = graph.add_pose(self.map_from_odom(graph) * odom_from_base);
        let leg = match last.filter(|_| settings.optimize_poses) {
            None => {
                let held = self.moved * odom_from_base;
                let anchor =
                    graph.add_factor(PosePrior::new(pose, held, Noise::from_sigmas(KNOWN)?));
                if self.keyframes.is_empty() && settings.optimize_poses {
                    self.anchor = Some(anchor);
                }
                None
            }
            Some((last, step)) => {
                let leg = Leg { from_from_to: step.pose_from_base, covariance: step.covariance };
                tie(graph, (last.pose, pose), &leg)?;
                Some(leg)
            }
        };
        let number = self.count;
        self.keyframes.push(Keyframe {
            number,
            stamp,
            pose,
            odom_from_base: *odom_from_base,
            covariance: covariance.map(|c| Box::new(*c)),
            leg,
        });
        self.count += 1;
        let keyframe = KeyframeId { pose, number };
        Ok(Place { keyframe, keyframe_from_base: Pose::identity() })
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

    /// Notes keyframes that may have become superfluous: measurements from them were forgotten, or they are no longer
    /// the last.
    pub(super) fn note_loose(&mut self, poses: impl IntoIterator<Item = PoseId>) {
        self.loose.extend(poses);
    }

    /// Takes some of the superfluous keyframes out of the graph, with its next update; [`Chain::forget`] has to follow
    /// when that succeeds. Not all at once, so that no update takes much longer than others. What `is_needed` for
    /// something else than factors stays.
    pub(super) fn thin(
        &mut self,
        graph: &mut Graph,
        is_needed: impl Fn(PoseId) -> bool,
    ) -> Result<Vec<Thinned>, NoiseError> {
        let mut thinned: Vec<Thinned> = Vec::new();
        for _ in 0..self.loose.len().min(MAX_LOOKED_AT) {
            let Some(pose) = self.loose.pop_front() else { break };
            // The first holds the map where it is.
            let Some(at) = self.keyframes.iter().skip(1).position(|k| k.pose == pose) else {
                continue;
            };
            let (before, here) = (&self.keyframes[at], &self.keyframes[at + 1]);
            let Some(next) = self.keyframes.get(at + 2) else { continue };
            let own = if here.leg.is_some() { 2 } else { 1 };
            let is_known = thinned.iter().any(|t| t.pose == pose);
            if is_known || graph.degree(pose) != own || is_needed(pose) {
                continue;
            }
            let is_near = |t: &Thinned| t.pose == before.pose || t.pose == next.pose;
            if thinned.len() == MAX_THINNED || thinned.iter().any(is_near) {
                self.loose.push_back(pose);
                continue;
            }
            graph.remove_variable(pose);
            let leg = here.leg.as_ref().zip(next.leg.as_ref()).map(|(to, on)| to.then(on));
            if let Some(leg) = &leg {
                tie(graph, (before.pose, next.pose), leg)?;
            }
            thinned.push(Thinned { pose, next: next.pose, leg });
        }
        Ok(thinned)
    }

    /// Forgets what [`Chain::thin`] has taken out.
    pub(super) fn forget(&mut self, thinned: Vec<Thinned>) {
        for Thinned { pose, next, leg } in thinned {
            self.keyframes.retain(|k| k.pose != pose);
            let next = self.keyframes.iter_mut().find(|k| k.pose == next);
            next.into_iter().for_each(|k| k.leg.clone_from(&leg));
        }
    }

    /// What corrects odometry now. It jumps when the graph learns something; `odom` itself never does (REP 105).
    pub(super) fn map_from_odom(&self, graph: &Graph) -> Pose {
        self.keyframes.last().map_or_else(Pose::identity, |last| correction(graph, last))
    }

    /// What corrects odometry at a time, after all that is known now: between keyframes it changes evenly.
    ///
    /// `after` is the number of keyframes there had been at that time.
    pub(super) fn map_from_odom_at(&self, graph: &Graph, stamp: Stamp, after: usize) -> Pose {
        let next = self.keyframes.partition_point(|k| k.number < after);
        let before = next.checked_sub(1).and_then(|at| self.keyframes.get(at));
        match (before, self.keyframes.get(next)) {
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

    /// Covariance of the base in the map, of `[rotation, translation]`, a right perturbation of its pose: that of the last
    /// keyframe and of the step of odometry since; nothing before the first keyframe.
    pub(super) fn covariance(
        &self,
        graph: &Graph,
        odom_from_base: &Pose,
        settings: &SlamSettings,
    ) -> Option<Matrix6<f64>> {
        let last = self.keyframes.last()?;
        let known = graph.covariance(&[last.pose.into()]).fixed_view::<6, 6>(0, 0).into_owned();
        let step = self.step(graph, odom_from_base, None, settings)?;
        let moved = adjoint(&step.pose_from_base.inverse());
        Some(moved * known * moved.transpose() + step.covariance)
    }

    /// The first pose.
    pub(super) fn first(&self, graph: &Graph) -> Option<Pose> {
        self.keyframes.first().map(|first| graph.pose(first.pose))
    }

    /// The last keyframe's pose.
    pub(super) fn last(&self) -> Option<PoseId> {
        self.keyframes.last().map(|k| k.pose)
    }

    /// The last pose that is not later than a stamp.
    pub(super) fn at(&self, stamp: Stamp) -> Option<PoseId> {
        let after = self.keyframes.partition_point(|keyframe| keyframe.stamp <= stamp);
        after.checked_sub(1).map(|at| self.keyframes[at].pose)
    }

    /// When there were so many keyframes less than now.
    pub(super) fn stamp_before(&self, keyframes: usize) -> Option<Stamp> {
        let number = self.count.checked_sub(keyframes + 1)?;
        let after = self.keyframes.partition_point(|keyframe| keyframe.number <= number);
        after.checked_sub(1).map(|at| self.keyframes[at].stamp)
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

    /// Forgets all keyframes but the first so many.
    pub(super) fn truncate(&mut self, count: usize) {
        self.keyframes.retain(|k| k.number < count);
        self.count = count;
        self.anchor = self.anchor.filter(|_| count > 0);
    }

    /// How many keyframes there have been.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// How many of them the graph has.
    pub(super) fn kept(&self) -> usize {
        self.keyframes.len()
    }
}

/// A keyframe that leaves the graph.
#[derive(Debug)]
pub(super) struct Thinned {
    pose: PoseId,
    next: PoseId,
    /// To the next one from the one before, where odometry ties them.
    leg: Option<Leg>,
}

fn tie(graph: &mut Graph, (from, to): (PoseId, PoseId), leg: &Leg) -> Result<(), NoiseError> {
    let noise = Noise::from_covariance(&leg.covariance)?;
    graph.add_factor(RelativePose::new(from, to, &leg.from_from_to, noise));
    Ok(())
}

fn correction(graph: &Graph, keyframe: &Keyframe) -> Pose {
    graph.pose(keyframe.pose) * keyframe.odom_from_base.inverse()
}

/// A robot stands upright; the rest is open (rad, m).
const UPRIGHT: [f64; 6] = [1e-3, 1e-3, 1.0, 1.0, 1.0, 1.0];
/// Where the map begins is a matter of definition (rad, m).
const KNOWN: [f64; 6] = [1e-4; 6];
/// In one update. One keyframe comes with it, so that this catches up.
const MAX_THINNED: usize = 2;
/// Of those that may be superfluous, in one update.
const MAX_LOOKED_AT: usize = 16;
