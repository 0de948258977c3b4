//! A buffer of transforms between frames, static and changing.

use super::{
    StampedTransform,
    history::{History, Jump, Outside},
};
use crate::{geometry::Pose, time::Stamp};
use std::collections::BTreeMap;
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

    /// The clock jumped back; what holds for all time stays.
    pub(super) fn jump_back(&mut self, jump: &Jump) {
        self.parents.values_mut().for_each(|parent| parent.history.jump_back(jump));
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

/// A cycle in the tree of frames ends here.
const MAX_DEPTH: usize = 64;
