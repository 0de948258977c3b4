//! Remappings of names that there are not.

use super::initial_pose::INITIAL_POSE;
use crate::{
    config::{RosArguments, TopicSettings},
    publication::OutputTopic,
    topics::{Role, given_names},
};
use std::collections::BTreeSet;
use thiserror::Error;

/// A remapping that changes nothing.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("`-r {from}:=...` remaps nothing; what can be remapped is {}", names.join(", "))]
pub struct UnmatchedRemap {
    /// What was to be remapped.
    pub from: String,
    /// Names that there are.
    pub names: Vec<String>,
}

/// Names of services, and of topics that every node has.
const OTHERS: [&str; 23] = [
    "/tf",
    "/tf_static",
    "/clock",
    INITIAL_POSE,
    "/diagnostics",
    "/rosout",
    "/parameter_events",
    "~/reset",
    "~/pause",
    "~/save_map",
    "~/load_map",
    "~/query_objects",
    "~/approach_object",
    "~/rename_object",
    "~/delete_object",
    "~/lock_object",
    "~/add_object",
    "~/get_parameters",
    "~/get_parameter_types",
    "~/list_parameters",
    "~/describe_parameters",
    "~/set_parameters",
    "~/set_parameters_atomically",
];

/// Whether each remapping is of a role, a topic or a service of the node.
///
/// # Errors
/// When one is of none of them: often a slip of the pen, which would leave the node without input.
pub fn check_remaps(
    arguments: &RosArguments,
    topics: &TopicSettings,
) -> Result<(), UnmatchedRemap> {
    let mut names: Vec<&str> = Vec::new();
    Role::ALL.iter().for_each(|role| names.extend([role.name(), role.ros_name()]));
    names.extend(given_names(topics));
    OutputTopic::ALL.iter().for_each(|topic| names.push(topic.name()));
    OTHERS.iter().for_each(|name| names.push(name));
    let mut seen = BTreeSet::new();
    names.retain(|name| seen.insert(*name));
    match arguments.unmatched(names.iter().copied()) {
        None => Ok(()),
        Some(from) => {
            let names = names.into_iter().map(str::to_owned).collect();
            Err(UnmatchedRemap { from: from.to_owned(), names })
        }
    }
}
