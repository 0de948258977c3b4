//! Finds the poses that belong to detections in space, and the frames in which these are.

use super::{
    Dropped,
    history::{Jump, is_long_before},
    in_space::Detections3dMessage,
    odometry::Reading,
    sync::{Sync, Unknown},
};
use crate::{geometry::Pose, perception::Detection3d, time::Stamp};
use std::collections::{BTreeMap, VecDeque};

/// Detections in space that wait for a pose.
#[derive(Debug, Default)]
pub(super) struct Waiting3d {
    messages: VecDeque<Detections3dMessage>,
    newest: Option<Stamp>,
}

/// All that belongs to the detections of one time.
#[derive(Debug)]
pub(super) struct Moment3d {
    pub(super) stamp: Stamp,
    pub(super) odometry: Reading,
    pub(super) odometry_covariance: Option<Box<[f64; 36]>>,
    /// Each with the pose of its frame on the base.
    pub(super) detections: Vec<(Detection3d, Pose)>,
}

impl Sync {
    pub(super) fn push_3d(&mut self, message: Detections3dMessage, dropped: &mut Vec<Dropped>) {
        let stamp = message.stamp;
        if let Some(newest) = self.in_space.newest.filter(|newest| stamp <= *newest) {
            let drop = |stamp, reason, why: String| Dropped { stamp, reason, why };
            if !is_long_before(stamp, newest) {
                let back = newest.seconds_since(stamp);
                let why =
                    format!("detections in space are {back:.3} s older than those before them");
                dropped.push(drop(stamp, "stamp_goes_back", why));
                return;
            }
            for old in self.in_space.messages.drain(..) {
                let why = "the stamps jumped back while these detections in space were waiting";
                dropped.push(drop(old.stamp, "clock_jumped", why.into()));
            }
            self.poses_jump_back(&Jump { from: newest, to: stamp });
        }
        self.in_space.newest = Some(stamp);
        self.in_space.messages.push_back(message);
    }

    /// The next detections in space for which nothing more is to be waited for. With `last`, nothing more will come.
    pub(super) fn next_3d(&mut self, last: bool, dropped: &mut Vec<Dropped>) -> Option<Moment3d> {
        loop {
            let front = self.in_space.messages.front()?;
            let stamp = front.stamp;
            let waited = self.in_space.newest.map_or(0.0, |newest| newest.seconds_since(stamp));
            let give_up = last || self.is_too_much(waited, self.in_space.messages.len());
            let poses = self.reading(stamp).map(|odometry| (odometry, self.places_3d(front)));
            let is_early = match &poses {
                Err(unknown) => unknown.early,
                Ok((_, frames)) => frames.values().any(|f| f.as_ref().is_err_and(|u| u.early)),
            };
            if is_early && !give_up {
                return None;
            }
            let Detections3dMessage { detections, .. } = self.in_space.messages.pop_front()?;
            let drop = |Unknown { reason, why, .. }: Unknown| Dropped { stamp, reason, why };
            let (odometry, frames) = match poses {
                Ok(poses) => poses,
                Err(unknown) => {
                    dropped.push(drop(unknown));
                    continue;
                }
            };
            let mut known = BTreeMap::new();
            for (frame, place) in frames {
                match place {
                    Ok(pose) => {
                        known.insert(frame, pose);
                    }
                    Err(unknown) => dropped.push(drop(unknown)),
                }
            }
            let placed = |detection: Detection3d| {
                let pose = *known.get(&detection.frame_id)?;
                Some((detection, pose))
            };
            return Some(Moment3d {
                stamp,
                odometry,
                odometry_covariance: self.odometry_covariance_at(stamp),
                detections: detections.into_iter().filter_map(placed).collect(),
            });
        }
    }

    /// Where the frames of detections are on the base.
    fn places_3d(&self, message: &Detections3dMessage) -> BTreeMap<String, Result<Pose, Unknown>> {
        let mut places = BTreeMap::new();
        for Detection3d { frame_id, .. } in &message.detections {
            if !places.contains_key(frame_id) {
                places.insert(frame_id.clone(), self.place_on_base(frame_id, message.stamp));
            }
        }
        places
    }
}
