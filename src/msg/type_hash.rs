//! Hashes of types, by which `rmw_zenoh` tells versions of a type apart (REP 2016).
//!
//! A hash is the SHA-256 of a description of the type and of all types in it as JSON, to the last space as Python's
//! `json.dumps` writes it.

use super::schema::{SEPARATOR, definition, without_comment};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// The hash of a message type (`pkg/msg/Name`) whose definition is given in the layout of
/// [`schema_text`](super::schema_text); nothing when the definition cannot be read.
pub fn message_hash(type_name: &str, text: &str) -> Option<String> {
    let mut sections = text.split(SEPARATOR);
    let root = Structure::parse(type_name, sections.next()?)?;
    let mut parts = BTreeMap::new();
    for section in sections {
        let (name, text) = section.trim_start().strip_prefix("MSG: ")?.split_once('\n')?;
        let name = with_kind(name.trim());
        parts.insert(name.clone(), Structure::parse(&name, text)?);
    }
    Some(hash(&root, parts.values()))
}

/// The hash of a service type (`pkg/srv/Name`); nothing for one that is not served here.
pub fn service_hash(type_name: &str) -> Option<String> {
    let (request, response) = text_of(&type_name.replace("/srv/", "/"))?.split_once("---")?;
    let part = |end: &str| format!("{type_name}_{end}");
    let message = |name: &str, end: &str| Field::plain(name, Kind::nested(&part(end)));
    let at_most_one = |name: &str, end: &str| {
        let kind = Kind { id: NESTED + BOUNDED, capacity: 1, ..Kind::nested(&part(end)) };
        Field::plain(name, kind)
    };
    let root = Structure {
        name: type_name.to_owned(),
        fields: vec![
            message("request_message", "Request"),
            message("response_message", "Response"),
            message("event_message", "Event"),
        ],
    };
    let info = Field::plain("info", Kind::nested("service_msgs/msg/ServiceEventInfo"));
    let event = [info, at_most_one("request", "Request"), at_most_one("response", "Response")];
    let mut todo = vec![
        Structure::parse(&part("Request"), request)?,
        Structure::parse(&part("Response"), response)?,
        Structure { name: part("Event"), fields: event.into() },
    ];
    let mut parts = BTreeMap::new();
    while let Some(next) = todo.pop() {
        for field in next.fields.iter().filter(|field| !field.kind.nested.contains("/srv/")) {
            let name = &field.kind.nested;
            if !name.is_empty() && !parts.contains_key(name) {
                todo.push(Structure::parse(name, text_of(&name.replace("/msg/", "/"))?)?);
            }
        }
        parts.insert(next.name.clone(), next);
    }
    Some(hash(&root, parts.values()))
}

/// The text of a `.msg` or `.srv` file by `pkg/Name`.
fn text_of(name: &str) -> Option<&'static str> {
    let served = SERVED.iter().find(|(known, _)| *known == name).map(|(_, text)| *text);
    served.or_else(|| definition(name))
}

/// A message type.
struct Structure {
    name: String,
    fields: Vec<Field>,
}

struct Field {
    name: String,
    kind: Kind,
}

/// A field's type, as `type_description_interfaces/msg/FieldType` has it.
struct Kind {
    id: u8,
    capacity: u64,
    string_capacity: u64,
    /// `pkg/msg/Name`, or nothing for a primitive.
    nested: String,
}

const NESTED: u8 = 1;
const UINT8: u8 = 3;
const STRING: u8 = 17;
/// What makes a type an array, a sequence that is bounded, or any sequence of it.
const ARRAY: u8 = 48;
const BOUNDED: u8 = 96;
const SEQUENCE: u8 = 144;
/// From a string to one that is bounded.
const BOUNDED_STRING: u8 = 4;

