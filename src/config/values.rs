//! A tree of values laid over another one.

use super::{ConfigError, keys};
use serde_json::{Map, Value};

/// Lays `given` over `base`, whose keys are the only ones allowed, but for classes. A key may name a section and what is
/// in it, joined by a dot.
pub(super) fn overlay(base: &mut Value, given: &Value) -> Result<(), ConfigError> {
    merge(base, given, "")
}

fn merge(base: &mut Value, given: &Value, path: &str) -> Result<(), ConfigError> {
    let (Value::Object(known), Value::Object(given)) = (&mut *base, given) else {
        if base.is_object() && !is_class(path) {
            return Err(ConfigError::WrongKind(format!("`{path}` is a section, not a value")));
        }
        *base = in_kind_of(base, given);
        return Ok(());
    };
    for (key, value) in given {
        let (first, rest) = key.split_once('.').unwrap_or((key, ""));
        let path = joined(path, first);
        let nested = Value::Object(Map::from_iter([(rest.to_owned(), value.clone())]));
        let value = if rest.is_empty() { value } else { &nested };
        match known.get_mut(first) {
            Some(slot) => merge(slot, value, &path)?,
            None if is_class(&path) => {
                let mut class = Value::Object(Map::new());
                merge(&mut class, value, &path)?;
                known.insert(first.to_owned(), class);
            }
            None => {
                let path = joined(&path, rest);
                let nearest = nearest(&path);
                return Err(ConfigError::UnknownKey { path, nearest });
            }
        }
    }
    Ok(())
}

pub(super) fn joined(path: &str, name: &str) -> String {
    match (path, name) {
        ("", name) => name.to_owned(),
        (path, "") => path.to_owned(),
        _ => format!("{path}.{name}"),
    }
}

/// Labels are the detector's business.
pub(super) fn is_class(path: &str) -> bool {
    path.starts_with("perception.classes.listed.")
        || path.starts_with("perception.classes.unlisted.")
}

/// ROS 2 reads YAML 1.1, where `yes` and `on` are bools: they are where a bool is wanted.
fn in_kind_of(base: &Value, given: &Value) -> Value {
    const TRUE: [&str; 4] = ["y", "yes", "true", "on"];
    const FALSE: [&str; 4] = ["n", "no", "false", "off"];
    let word = given.as_str().filter(|_| base.is_boolean()).map(str::to_ascii_lowercase);
    match word.as_deref() {
        Some(word) if TRUE.contains(&word) => Value::Bool(true),
        Some(word) if FALSE.contains(&word) => Value::Bool(false),
        _ => given.clone(),
    }
}

fn nearest(path: &str) -> Option<String> {
    let best = keys().max_by(|a, b| {
        strsim::jaro_winkler(a.path, path).total_cmp(&strsim::jaro_winkler(b.path, path))
    })?;
    (strsim::jaro_winkler(best.path, path) > 0.8).then(|| best.path.to_owned())
}

pub(super) fn check_ranges(settings: &Value) -> Result<(), ConfigError> {
    for key in keys() {
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
