//! Parameter files: `ellipsoid_slam: ros__parameters: ...`.

use super::KEYS;
use crate::pipeline::Settings;
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
    #[error("expected `ellipsoid_slam:` with `ros__parameters:` below it")]
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
    /// A value of the wrong kind.
    #[error("{0}")]
    WrongKind(String),
}

fn suggestion(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|n| format!("; did you mean `{n}`?")).unwrap_or_default()
}

/// Settings from a parameter file; keys that are not in it keep their defaults.
///
/// # Errors
/// When the text is not YAML in ROS 2's form, has an unknown key or a value out of range.
pub fn settings_from_yaml(text: &str) -> Result<Settings, ConfigError> {
    let file: Value = serde_saphyr::from_str(text).map_err(|e| {
        let text = e.to_string();
        let first = text.lines().next().unwrap_or_default();
        ConfigError::Yaml(first.trim_start_matches("error: ").to_owned())
    })?;
    let given = file
        .as_object()
        .and_then(|nodes| nodes.get(NODE).or_else(|| nodes.get(ANY_NODE)))
        .and_then(|node| node.get(PARAMETERS))
        .ok_or(ConfigError::NotRos)?;
    let mut merged = to_value(&Settings::default())?;
    if !given.is_null() {
        merge(&mut merged, given, "")?;
    }
    check_ranges(&merged)?;
    serde_json::from_value(merged).map_err(|e| ConfigError::WrongKind(e.to_string()))
}

/// The settings as a commented parameter file.
///
/// # Errors
/// Never for settings that were read or are defaults; a value that is no text would be a bug.
pub fn settings_to_yaml(settings: &Settings) -> Result<String, ConfigError> {
    let mut text = format!("{NODE}:\n  {PARAMETERS}:\n");
    if let Value::Object(sections) = to_value(settings)? {
        emit(&mut text, &sections, "", 2);
    }
    Ok(text)
}

fn to_value(settings: &Settings) -> Result<Value, ConfigError> {
    serde_json::to_value(settings).map_err(|e| ConfigError::WrongKind(e.to_string()))
}

/// Lays `given` over `base`, whose keys are the only ones allowed, but for classes.
fn merge(base: &mut Value, given: &Value, path: &str) -> Result<(), ConfigError> {
    let (Value::Object(known), Value::Object(given)) = (&mut *base, given) else {
        *base = given.clone();
        return Ok(());
    };
    for (key, value) in given {
        let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        if is_free(&path) {
            known.insert(key.clone(), value.clone());
        } else if let Some(slot) = known.get_mut(key) {
            merge(slot, value, &path)?;
        } else {
            let nearest = nearest(&path);
            return Err(ConfigError::UnknownKey { path, nearest });
        }
    }
    Ok(())
}

/// Labels are the detector's business, and a class is given as a whole.
fn is_free(path: &str) -> bool {
    path.starts_with("perception.classes.listed.")
        || path.starts_with("perception.classes.unlisted.")
}

fn nearest(path: &str) -> Option<String> {
    let best = KEYS.iter().max_by(|a, b| {
        strsim::jaro_winkler(a.path, path).total_cmp(&strsim::jaro_winkler(b.path, path))
    })?;
    (strsim::jaro_winkler(best.path, path) > 0.8).then(|| best.path.to_owned())
}

fn check_ranges(settings: &Value) -> Result<(), ConfigError> {
    for key in KEYS {
        let Some(range) = &key.range else { continue };
        let value = key.path.split('.').try_fold(settings, |v, part| v.get(part));
        let Some(value) = value.and_then(Value::as_f64) else {
            return Err(ConfigError::WrongKind(format!("`{}` must be a number", key.path)));
        };
        if !range.contains(&value) {
            let (low, high) = (*range.start(), *range.end());
            return Err(ConfigError::OutOfRange { path: key.path, value, low, high });
        }
    }
    Ok(())
}

fn emit(text: &mut String, section: &Map<String, Value>, path: &str, depth: usize) {
    // In the order of the table of keys; keys that it does not have are classes, in their own order.
    let place = |key: &str| {
        let full = if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
        (KEYS.iter().position(|k| k.path == full).unwrap_or(usize::MAX), full)
    };
    let mut keys: Vec<(&String, &Value)> = section.iter().collect();
    keys.sort_by_key(|(key, _)| place(key));
    let indent = "  ".repeat(depth);
    for (key, value) in keys {
        let (at, full) = place(key);
        let meaning = KEYS.get(at).map_or("", |k| k.meaning);
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
fn flow(value: &Value) -> String {
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
const ANY_NODE: &str = "/**";
const PARAMETERS: &str = "ros__parameters";
