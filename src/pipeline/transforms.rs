//! A buffer of transforms between frames, static and changing.

use super::{
    StampedTransform,
    history::{History, Jump, Outside},
};
use crate::{geometry::Pose, time::Stamp};
use std::{collections::BTreeMap, iter};
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

impl Transforms {
    /// False where there are too many frames for one more.
    pub(super) fn insert(&mut self, transform: &StampedTransform, is_static: bool) -> bool {
        if self.parents.len() >= MAX_FRAMES && !self.parents.contains_key(&transform.child_frame_id)
        {
            return false;
        }
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
        true
    }

    /// The clock jumped back; what holds for all time stays.
    pub(super) fn jump_back(&mut self, jump: &Jump) {
        self.parents.values_mut().for_each(|parent| parent.history.jump_back(jump));
    }

    /// `to_from_from` at a time. Only what is below the nearest frame that both hang on has to be known: what corrects
    /// `map -> odom` says nothing of where a camera is on its base.
    pub(super) fn lookup(&self, to: &str, from: &str, at: Stamp) -> Result<Pose, TransformError> {
        let above: Vec<&str> = self.upwards(to).collect();
        let Some(common) = self.upwards(from).find(|frame| above.contains(frame)) else {
            return Err(TransformError::NotConnected { from: from.into(), to: to.into() });
        };
        Ok(self.chain(common, to, at)?.inverse() * self.chain(common, from, at)?)
    }

    /// Whether a chain of transforms connects two frames at any time.
    pub(super) fn connects(&self, a: &str, b: &str) -> bool {
        self.upwards(a).last() == self.upwards(b).last()
    }

    /// A frame and those above it, up to the root.
    fn upwards<'a>(&'a self, frame: &'a str) -> impl Iterator<Item = &'a str> {
        let parent = |frame: &&str| self.parents.get(*frame).map(|parent| parent.frame_id.as_str());
        iter::successors(Some(frame), parent).take(MAX_DEPTH)
    }

    /// `above_from_frame` for a frame above.
    fn chain(&self, above: &str, frame: &str, at: Stamp) -> Result<Pose, TransformError> {
        let mut above_from_frame = Pose::identity();
        for frame in self.upwards(frame).take_while(|frame| *frame != above) {
            let Some(parent) = self.parents.get(frame) else { break };
            let step = parent.history.at(at).map_err(|outside| match outside {
                Outside::After => TransformError::TooEarly { frame: frame.into(), at },
                Outside::Before => TransformError::TooLate { frame: frame.into(), at },
            })?;
            above_from_frame = step * above_from_frame;
        }
        Ok(above_from_frame)
    }
}

/// Most frames that are known at a time: those of a robot with hands, and of ten others in its room.
pub const MAX_FRAMES: usize = 2000;
/// A cycle in the tree of frames ends here.
const MAX_DEPTH: usize = 64;
