//! Topics that were named by hand: on the command line, or in the section `topics` of a parameter file.

use super::{Role, RoleError};
use crate::{
    config::{AUTO, DepthTransport, RgbTransport, RosArguments, TopicSettings},
    msg::convert::without_transport,
};
use std::str::FromStr;

/// A role given by hand: `depth:=/topic`, or by the name of the node's topic, `depth/image:=/topic`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remap {
    /// The role.
    pub role: Role,
    /// The topic for it; empty: none.
    pub topic: String,
}

impl FromStr for Remap {
    type Err = RoleError;

    fn from_str(given: &str) -> Result<Self, RoleError> {
        let bad = || RoleError::BadRemap { given: given.to_owned() };
        let (name, topic) = given.split_once(":=").ok_or_else(bad)?;
        if topic.is_empty() {
            return Err(bad());
        }
        let unknown = || RoleError::UnknownRole { given: name.to_owned() };
        let plain = name.trim_start_matches('/');
        let is = |role: &&Role| plain == role.name() || plain == role.ros_name();
        let role = Role::ALL.iter().find(is).ok_or_else(unknown)?;
        Ok(Self { role: *role, topic: absolute(topic) })
    }
}

/// What the section `topics` says: a remap for each role that is not left to be found.
pub fn given_by(settings: &TopicSettings) -> Vec<Remap> {
    let named = |role: &Role| {
        let name = name_of(settings, *role);
        let topic = match name {
            AUTO => return None,
            "" => String::new(),
            name => with_transport(settings, *role, absolute(name)),
        };
        Some(Remap { role: *role, topic })
    };
    Role::ALL.iter().filter_map(named).collect()
}

/// The same for a node, whose arguments remap roles and topics, and put names into its namespace.
pub fn given_to_node(settings: &TopicSettings, arguments: &RosArguments) -> Vec<Remap> {
    let named = |role: &Role| {
        let own = name_of(settings, *role);
        let remapped = [role.name(), role.ros_name()].into_iter();
        let remapped =
            remapped.filter(|name| *name != own).find_map(|name| arguments.remapped(name));
        let topic = match (remapped, own) {
            (Some(topic), _) => topic,
            (None, AUTO) => return None,
            (None, "") => String::new(),
            (None, name) => arguments.resolve(name),
        };
        let topic = if topic.is_empty() { topic } else { with_transport(settings, *role, topic) };
        Some(Remap { role: *role, topic })
    };
    Role::ALL.iter().filter_map(named).collect()
}

/// The names that the section `topics` gives.
pub fn given_names(settings: &TopicSettings) -> impl Iterator<Item = &str> {
    let names = Role::ALL.iter().map(|role| name_of(settings, *role));
    names.filter(|name| !name.is_empty() && *name != AUTO)
}

fn name_of(settings: &TopicSettings, role: Role) -> &str {
    match role {
        Role::Rgb => &settings.rgb,
        Role::Depth => &settings.depth,
        Role::CameraInfo => &settings.camera_info,
        Role::DepthCameraInfo => &settings.depth_camera_info,
        Role::Odometry => &settings.odometry,
        Role::Detections => &settings.detections,
        Role::Detections3d => &settings.detections_3d,
    }
}

/// The topic of a transport; a name that has it already is taken as it is.
fn with_transport(settings: &TopicSettings, role: Role, topic: String) -> String {
    let end = match (role, settings.rgb_transport, settings.depth_transport) {
        (Role::Rgb, RgbTransport::Compressed, _) => "/compressed",
        (Role::Depth, _, DepthTransport::Compressed) => "/compressed",
        (Role::Depth, _, DepthTransport::CompressedDepth) => "/compressedDepth",
        _ => "",
    };
    if without_transport(&topic) == topic { topic + end } else { topic }
}

fn absolute(name: &str) -> String {
    format!("/{}", name.trim_start_matches('/'))
}
