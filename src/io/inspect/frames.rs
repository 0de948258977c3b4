//! Which frames a bag's transforms connect.

use crate::pipeline::{MAX_FRAMES, StampedTransform};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// A transform between two frames.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct FrameLink {
    /// Parent frame.
    pub parent: String,
    /// Child frame.
    pub child: String,
    /// Whether it holds for all time.
    pub is_static: bool,
}

/// The frames that matter and whether transforms connect them.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Frames {
    /// Frame of the robot's base: the odometry's child.
    pub base: Option<String>,
    /// Optical frame of the colour camera.
    pub camera: Option<String>,
    /// Optical frame of the depth images.
    pub depth: Option<String>,
    /// All transforms.
    pub links: Vec<FrameLink>,
    /// Whether base and camera are connected; nothing where one of them is not known.
    pub base_to_camera: Option<bool>,
    /// Whether the two cameras are connected; nothing where one of them is not known.
    pub depth_to_camera: Option<bool>,
    /// Whether a moving transform leads to the camera, which can stand in for odometry.
    pub camera_moves: bool,
}

/// Transforms by their two frames.
#[derive(Debug, Default)]
pub(super) struct FrameGraph {
    links: BTreeMap<(String, String), bool>,
}

impl FrameGraph {
    pub(super) fn add(&mut self, is_static: bool, transforms: &[StampedTransform]) {
        for transform in transforms {
            let link = (transform.frame_id.clone(), transform.child_frame_id.clone());
            // As many as the core would know.
            if self.links.len() < MAX_FRAMES || self.links.contains_key(&link) {
                self.links.insert(link, is_static);
            }
        }
    }

    pub(super) fn frames(
        &self,
        base: Option<String>,
        camera: Option<String>,
        depth: Option<String>,
    ) -> Frames {
        let connected = |from: &Option<String>, to: &Option<String>| {
            let (from, to) = (from.as_ref()?, to.as_ref()?);
            Some(self.reachable(from, |_| true).contains(to.as_str()))
        };
        let link = |((parent, child), is_static): (&(String, String), &bool)| FrameLink {
            parent: parent.clone(),
            child: child.clone(),
            is_static: *is_static,
        };
        Frames {
            links: self.links.iter().map(link).collect(),
            base_to_camera: connected(&base, &camera),
            depth_to_camera: connected(&depth, &camera),
            camera_moves: camera.as_ref().is_some_and(|camera| self.moves(camera)),
            base,
            camera,
            depth,
        }
    }

    /// Whether a moving transform leads to the frame.
    pub(super) fn moves(&self, frame: &str) -> bool {
        let fixed = self.reachable(frame, |is_static| is_static);
        self.reachable(frame, |_| true).len() > fixed.len()
    }

    /// All frames that links of the accepted kinds connect with `from`, itself included.
    fn reachable<'a>(
        &'a self,
        from: &'a str,
        accepted: impl Fn(bool) -> bool,
    ) -> BTreeSet<&'a str> {
        let mut reached = BTreeSet::from([from]);
        let mut todo = vec![from];
        while let Some(frame) = todo.pop() {
            for ((parent, child), _) in self.links.iter().filter(|(_, fixed)| accepted(**fixed)) {
                let other = match frame {
                    frame if frame == parent => child,
                    frame if frame == child => parent,
                    _ => continue,
                };
                if reached.insert(other) {
                    todo.push(other);
                }
            }
        }
        reached
    }
}