impl Structure {
    fn parse(name: &str, text: &str) -> Option<Self> {
        let package = name.split('/').next()?;
        let mut fields = Vec::new();
        for line in text.lines().map(without_comment) {
            let Some((kind, rest)) = line.trim().split_once(char::is_whitespace) else { continue };
            let mut words = rest.split_whitespace();
            let name = words.next()?;
            let is_constant =
                name.contains('=') || words.next().is_some_and(|word| word.starts_with('='));
            if !is_constant {
                fields.push(Field::plain(name, Kind::parse(kind, package)?));
            }
        }
        if fields.is_empty() {
            let nothing = Field::plain("structure_needs_at_least_one_member", Kind::of(UINT8));
            fields.push(nothing);
        }
        Some(Self { name: name.to_owned(), fields })
    }

    fn json(&self) -> String {
        let fields: Vec<String> = self.fields.iter().map(Field::json).collect();
        format!(r#"{{"type_name": "{}", "fields": [{}]}}"#, self.name, fields.join(", "))
    }
}

impl Field {
    fn plain(name: &str, kind: Kind) -> Self {
        Self { name: name.to_owned(), kind }
    }

    fn json(&self) -> String {
        let Kind { id, capacity, string_capacity, nested } = &self.kind;
        format!(
            r#"{{"name": "{}", "type": {{"type_id": {id}, "capacity": {capacity}, "string_capacity": {string_capacity}, "nested_type_name": "{nested}"}}}}"#,
            self.name
        )
    }
}

impl Kind {
    fn of(id: u8) -> Self {
        Self { id, capacity: 0, string_capacity: 0, nested: String::new() }
    }

    fn nested(name: &str) -> Self {
        Self { nested: name.to_owned(), ..Self::of(NESTED) }
    }

    /// From a field's type in a `.msg` file of a package.
    fn parse(text: &str, package: &str) -> Option<Self> {
        if let Some((element, count)) =
            text.strip_suffix(']').and_then(|text| text.rsplit_once('['))
        {
            let (several, capacity) = match (count, count.strip_prefix("<=")) {
                ("", _) => (SEQUENCE, 0),
                (_, Some(most)) => (BOUNDED, most.parse().ok()?),
                (count, None) => (ARRAY, count.parse().ok()?),
            };
            let element = Self::parse(element, package)?;
            return Some(Self { id: element.id + several, capacity, ..element });
        }
        let (name, most) = text.split_once("<=").unwrap_or((text, ""));
        let Some((_, id)) = PRIMITIVES.iter().find(|(known, _)| *known == name) else {
            return Some(Self::nested(&match name.contains('/') {
                true => with_kind(name),
                false => format!("{package}/msg/{name}"),
            }));
        };
        match most {
            "" => Some(Self::of(*id)),
            most => {
                Some(Self { string_capacity: most.parse().ok()?, ..Self::of(id + BOUNDED_STRING) })
            }
        }
    }
}

/// `pkg/msg/Name` of `pkg/Name`, too.
fn with_kind(name: &str) -> String {
    match name.split_once('/') {
        Some((package, rest)) if !rest.contains('/') => format!("{package}/msg/{rest}"),
        _ => name.to_owned(),
    }
}

fn hash<'a>(root: &Structure, parts: impl Iterator<Item = &'a Structure>) -> String {
    let parts: Vec<String> = parts.map(Structure::json).collect();
    let json = format!(
        r#"{{"type_description": {}, "referenced_type_descriptions": [{}]}}"#,
        root.json(),
        parts.join(", ")
    );
    let digest = Sha256::digest(json);
    let digits: Vec<String> = digest.iter().map(|byte| format!("{byte:02x}")).collect();
    format!("RIHS01_{}", digits.concat())
}

const PRIMITIVES: [(&str, u8); 16] = [
    ("int8", 2),
    ("uint8", UINT8),
    ("int16", 4),
    ("uint16", 5),
    ("int32", 6),
    ("uint32", 7),
    ("int64", 8),
    ("uint64", 9),
    ("float32", 10),
    ("float64", 11),
    // In ROS 2 a number.
    ("char", UINT8),
    ("bool", 15),
    ("byte", 16),
    ("string", STRING),
    ("wstring", 18),
    ("wchar", 14),
];

