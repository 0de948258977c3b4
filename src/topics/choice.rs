//! Choosing topics where nobody named them.

use super::{Assigned, Remap, Role, Roles, Topic, candidates::Candidates};
use serde::Serialize;
use std::fmt;

/// A topic that was chosen.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Choice {
    /// What for.
    pub role: Role,
    /// Its name.
    pub topic: String,
    /// Others that could serve, too, the next best first.
    pub rather_than: Vec<Passed>,
}

/// A topic that was passed over.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Passed {
    /// Its name.
    pub topic: String,
    /// What is worse about it than about the one that was chosen.
    pub why: &'static str,
}

/// Most topics that are named as passed over.
const MOST_PASSED: usize = 4;

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.topic)?;
        let passed = |passed: &Passed| format!("{}, which {}", passed.topic, passed.why);
        let others: Vec<String> = self.rather_than.iter().take(MOST_PASSED).map(passed).collect();
        match (others.len(), self.rather_than.len() - others.len()) {
            (0, _) => Ok(()),
            (_, 0) => write!(f, ", rather than {}", others.join(", or ")),
            (_, more) => write!(f, ", rather than {}, or {more} more", others.join(", or ")),
        }
    }
}

/// Gives each role the topic that was given by hand, or the best by type, format and name: those in `namespace` first.
pub fn choose(topics: &[Topic], given: &[Remap], namespace: &str) -> Assigned {
    let found = Candidates { topics, namespace };
    let mut choosing = Choosing { given, choices: Vec::new() };
    let depth = choosing.of(Role::Depth, || found.depth());
    let rgb = choosing.of(Role::Rgb, || found.rgb(depth.as_deref()));
    let camera_info = choosing.of(Role::CameraInfo, || {
        let beside = |image: &Option<String>| {
            image.as_deref().and_then(|image| found.sibling_info(Role::CameraInfo, image))
        };
        beside(&rgb).or_else(|| found.any_info()).or_else(|| beside(&depth))
    });
    let depth_camera_info = choosing.of(Role::DepthCameraInfo, || {
        let own = found.sibling_info(Role::DepthCameraInfo, depth.as_deref()?)?;
        (Some(&own.topic) != camera_info.as_ref()).then_some(own)
    });
    let detections = choosing.of(Role::Detections, || found.detections());
    let odometry = choosing.of(Role::Odometry, || found.odometry());
    // What measures in space by itself is used where it is named, or there is no depth.
    let is_named = given.iter().any(|remap| remap.role == Role::Detections3d);
    let in_space = (is_named || depth.is_none())
        .then(|| choosing.of(Role::Detections3d, || found.detections_3d()))
        .flatten();
    if let Some(in_space) = in_space {
        return choosing.in_space(&found, in_space, odometry);
    }
    let needed =
        [(Role::Depth, &depth), (Role::CameraInfo, &camera_info), (Role::Detections, &detections)];
    let missing = needed.iter().filter(|(_, topic)| topic.is_none()).map(|(role, _)| *role);
    let missing = missing.collect();
    let roles = Roles {
        rgb,
        depth: depth.unwrap_or_default(),
        camera_info: camera_info.unwrap_or_default(),
        depth_camera_info,
        odometry,
        detections: detections.unwrap_or_default(),
        detections_3d: None,
        tf: found.transforms("tf"),
        tf_static: found.transforms("tf_static"),
    };
    Assigned { roles, missing, choices: choosing.choices }
}

struct Choosing<'a> {
    given: &'a [Remap],
    choices: Vec<Choice>,
}

impl Choosing<'_> {
    /// Objects in space need poses, and nothing else.
    fn in_space(
        mut self,
        found: &Candidates<'_>,
        topic: String,
        odometry: Option<String>,
    ) -> Assigned {
        self.choices.retain(|choice| matches!(choice.role, Role::Detections3d | Role::Odometry));
        let roles = Roles {
            odometry,
            detections_3d: Some(topic),
            tf: found.transforms("tf"),
            tf_static: found.transforms("tf_static"),
            ..Roles::default()
        };
        Assigned { roles, missing: Vec::new(), choices: self.choices }
    }

    /// What was given last, or what is found. Nothing where the role was given no topic.
    fn of(&mut self, role: Role, find: impl FnOnce() -> Option<Choice>) -> Option<String> {
        if let Some(given) = self.given.iter().rev().find(|remap| remap.role == role) {
            return Some(given.topic.clone()).filter(|topic| !topic.is_empty());
        }
        let choice = find()?;
        let topic = choice.topic.clone();
        self.choices.push(choice);
        Some(topic)
    }
}
