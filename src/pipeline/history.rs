//! Poses of one frame over time.

use crate::{
    geometry::{Pose, interpolate},
    time::Stamp,
};
use std::collections::VecDeque;

/// The pose of a frame on its parent.
#[derive(Clone, Debug)]
pub(super) enum History {
    /// The same for all time.
    Static(Pose),
    /// Known at some stamps.
    Changing(Track),
}

/// Poses in the order of their stamps.
#[derive(Clone, Debug, Default)]
pub(super) struct Track {
    poses: VecDeque<(Stamp, Pose)>,
    /// A pose from long before the newest one. It is wrong if the next one continues the track, and the start of a
    /// new time if the next one is from long before as well.
    from_the_past: Option<(Stamp, Pose)>,
}

/// A clock that jumped back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jump {
    /// The last stamp before.
    pub(super) from: Stamp,
    /// The first stamp after.
    pub(super) to: Stamp,
}

impl Jump {
    /// Whether what came last with this stamp came before the jump: it is nearer to the old time.
    pub(super) fn is_before(&self, stamp: Stamp) -> bool {
        stamp.seconds_since(self.to) > self.from.seconds_since(stamp)
    }
}

/// A time that a history does not cover.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outside {
    /// Before its first pose.
    Before,
    /// After its last pose.
    After,
}

impl History {
    /// An empty history of a moving frame.
    pub(super) fn changing() -> Self {
        Self::Changing(Track::default())
    }

    /// Adds a pose; a stamp that was there already is replaced, old ones are forgotten.
    pub(super) fn push(&mut self, stamp: Stamp, pose: Pose) {
        if let Self::Static(_) = self {
            *self = Self::changing();
        }
        if let Self::Changing(track) = self {
            track.push(stamp, pose);
        }
    }

    /// The clock jumped back: poses of the time before do not belong to the new one.
    pub(super) fn jump_back(&mut self, jump: &Jump) {
        if let Self::Changing(track) = self
            && track.poses.back().is_some_and(|newest| jump.is_before(newest.0))
        {
            track.restart();
        }
    }

    /// The pose at a time, interpolated at constant twist.
    pub(super) fn at(&self, stamp: Stamp) -> Result<Pose, Outside> {
        let poses = match self {
            Self::Static(pose) => return Ok(*pose),
            Self::Changing(track) => &track.poses,
        };
        let after = poses.partition_point(|(s, _)| *s < stamp);
        let Some((next_stamp, next)) = poses.get(after) else { return Err(Outside::After) };
        if *next_stamp == stamp {
            return Ok(*next);
        }
        let Some((last_stamp, last)) = after.checked_sub(1).map(|i| &poses[i]) else {
            return Err(Outside::Before);
        };
        let span = next_stamp.seconds_since(*last_stamp);
        Ok(interpolate(last, next, stamp.seconds_since(*last_stamp) / span))
    }
}

impl Track {
    fn push(&mut self, stamp: Stamp, pose: Pose) {
        let behind = self.poses.back().is_some_and(|newest| is_long_before(stamp, newest.0));
        if behind && self.from_the_past.is_none() {
            self.from_the_past = Some((stamp, pose));
            return;
        }
        if behind {
            self.restart();
        }
        self.from_the_past = None;
        self.insert(stamp, pose);
    }

    fn restart(&mut self) {
        self.poses.clear();
        if let Some((stamp, pose)) = self.from_the_past.take() {
            self.insert(stamp, pose);
        }
    }

    fn insert(&mut self, stamp: Stamp, pose: Pose) {
        let at = self.poses.partition_point(|(s, _)| *s < stamp);
        match self.poses.get_mut(at) {
            Some(entry) if entry.0 == stamp => entry.1 = pose,
            _ => self.poses.insert(at, (stamp, pose)),
        }
        while self.poses.len() > MAX_POSES {
            self.poses.pop_front();
        }
    }
}

/// Whether a stamp goes back so far that it is a restart, not disorder.
pub(super) fn is_long_before(stamp: Stamp, newest: Stamp) -> bool {
    newest.seconds_since(stamp) >= MAX_STEP_BACK_S
}

const MAX_STEP_BACK_S: f64 = 1.0;
/// Poses kept of a moving frame: ten minutes at 100 Hz would be too many, ten seconds at 1 kHz must be there.
const MAX_POSES: usize = 10_000;
