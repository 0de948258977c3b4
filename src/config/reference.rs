//! All settings with their defaults, ranges and meanings, as Markdown.

use super::{ConfigError, Key, Parameters, keys, text::flow};
use serde_json::Value;
use std::{fmt::Write, ops::RangeInclusive};

/// The reference of all settings: a table a section.
///
/// # Errors
/// Never: the defaults can be written.
pub fn reference() -> Result<String, ConfigError> {
    let defaults = Parameters::default().tree()?;
    let mut text = INTRODUCTION.to_owned();
    table(&mut text, "", &defaults);
    for section in keys().filter(|key| is_section(key, &defaults)) {
        let _ = writeln!(text, "\n## {}\n\n{}", section.path, escaped(section.meaning));
        table(&mut text, section.path, &defaults);
    }
    Ok(text)
}

/// The keys that are directly in a section.
fn table(text: &mut String, section: &str, defaults: &Value) {
    let is_in = |key: &&Key| key.path.rsplit_once('.').map_or("", |(above, _)| above) == section;
    let mut rows = keys().filter(is_in).filter(|key| !is_section(key, defaults)).peekable();
    if rows.peek().is_some() {
        text.push_str(
            "\n| key | default | range | counts | meaning |\n| --- | --- | --- | --- | --- |\n",
        );
    }
    for key in rows {
        let value = match value_of(key, defaults) {
            Some(Value::Object(all)) if key.path == LISTED => format!("{} classes", all.len()),
            Some(value) => format!("`{}`", escaped(&flow(value))),
            None => String::new(),
        };
        let range = key.range.as_ref().map(shown).unwrap_or_default();
        let counts = if key.live { "at once" } else { "at the start" };
        let (path, meaning) = (key.path, escaped(key.meaning));
        let _ = writeln!(text, "| `{path}` | {value} | {range} | {counts} | {meaning} |");
    }
}

fn value_of<'a>(key: &Key, tree: &'a Value) -> Option<&'a Value> {
    key.path.split('.').try_fold(tree, |section, part| section.get(part))
}

/// Whether a key has others below it; classes are values.
fn is_section(key: &Key, defaults: &Value) -> bool {
    let is_class = key.path == LISTED || key.path == UNLISTED;
    !is_class && value_of(key, defaults).is_some_and(Value::is_object)
}

fn shown(range: &RangeInclusive<f64>) -> String {
    let number = |value: &f64| match value.abs() {
        0.0 => "0".to_owned(),
        size if (1e-3..1e5).contains(&size) => value.to_string(),
        _ => format!("{value:e}"),
    };
    format!("{} to {}", number(range.start()), number(range.end()))
}

/// A bar would end the cell.
fn escaped(text: &str) -> String {
    text.replace('|', "\\|")
}

const LISTED: &str = "perception.classes.listed";
const UNLISTED: &str = "perception.classes.unlisted";

const INTRODUCTION: &str = "\
# Settings

All settings of `replay`, `node` and the library, as `ellipsoid_slam config --markdown` prints them. They are given in a parameter file of ROS 2
(`--config FILE`; [config/ellipsoid_slam.yaml](../config/ellipsoid_slam.yaml) is one with all defaults), one by one (`--set key=value`), or as parameters of the
live node, where those that count at once can be changed while it runs. A number out of its range, or a name that does not exist, is refused.
";