/// The services that the node offers, and messages that only they and logging need.
const SERVED: &[(&str, &str)] = &[
    ("ellipsoid_slam/AddObject", include_str!("../../srv/AddObject.srv")),
    ("ellipsoid_slam/ApproachObject", include_str!("../../srv/ApproachObject.srv")),
    ("ellipsoid_slam/DeleteObject", include_str!("../../srv/DeleteObject.srv")),
    ("ellipsoid_slam/LoadMap", include_str!("../../srv/LoadMap.srv")),
    ("ellipsoid_slam/LockObject", include_str!("../../srv/LockObject.srv")),
    ("ellipsoid_slam/QueryObjects", include_str!("../../srv/QueryObjects.srv")),
    ("ellipsoid_slam/RenameObject", include_str!("../../srv/RenameObject.srv")),
    ("ellipsoid_slam/SaveMap", include_str!("../../srv/SaveMap.srv")),
    ("lifecycle_msgs/ChangeState", include_str!("../../srv/ros/lifecycle_msgs/ChangeState.srv")),
    (
        "lifecycle_msgs/GetAvailableStates",
        include_str!("../../srv/ros/lifecycle_msgs/GetAvailableStates.srv"),
    ),
    (
        "lifecycle_msgs/GetAvailableTransitions",
        include_str!("../../srv/ros/lifecycle_msgs/GetAvailableTransitions.srv"),
    ),
    ("lifecycle_msgs/GetState", include_str!("../../srv/ros/lifecycle_msgs/GetState.srv")),
    ("std_srvs/SetBool", include_str!("../../srv/ros/std_srvs/SetBool.srv")),
    ("std_srvs/Trigger", include_str!("../../srv/ros/std_srvs/Trigger.srv")),
    (
        "rcl_interfaces/DescribeParameters",
        include_str!("../../srv/ros/rcl_interfaces/DescribeParameters.srv"),
    ),
    (
        "rcl_interfaces/GetParameters",
        include_str!("../../srv/ros/rcl_interfaces/GetParameters.srv"),
    ),
    (
        "rcl_interfaces/GetParameterTypes",
        include_str!("../../srv/ros/rcl_interfaces/GetParameterTypes.srv"),
    ),
    (
        "rcl_interfaces/ListParameters",
        include_str!("../../srv/ros/rcl_interfaces/ListParameters.srv"),
    ),
    (
        "rcl_interfaces/SetParameters",
        include_str!("../../srv/ros/rcl_interfaces/SetParameters.srv"),
    ),
    (
        "rcl_interfaces/SetParametersAtomically",
        include_str!("../../srv/ros/rcl_interfaces/SetParametersAtomically.srv"),
    ),
    (
        "rcl_interfaces/FloatingPointRange",
        include_str!("../../msg/ros/rcl_interfaces/FloatingPointRange.msg"),
    ),
    ("rcl_interfaces/IntegerRange", include_str!("../../msg/ros/rcl_interfaces/IntegerRange.msg")),
    (
        "rcl_interfaces/ListParametersResult",
        include_str!("../../msg/ros/rcl_interfaces/ListParametersResult.msg"),
    ),
    ("rcl_interfaces/Parameter", include_str!("../../msg/ros/rcl_interfaces/Parameter.msg")),
    (
        "rcl_interfaces/ParameterDescriptor",
        include_str!("../../msg/ros/rcl_interfaces/ParameterDescriptor.msg"),
    ),
    (
        "rcl_interfaces/ParameterValue",
        include_str!("../../msg/ros/rcl_interfaces/ParameterValue.msg"),
    ),
    (
        "rcl_interfaces/SetParametersResult",
        include_str!("../../msg/ros/rcl_interfaces/SetParametersResult.msg"),
    ),
    (
        "service_msgs/ServiceEventInfo",
        include_str!("../../msg/ros/service_msgs/ServiceEventInfo.msg"),
    ),
];
