//! The way of the base, bounded in length and in how often it is published.

use crate::{
    geometry::Pose,
    pipeline::{FramePose, ObjectSlam},
    time::Stamp,
};

/// Least time between two paths (s): a path grows with the drive, and each is a complete one.
const PERIOD_S: f64 = 1.0;
/// Poses kept; at twice as many, every other one is left out.
const MAX_POSES: usize = 1000;
/// A turn that gives the path a new pose (rad).
const TURN_RAD: f64 = 0.17;

/// Poses at even steps, and the latest one.
#[derive(Debug, Default)]
pub(super) struct Way {
    poses: Vec<FramePose>,
    latest: Option<FramePose>,
    published: Option<Stamp>,
    /// How much longer steps are than asked for, after poses were left out.
    coarseness: u32,
}

impl Way {
    /// Adds a pose; true when the path is to be published.
    pub(super) fn add(&mut self, pose: &FramePose, step_m: f64) -> bool {
        let step = step_m * f64::from(1 << self.coarseness);
        let is_new = self.poses.last().is_none_or(|last| {
            let moved = last.odom_from_base.inv_mul(&pose.odom_from_base);
            moved.translation.vector.norm() >= step || moved.rotation.angle() >= TURN_RAD
        });
        self.latest = Some(*pose);
        if is_new {
            self.poses.push(*pose);
            if self.poses.len() > 2 * MAX_POSES {
                let mut at = 0;
                self.poses.retain(|_| {
                    at += 1;
                    at % 2 == 1
                });
                self.coarseness += 1;
            }
        }
        let waited = self.published.map(|at| pose.stamp.seconds_since(at));
        let is_due = waited.is_none_or(|waited| !(0.0..PERIOD_S).contains(&waited));
        if is_due {
            self.published = Some(pose.stamp);
        }
        is_due
    }

    pub(super) fn latest(&self) -> Option<&FramePose> {
        self.latest.as_ref()
    }

    /// After all that is known now.
    pub(super) fn poses(&self, slam: &ObjectSlam) -> Vec<(Stamp, Pose)> {
        let latest = self
            .latest
            .filter(|latest| self.poses.last().is_none_or(|last| last.stamp != latest.stamp));
        let all = self.poses.iter().chain(&latest);
        all.map(|pose| (pose.stamp, slam.map_from_base(pose))).collect()
    }
}
