//! Why topics cannot be assigned.

use super::{Role, Topic};
use thiserror::Error;

/// How a bag without boxes is used.
const FIND_BOXES: &str = ", or find the boxes in its colour images with `--model FILE.onnx`";

/// Why topics cannot be assigned.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum RoleError {
    /// Not of the form `role:=/topic`.
    #[error("`{given}` is not of the form role:=/topic")]
    BadRemap {
        /// What was given.
        given: String,
    },
    /// A role that does not exist.
    #[error(
        "there is no role `{given}`; the roles are {}, or as topics of the node {}",
        names(Role::ALL),
        ros_names()
    )]
    UnknownRole {
        /// What was given.
        given: String,
    },
    /// A topic given by hand that the bag does not have.
    #[error("the bag has no topic {topic} for {role}; it has {}", listed(available))]
    NoSuchTopic {
        /// The role.
        role: Role,
        /// What was given.
        topic: String,
        /// Topics with their types.
        available: Vec<(String, String)>,
    },
    /// A topic given by hand of the wrong type.
    #[error("{topic} is a {got}, but {role} needs a {}", role.types().join(" or "))]
    WrongType {
        /// The role.
        role: Role,
        /// What was given.
        topic: String,
        /// Its type.
        got: String,
    },
    /// The truth given by hand as input.
    #[error("{topic} cannot be used for {role}: topics under /ground_truth/ are never input")]
    GroundTruth {
        /// The role.
        role: Role,
        /// What was given.
        topic: String,
    },
    /// Nothing fits the roles that must be filled.
    #[error(
        "the bag has no topic for {}; it has {}; name one with `-r {}:=/topic`{}",
        names(missing),
        listed(available),
        missing.first().unwrap_or(&Role::Depth),
        if missing.contains(&Role::Detections) { FIND_BOXES } else { "" }
    )]
    Missing {
        /// Roles that must be filled.
        missing: Vec<Role>,
        /// Topics with their types.
        available: Vec<(String, String)>,
    },
    /// A topic in an encoding of another system.
    #[error("{topic} is encoded as `{encoding}`, but ROS 2 bags hold `cdr`")]
    NotCdr {
        /// The topic.
        topic: String,
        /// Its encoding.
        encoding: String,
    },
}

impl RoleError {
    /// Roles that nothing of these topics fits.
    pub(crate) fn missing(missing: Vec<Role>, topics: &[Topic]) -> Self {
        Self::Missing { missing, available: available(topics) }
    }
}

/// Names of topics with what they hold.
pub(super) fn available(topics: &[Topic]) -> Vec<(String, String)> {
    let kind = |topic: &Topic| match (topic.messages, &topic.format) {
        (0, _) => format!("{}, no messages", topic.type_name),
        (_, Some(format)) => format!("{}, {format}", topic.type_name),
        (_, None) => topic.type_name.clone(),
    };
    topics.iter().map(|topic| (topic.name.clone(), kind(topic))).collect()
}

fn listed(topics: &[(String, String)]) -> String {
    if topics.is_empty() {
        return "no topics at all".to_owned();
    }
    let listed: Vec<String> =
        topics.iter().map(|(name, kind)| format!("{name} ({kind})")).collect();
    listed.join(", ")
}

fn names(roles: &[Role]) -> String {
    roles.iter().map(|role| role.name()).collect::<Vec<_>>().join(", ")
}

fn ros_names() -> String {
    Role::ALL.iter().map(|role| role.ros_name()).collect::<Vec<_>>().join(", ")
}
