//! Names of the node and its topics.

use ros2_client::{MessageTypeName, Name, NodeName};
use thiserror::Error;

/// What the node is called, and what its topics are called instead.
#[derive(Clone, Debug)]
pub struct Identity {
    /// `__node`.
    pub name: String,
    /// `__ns`, with a leading slash.
    pub namespace: String,
    /// Topics and services: from, to.
    pub remaps: Vec<(String, String)>,
}

/// A name that ROS 2 does not allow.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("`{name}` is not a ROS 2 name: {problem}")]
pub struct NameError {
    name: String,
    problem: String,
}

impl Default for Identity {
    fn default() -> Self {
        Self { name: "ellipsoid_slam".into(), namespace: "/".into(), remaps: Vec::new() }
    }
}

impl Identity {
    /// The absolute name of a topic or service after remapping. `~` stands for the node.
    pub(super) fn resolve(&self, name: &str) -> String {
        let own = self.absolute(name);
        let remap = self.remaps.iter().find(|(from, _)| self.absolute(from) == own);
        remap.map_or(own, |(_, to)| self.absolute(to))
    }

    /// The name with namespace and node.
    pub(super) fn full_name(&self) -> String {
        join(&self.namespace, &self.name)
    }

    pub(super) fn node_name(&self) -> Result<NodeName, NameError> {
        NodeName::new(&self.namespace, &self.name)
            .map_err(|e| NameError { name: self.full_name(), problem: e.to_string() })
    }

    fn absolute(&self, name: &str) -> String {
        match name.strip_prefix("~/") {
            Some(private) => join(&self.full_name(), private),
            None if name.starts_with('/') => name.to_owned(),
            None => join(&self.namespace, name),
        }
    }
}

fn join(namespace: &str, name: &str) -> String {
    format!("{}/{name}", namespace.trim_end_matches('/'))
}

/// A topic or service by its absolute name.
pub(super) fn parsed(name: &str) -> Result<Name, NameError> {
    Name::parse(name).map_err(|e| NameError { name: name.to_owned(), problem: e.to_string() })
}

/// `package/msg/Name` as DDS needs it.
pub(super) fn type_name(full: &str) -> MessageTypeName {
    let mut parts = full.split('/');
    let (package, name) = (parts.next().unwrap_or_default(), parts.next_back().unwrap_or_default());
    MessageTypeName::new(package, name)
}
