//! Names of nodes, topics and types as ros2-client has them.

use super::node::NotCreated;
use ros2_client::{MessageTypeName, Name, NodeName, ServiceTypeName};

/// A node by its namespace and name.
pub(super) fn node_name(namespace: &str, name: &str) -> Result<NodeName, NotCreated> {
    NodeName::new(namespace, name).map_err(|e| NotCreated::new(name, e))
}

/// A topic or service by its full name.
pub(super) fn parsed(name: &str) -> Result<Name, NotCreated> {
    Name::parse(name).map_err(|e| NotCreated::new(name, e))
}

/// `package/msg/Name` as ros2-client needs it.
pub(super) fn type_name(full: &str) -> MessageTypeName {
    let (package, name) = package_and_name(full);
    MessageTypeName::new(package, name)
}

/// `package/srv/Name` as ros2-client needs it.
pub(super) fn service_type_name(full: &str) -> ServiceTypeName {
    let (package, name) = package_and_name(full);
    ServiceTypeName::new(package, name)
}

/// `package/msg/Name` of a DDS type name.
pub(super) fn ros_type(dds: &str) -> String {
    let name = dds.replace("::dds_::", "/").replace("::", "/");
    name.strip_suffix('_').unwrap_or(&name).to_owned()
}

/// The DDS type name of `package/msg/Name` or `package/srv/Name`.
#[cfg(feature = "zenoh")]
pub(super) fn dds_type(name: &str) -> String {
    match name.rsplit_once('/') {
        Some((kind, name)) => format!("{}::dds_::{name}_", kind.replace('/', "::")),
        None => name.to_owned(),
    }
}

fn package_and_name(full: &str) -> (&str, &str) {
    let mut parts = full.split('/');
    (parts.next().unwrap_or_default(), parts.next_back().unwrap_or_default())
}
