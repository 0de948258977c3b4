//! What ROS 2 says on a command line: `--ros-args`.
//!
//! The form is that of `rcl`: <https://design.ros2.org/articles/ros_command_line_arguments.html>.

use super::{ConfigError, Parameters, sections_of, text::yaml};
use serde_json::{Map, Value};
use thiserror::Error;

/// Why arguments are not ROS 2's.
#[derive(Debug, Error)]
pub enum ArgumentError {
    /// An argument of ROS 2 that is not known.
    #[error("`{0}` is no argument of ROS 2")]
    Unknown(String),
    /// Nothing after an argument that needs something.
    #[error("`{0}` needs a value")]
    NoValue(String),
    /// Not of the form it should have.
    #[error("`{given}` after `{flag}` is not of the form {form}")]
    Form {
        /// The argument.
        flag: String,
        /// What was given.
        given: String,
        /// What was expected.
        form: &'static str,
    },
    /// A name that cannot be.
    #[error("`{0}` is not a name in ROS 2: letters, digits, `_` and `/`, no digit first in a part")]
    BadName(String),
    /// A file that cannot be read.
    #[error("cannot read the parameter file {path}: {problem}")]
    NotReadable {
        /// The file.
        path: String,
        /// Why.
        problem: String,
    },
    /// Parameters that cannot be.
    #[error("{origin}: {source}")]
    Parameters {
        /// The file, or the argument.
        origin: String,
        /// Why.
        source: ConfigError,
    },
}

/// How much is said, in ROS 2's words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogLevel {
    /// Everything.
    Debug,
    /// What happens.
    Info,
    /// What should be looked at.
    Warn,
    /// What does not work.
    Error,
    /// What ends the program.
    Fatal,
}

/// The arguments between `--ros-args` and `--`, for one node.
#[derive(Clone, Debug)]
pub struct RosArguments {
    node: String,
    namespace: String,
    remaps: Vec<Remap>,
    given: Vec<Given>,
    log_level: Option<LogLevel>,
    log_levels: Vec<(String, LogLevel)>,
}

#[derive(Clone, Debug)]
struct Remap {
    from: String,
    to: String,
}

#[derive(Clone, Debug)]
enum Given {
    File(String),
    Value { name: String, value: Value },
}

impl RosArguments {
    /// Splits a command line into ROS 2's arguments and the others. `node` is the node's name where they give none.
    ///
    /// # Errors
    /// When an argument of ROS 2 is unknown or has not the form it should have.
    pub fn parse(arguments: &[String], node: &str) -> Result<(Self, Vec<String>), ArgumentError> {
        let mut parsed = Self {
            node: node.to_owned(),
            namespace: "/".to_owned(),
            remaps: Vec::new(),
            given: Vec::new(),
            log_level: None,
            log_levels: Vec::new(),
        };
        let (mut others, mut is_ros) = (Vec::new(), false);
        let mut arguments = arguments.iter();
        while let Some(argument) = arguments.next() {
            match argument.as_str() {
                "--ros-args" => is_ros = true,
                "--" if is_ros => is_ros = false,
                flag if is_ros => parsed.take(flag, &mut arguments, node)?,
                _ => others.push(argument.clone()),
            }
        }
        Ok((parsed, others))
    }

