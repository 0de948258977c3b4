//! All parameters together, by name as ROS 2 knows them: sections and key joined by dots.

use super::{ConfigError, Key, NodeSettings, keys, text::yaml, together::check_together, values};
use crate::pipeline::Settings;
use serde::Serialize;
use serde_json::{Map, Value};

/// Everything that a parameter file can say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parameters {
    /// Of the live node, and what is published.
    pub node: NodeSettings,
    /// Of the method.
    pub slam: Settings,
}

/// A parameter with its value.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Sections and key, joined by dots.
    pub name: String,
    /// A bool, a number, a text or an array of numbers.
    pub value: Value,
    /// Its range and meaning; a class's parts have those of all classes.
    pub key: &'static Key,
}

impl Parameters {
    /// All parameters in the order of the file.
    ///
    /// # Errors
    /// Never for parameters that were read or are defaults; a value that is no text would be a bug.
    pub fn list(&self) -> Result<Vec<Parameter>, ConfigError> {
        let mut all = Vec::new();
        leaves(&self.tree()?, "", &mut all);
        let place = |p: &Parameter| keys().position(|key| std::ptr::eq(key, p.key));
        all.sort_by_cached_key(place);
        Ok(all)
    }

    /// The parameter's value, if there is one of this name.
    ///
    /// # Errors
    /// As for [`Parameters::list`].
    pub fn get(&self, name: &str) -> Result<Option<Value>, ConfigError> {
        let tree = self.tree()?;
        let found = name.split('.').try_fold(&tree, |section, part| section.get(part));
        Ok(found.filter(|value| !value.is_object()).cloned())
    }

    /// Sets one parameter: the same as a file with this key.
    ///
    /// # Errors
    /// When there is no such parameter, or the value is of the wrong kind or out of range; then nothing has changed.
    pub fn set(&mut self, name: &str, value: Value) -> Result<(), ConfigError> {
        self.overlay(&Value::Object(Map::from_iter([(name.to_owned(), value)])))
    }

    /// Sets one parameter to a value that is written as in a file.
    ///
    /// # Errors
    /// As for [`Parameters::set`], and when the text is not YAML.
    pub fn set_text(&mut self, name: &str, value: &str) -> Result<(), ConfigError> {
        self.set(name, yaml(value)?)
    }

    /// Sets what `given` names: the content of `ros__parameters`.
    ///
    /// # Errors
    /// As for [`Parameters::set`].
    pub fn overlay(&mut self, given: &Value) -> Result<(), ConfigError> {
        let mut tree = self.tree()?;
        values::overlay(&mut tree, given)?;
        values::check_ranges(&tree)?;
        *self = Self::from_tree(tree)?;
        Ok(())
    }

    /// Whether two sets differ in what counts only at the start, and the first such name.
    ///
    /// # Errors
    /// As for [`Parameters::list`].
    pub fn first_fixed_difference(&self, other: &Self) -> Result<Option<String>, ConfigError> {
        let theirs = other.tree()?;
        let differs = |p: &Parameter| {
            let found = p.name.split('.').try_fold(&theirs, |section, part| section.get(part));
            !p.key.live && found != Some(&p.value)
        };
        Ok(self.list()?.into_iter().find(differs).map(|p| p.name))
    }

    /// All of them as one tree of sections.
    ///
    /// # Errors
    /// As for [`Parameters::list`].
    pub fn tree(&self) -> Result<Value, ConfigError> {
        let mut tree = to_map(&self.node)?;
        tree.extend(to_map(&self.slam)?);
        Ok(Value::Object(tree))
    }

    fn from_tree(tree: Value) -> Result<Self, ConfigError> {
        let Value::Object(mut slam) = tree else { return Err(ConfigError::NotRos) };
        let mut node = to_map(&NodeSettings::default())?;
        for (name, value) in &mut node {
            *value = slam.remove(name).unwrap_or_default();
        }
        let wrong = |e: serde_json::Error| ConfigError::WrongKind(e.to_string());
        let slam: Settings = serde_json::from_value(Value::Object(slam)).map_err(wrong)?;
        check_together(&slam)?;
        Ok(Self { node: serde_json::from_value(Value::Object(node)).map_err(wrong)?, slam })
    }
}

/// Range and meaning of a parameter; a class's parts have those of all classes.
pub fn key_of(name: &str) -> Option<&'static Key> {
    let exact = keys().find(|key| key.path == name);
    exact.or_else(|| keys().find(|key| values::is_class(name) && key.path == CLASSES))
}

const CLASSES: &str = "perception.classes";

fn leaves(tree: &Value, path: &str, out: &mut Vec<Parameter>) {
    let Some(section) = tree.as_object() else {
        let key = key_of(path);
        out.extend(key.map(|key| Parameter { name: path.into(), value: tree.clone(), key }));
        return;
    };
    for (name, value) in section {
        leaves(value, &values::joined(path, name), out);
    }
}

fn to_map(settings: &impl Serialize) -> Result<Map<String, Value>, ConfigError> {
    match serde_json::to_value(settings) {
        Ok(Value::Object(map)) => Ok(map),
        Ok(_) => Err(ConfigError::NotRos),
        Err(e) => Err(ConfigError::WrongKind(e.to_string())),
    }
}
