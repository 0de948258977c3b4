//! A buffer of transforms between frames, static and changing.

use super::StampedTransform;
use crate::{
    geometry::{Pose, interpolate},
    time::Stamp,
};
use std::collections::{BTreeMap, VecDeque};
use thiserror::Error;

/// Transforms of the last seconds, as a tree of frames.
#[derive(Clone, Debug, Default)]
pub(super) struct Transforms {
    parents: BTreeMap<String, Parent>,
}

/// How a frame hangs on its parent.
#[derive(Clone, Debug)]
struct Parent {
    frame_id: String,
    history: History,
}

/// Poses over time.
#[derive(Clone, Debug)]
pub(super) enum History {
    Static(Pose),
    /// In the order of their stamps.
    Changing(VecDeque<(Stamp, Pose)>),
}

/// Why a transform is not known.
#[derive(Clone, Debug, Error, PartialEq)]
pub(super) enum TransformError {
    #[error("no transform connects \"{from}\" to \"{to}\"")]
    NotConnected { from: String, to: String },
    #[error("the transform of \"{frame}\" is not known yet at {at}")]
    TooEarly { frame: String, at: Stamp },
    #[error("the transform of \"{frame}\" is not known any more, or never was, at {at}")]
    TooLate { frame: String, at: Stamp },
}

impl History {
    /// An empty history of a moving frame.
    pub(super) fn changing() -> Self {
        Self::Changing(VecDeque::new())
    }

    /// Adds a pose; a stamp that was there already is replaced, old ones are forgotten.
    pub(super) fn push(&mut self, stamp: Stamp, pose: Pose) {
        let Self::Changing(poses) = self else {
            *self = Self::Changing(VecDeque::from([(stamp, pose)]));
            return;
        };
        let at = poses.partition_point(|(s, _)| *s < stamp);
        match poses.get_mut(at) {
            Some(entry) if entry.0 == stamp => entry.1 = pose,
            _ => poses.insert(at, (stamp, pose)),
        }
        while poses.len() > MAX_POSES {
            poses.pop_front();
        }
    }

    /// The pose at a time, interpolated at constant twist.
    pub(super) fn at(&self, stamp: Stamp) -> Result<Pose, Outside> {
        let poses = match self {
            Self::Static(pose) => return Ok(*pose),
            Self::Changing(poses) => poses,
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

/// A time that a history does not cover.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outside {
    /// Before its first pose.
    Before,
    /// After its last pose.
    After,
}

impl Transforms {
    pub(super) fn insert(&mut self, transform: &StampedTransform, is_static: bool) {
        let pose = transform.parent_from_child;
        let parent = self.parents.entry(transform.child_frame_id.clone()).or_insert_with(|| {
            Parent { frame_id: transform.frame_id.clone(), history: History::changing() }
        });
        if parent.frame_id != transform.frame_id {
            parent.frame_id.clone_from(&transform.frame_id);
            parent.history = History::changing();
        }
        if is_static {
            parent.history = History::Static(pose);
        } else {
            parent.history.push(transform.stamp, pose);
        }
    }

    /// `to_from_from` at a time.
    pub(super) fn lookup(&self, to: &str, from: &str, at: Stamp) -> Result<Pose, TransformError> {
        let (to_root, to_chain) = self.chain(to, at)?;
        let (from_root, from_chain) = self.chain(from, at)?;
        if to_root != from_root {
            return Err(TransformError::NotConnected { from: from.into(), to: to.into() });
        }
        Ok(to_chain.inverse() * from_chain)
    }

    /// Whether a chain of transforms connects two frames at any time.
    pub(super) fn connects(&self, a: &str, b: &str) -> bool {
        self.root(a) == self.root(b)
    }

    fn root<'a>(&'a self, mut frame: &'a str) -> &'a str {
        for _ in 0..MAX_DEPTH {
            match self.parents.get(frame) {
                Some(parent) => frame = &parent.frame_id,
                None => break,
            }
        }
        frame
    }

    /// The root above `frame` and `root_from_frame`.
    fn chain<'a>(&'a self, frame: &'a str, at: Stamp) -> Result<(&'a str, Pose), TransformError> {
        let (mut root, mut root_from_frame) = (frame, Pose::identity());
        for _ in 0..MAX_DEPTH {
            let Some(parent) = self.parents.get(root) else { break };
            let step = parent.history.at(at).map_err(|outside| match outside {
                Outside::After => TransformError::TooEarly { frame: root.into(), at },
                Outside::Before => TransformError::TooLate { frame: root.into(), at },
            })?;
            root_from_frame = step * root_from_frame;
            root = &parent.frame_id;
        }
        Ok((root, root_from_frame))
    }
}

/// Poses kept of a moving frame: ten minutes at 100 Hz would be too many, ten seconds at 1 kHz must be there.
const MAX_POSES: usize = 10_000;
/// A cycle in the tree of frames ends here.
const MAX_DEPTH: usize = 64;