    fn take<'a>(
        &mut self,
        flag: &str,
        rest: &mut impl Iterator<Item = &'a String>,
        default_node: &str,
    ) -> Result<(), ArgumentError> {
        if SWITCHES.contains(&flag) {
            return Ok(());
        }
        if !VALUES.iter().flat_map(|names| *names).any(|name| *name == flag) {
            return Err(ArgumentError::Unknown(flag.to_owned()));
        }
        let value = rest.next().ok_or_else(|| ArgumentError::NoValue(flag.to_owned()))?;
        let form = |form| ArgumentError::Form { flag: flag.into(), given: value.clone(), form };
        match flag {
            "-r" | "--remap" => {
                let (from, to) = value.split_once(":=").ok_or_else(|| form(REMAP))?;
                if from.is_empty() || to.is_empty() {
                    return Err(form(REMAP));
                }
                if let Some(from) = for_node(from, default_node) {
                    self.remap(from, to)?;
                }
            }
            "-p" | "--param" => {
                let (name, value) = value.split_once(":=").ok_or_else(|| form(PARAMETER))?;
                if name.is_empty() || value.is_empty() {
                    return Err(form(PARAMETER));
                }
                if let Some(name) = for_node(name, default_node) {
                    let origin = format!("-p {name}:={value}");
                    let value = yaml(value)
                        .map_err(|source| ArgumentError::Parameters { origin, source })?;
                    self.given.push(Given::Value { name: name.to_owned(), value });
                }
            }
            "--params-file" => self.given.push(Given::File(value.clone())),
            "--log-level" => match value.split_once(":=") {
                Some((logger, level)) => {
                    let level = log_level(level).ok_or_else(|| form(LOG_LEVEL))?;
                    self.log_levels.push((logger.to_owned(), level));
                }
                None => self.log_level = Some(log_level(value).ok_or_else(|| form(LOG_LEVEL))?),
            },
            // Enclaves and log files are not used here; launch files may give them all the same.
            _ => {}
        }
        Ok(())
    }

    fn remap(&mut self, from: &str, to: &str) -> Result<(), ArgumentError> {
        match from {
            "__node" | "__name" => {
                let is_name = is_valid(to) && !to.contains('/');
                self.node = to.to_owned();
                is_name.then_some(()).ok_or_else(|| ArgumentError::BadName(to.to_owned()))
            }
            "__ns" => {
                self.namespace = format!("/{}", to.trim_matches('/'));
                let is_name = to == "/" || is_valid(to.trim_start_matches('/'));
                is_name.then_some(()).ok_or_else(|| ArgumentError::BadName(to.to_owned()))
            }
            _ => {
                // Which kind of name a rule is for does not matter: no topic here is named like a service.
                let plain = |name: &str| {
                    name.trim_start_matches("rostopic://")
                        .trim_start_matches("rosservice://")
                        .to_owned()
                };
                let (from, to) = (plain(from), plain(to));
                for name in [&from, &to] {
                    let name = name.strip_prefix("~/").unwrap_or(name);
                    if !is_valid(name.strip_prefix('/').unwrap_or(name)) {
                        return Err(ArgumentError::BadName(name.to_owned()));
                    }
                }
                self.remaps.push(Remap { from, to });
                Ok(())
            }
        }
    }

    /// The node's name.
    pub fn node(&self) -> &str {
        &self.node
    }

    /// The node's namespace; `/` if it has none.
    pub fn namespace(&self) -> &str {
        &self.namespace
    }

    /// The node's full name.
    pub fn full_name(&self) -> String {
        format!("{}/{}", self.namespace.trim_end_matches('/'), self.node)
    }

    /// The name of the node's logger: its full name with dots.
    pub fn logger(&self) -> String {
        self.full_name().trim_start_matches('/').replace('/', ".")
    }

    /// The full name of a topic or service after remapping. A name is relative to the namespace, private after `~/`, or
    /// full after `/`. The first rule that fits counts, as in `rcl`.
    pub fn resolve(&self, name: &str) -> String {
        self.remapped(name).unwrap_or_else(|| self.expanded(name))
    }

    /// The same, if a rule fits.
    pub fn remapped(&self, name: &str) -> Option<String> {
        let full = self.expanded(name);
        let rule = self.remaps.iter().find(|rule| self.expanded(&rule.from) == full)?;
        Some(self.expanded(&rule.to))
    }

    /// The first name that is to be remapped and is none of these.
    pub fn unmatched<'a>(&self, names: impl IntoIterator<Item = &'a str>) -> Option<&str> {
        let known: Vec<String> = names.into_iter().map(|name| self.expanded(name)).collect();
        let is_unknown = |rule: &&Remap| !known.contains(&self.expanded(&rule.from));
        self.remaps.iter().find(is_unknown).map(|rule| rule.from.as_str())
    }

    fn expanded(&self, name: &str) -> String {
        if name.starts_with('/') {
            name.to_owned()
        } else if let Some(private) = name.strip_prefix("~/") {
            format!("{}/{private}", self.full_name())
        } else {
            format!("{}/{name}", self.namespace.trim_end_matches('/'))
        }
    }

    /// How much a logger says, if the arguments say so.
    pub fn log_level(&self, logger: &str) -> Option<LogLevel> {
        let own = self.log_levels.iter().rev().find(|(name, _)| name == logger);
        own.map(|(_, level)| *level).or(self.log_level)
    }

    /// Lays what files and `-p` say over `parameters`, in the order in which they were given. Returns the files that
    /// have nothing for this node, which is often a mistake.
    ///
    /// # Errors
    /// When a file cannot be read, or a parameter is unknown or cannot have its value.
    pub fn apply<E: ToString>(
        &self,
        parameters: &mut Parameters,
        mut read: impl FnMut(&str) -> Result<String, E>,
    ) -> Result<Vec<String>, ArgumentError> {
        let mut without = Vec::new();
        for given in &self.given {
            let wrong = |origin: &str| {
                let origin = origin.to_owned();
                |source| ArgumentError::Parameters { origin, source }
            };
            match given {
                Given::Value { name, value } => {
                    let section = Value::Object(Map::from_iter([(name.clone(), value.clone())]));
                    parameters.overlay(&section).map_err(wrong(&format!("-p {name}")))?;
                }
                Given::File(path) => {
                    let text = read(path).map_err(|e| ArgumentError::NotReadable {
                        path: path.clone(),
                        problem: e.to_string(),
                    })?;
                    let sections = sections_of(&text, &self.full_name()).map_err(wrong(path))?;
                    for section in &sections {
                        parameters.overlay(section).map_err(wrong(path))?;
                    }
                    without.extend(sections.is_empty().then(|| path.clone()));
                }
            }
        }
        Ok(without)
    }
}

