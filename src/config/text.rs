//! Parameter files: `/**: ros__parameters: ...`.

use super::{Parameters, keys, values};
use serde_json::{Map, Value};
use std::fmt::Write;
use thiserror::Error;

/// Why a text is not a configuration.
#[derive(Debug, Error)]
pub enum ConfigError {
    /// Not YAML.
    #[error("not valid YAML: {0}")]
    Yaml(String),
    /// Not in ROS 2's form.
    #[error("expected `/**:` or `ellipsoid_slam:` with `ros__parameters:` below it")]
    NotRos,
    /// A key that does not exist.
    #[error("unknown key `{path}`{}", suggestion(nearest))]
    UnknownKey {
        /// What was written.
        path: String,
        /// The key that was probably meant.
        nearest: Option<String>,
    },
    /// A number out of range.
    #[error("`{path}` is {value}, which is not between {low} and {high}")]
    OutOfRange {
        /// The key.
        path: &'static str,
        /// What was written.
        value: f64,
        /// Smallest allowed.
        low: f64,
        /// Largest allowed.
        high: f64,
    },
    /// Numbers that do not go together.
    #[error("`{path}` {wanted}")]
    Unfit {
        /// The key.
        path: String,
        /// What it has to be.
        wanted: &'static str,
    },
    /// A value of the wrong kind.
    #[error("{0}")]
    WrongKind(String),
}

fn suggestion(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|n| format!("; did you mean `{n}`?")).unwrap_or_default()
}

/// Parameters from a file as `replay` gets it, for the node with the default name; keys that are not in it keep their
/// defaults.
///
/// # Errors
/// When the text is not YAML in ROS 2's form, has an unknown key or a value out of range.
pub fn parameters_from_yaml(text: &str) -> Result<Parameters, ConfigError> {
    let sections = sections_of(text, &format!("/{NODE}"))?;
    let mut parameters = Parameters::default();
    if sections.is_empty() {
        return Err(ConfigError::NotRos);
    }
    for section in sections {
        parameters.overlay(&section)?;
    }
    Ok(parameters)
}

/// What a parameter file says for the node of this full name: the content of each `ros__parameters` that is meant for it.
/// Names may be nested in namespaces, `*` stands for one part of a name and `**` for any number. Wildcards come
/// before names; what they say of parameters that are not ours is for others.
///
/// # Errors
/// When the text is not YAML, or a name below a wildcard is hardly another's, but one of ours with a slip of the pen.
pub fn sections_of(text: &str, node: &str) -> Result<Vec<Value>, ConfigError> {
    let file = yaml(text)?;
    let mut found = Vec::new();
    collect_sections(&file, "", node, &mut found)?;
    Ok(found)
}

/// A value as YAML has it.
///
/// # Errors
/// When the text is not YAML.
pub(super) fn yaml(text: &str) -> Result<Value, ConfigError> {
    serde_saphyr::from_str(text).map_err(|e| {
        let text = e.to_string();
        let first = text.lines().next().unwrap_or_default();
        ConfigError::Yaml(first.trim_start_matches("error: ").to_owned())
    })
}

fn collect_sections(
    tree: &Value,
    path: &str,
    node: &str,
    found: &mut Vec<Value>,
) -> Result<(), ConfigError> {
    let Some(names) = tree.as_object() else { return Ok(()) };
    for (name, value) in names {
        if name != PARAMETERS {
            let path = format!("{path}/{}", name.trim_matches('/'));
            collect_sections(value, &path, node, found)?;
        } else if matches(&parts(path), &parts(node)) {
            let mut section =
                if value.is_null() { Value::Object(Map::new()) } else { value.clone() };
            if let (Some(section), true) = (section.as_object_mut(), path.contains('*')) {
                let ours = Parameters::default().tree()?;
                let first = |key: &str| key.split('.').next().unwrap_or_default().to_owned();
                if let Some((path, nearest)) = slip(section.keys().map(|key| first(key)), &ours) {
                    return Err(ConfigError::UnknownKey { path, nearest: Some(nearest) });
                }
                section.retain(|key, _| ours.get(first(key)).is_some());
            }
            found.push(section);
        }
    }
    Ok(())
}

