//! Names of nodes, topics and types as ros2-client has them.

use ros2_client::{MessageTypeName, Name, NodeName};
use thiserror::Error;

/// A name that ROS 2 does not allow.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("`{name}` is not a name in ROS 2: {problem}")]
pub struct NameError {
    name: String,
    problem: String,
}

/// A node by its namespace and name.
pub(super) fn node_name(namespace: &str, name: &str) -> Result<NodeName, NameError> {
    NodeName::new(namespace, name)
        .map_err(|e| NameError { name: name.to_owned(), problem: e.to_string() })
}

/// A topic or service by its full name.
pub(super) fn parsed(name: &str) -> Result<Name, NameError> {
    Name::parse(name).map_err(|e| NameError { name: name.to_owned(), problem: e.to_string() })
}

/// `package/msg/Name` as DDS needs it.
pub(super) fn type_name(full: &str) -> MessageTypeName {
    let mut parts = full.split('/');
    let (package, name) = (parts.next().unwrap_or_default(), parts.next_back().unwrap_or_default());
    MessageTypeName::new(package, name)
}