/// What follows `NODE:` if that is this node, or all of it if it is for any node.
fn for_node<'a>(name: &'a str, node: &str) -> Option<&'a str> {
    match name.split_once(':') {
        Some((_, rest)) if rest.starts_with("//") => Some(name),
        Some((other, rest)) => (other == node).then_some(rest),
        None => Some(name),
    }
}

fn is_valid(name: &str) -> bool {
    name.split('/').all(|part| {
        let starts = part.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        starts && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    })
}

fn log_level(word: &str) -> Option<LogLevel> {
    Some(match word.to_ascii_lowercase().as_str() {
        "debug" => LogLevel::Debug,
        "info" => LogLevel::Info,
        "warn" => LogLevel::Warn,
        "error" => LogLevel::Error,
        "fatal" => LogLevel::Fatal,
        _ => return None,
    })
}

const REMAP: &str = "from:=to or node:from:=to";
const PARAMETER: &str = "name:=value or node:name:=value";
const LOG_LEVEL: &str = "level or logger:=level, with a level of debug, info, warn, error or fatal";

/// Arguments that are followed by a value.
const VALUES: &[&[&str]] = &[
    &["-r", "--remap"],
    &["-p", "--param"],
    &["--params-file"],
    &["--log-level"],
    &["-e", "--enclave"],
    &["--log-config-file"],
    &["--log-file-name"],
];
/// What these say of logging is left to who starts the program; launch files may give them all the same.
const SWITCHES: &[&str] = &[
    "--enable-rosout-logs",
    "--disable-rosout-logs",
    "--enable-stdout-logs",
    "--disable-stdout-logs",
    "--enable-external-lib-logs",
    "--disable-external-lib-logs",
];