/// The first name that is none of ours but nearly one, and that one.
fn slip(names: impl Iterator<Item = String>, ours: &Value) -> Option<(String, String)> {
    let known: Vec<&String> = ours.as_object()?.keys().collect();
    names.filter(|name| ours.get(name).is_none()).find_map(|name| {
        let is_near =
            |own: &&&String| own.len() > 3 && strsim::damerau_levenshtein(own, &name) <= 2;
        let near = known.iter().find(is_near).map(|own| (*own).clone());
        near.map(|near| (name, near))
    })
}

fn parts(name: &str) -> Vec<&str> {
    name.split('/').filter(|part| !part.is_empty()).collect()
}

fn matches(pattern: &[&str], name: &[&str]) -> bool {
    match (pattern, name) {
        ([], []) => true,
        (["**", rest @ ..], _) => (0..=name.len()).any(|skip| matches(rest, &name[skip..])),
        (["*", pattern @ ..], [_, name @ ..]) => matches(pattern, name),
        ([first, pattern @ ..], [part, name @ ..]) => first == part && matches(pattern, name),
        _ => false,
    }
}

/// The parameters as a commented file.
///
/// # Errors
/// Never for parameters that were read or are defaults; a value that is no text would be a bug.
pub fn parameters_to_yaml(parameters: &Parameters) -> Result<String, ConfigError> {
    let mut text = format!("{ALL_NODES}:\n  {PARAMETERS}:\n");
    if let Value::Object(sections) = parameters.tree()? {
        emit(&mut text, &sections, "", 2);
    }
    Ok(text)
}

fn emit(text: &mut String, section: &Map<String, Value>, path: &str, depth: usize) {
    // In the order of the table of keys; keys that it does not have are classes, in their own order.
    let place = |key: &str| {
        let full = values::joined(path, key);
        (keys().position(|k| k.path == full).unwrap_or(usize::MAX), full)
    };
    let mut entries: Vec<(&String, &Value)> = section.iter().collect();
    entries.sort_by_key(|(key, _)| place(key));
    let indent = "  ".repeat(depth);
    for (key, value) in entries {
        let (at, full) = place(key);
        let meaning = keys().nth(at).map_or("", |k| k.meaning);
        let line = match value {
            Value::Object(inner) if meaning_is_section(inner, &full) => {
                let _ = writeln!(text, "{indent}# {meaning}\n{indent}{key}:");
                emit(text, inner, &full, depth + 1);
                continue;
            }
            _ if meaning.is_empty() => format!("{indent}{key}: {}", flow(value)),
            _ => format!("{indent}{key}: {}  # {meaning}", flow(value)),
        };
        text.push_str(&line);
        text.push('\n');
    }
}

/// A class is written on one line.
fn meaning_is_section(inner: &Map<String, Value>, path: &str) -> bool {
    !inner.contains_key("symmetry") && !path.ends_with(".unlisted")
}

/// A value in YAML's flow style, without quotes where none are needed.
pub(super) fn flow(value: &Value) -> String {
    match value {
        Value::Object(map) => {
            let parts: Vec<String> = map.iter().map(|(k, v)| format!("{k}: {}", flow(v))).collect();
            format!("{{{}}}", parts.join(", "))
        }
        Value::Array(items) => {
            let parts: Vec<String> = items.iter().map(flow).collect();
            format!("[{}]", parts.join(", "))
        }
        Value::String(s)
            if !s.is_empty()
                && s != "none"
                && s.chars().all(|c| c.is_ascii_alphanumeric() || "_/".contains(c)) =>
        {
            s.clone()
        }
        other => other.to_string(),
    }
}

const NODE: &str = "ellipsoid_slam";
/// Whatever the node is called, and in whatever namespace.
const ALL_NODES: &str = "/**";
const PARAMETERS: &str = "ros__parameters";
