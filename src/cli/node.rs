//! `node`: the main job, live on ROS 2.

use super::{Failure, Outcome, detector};
use crate::{
    config::{LogLevel, MapFileSettings, Parameters, RosArguments},
    io::{load_saved_map, save_map},
    mapping::SavedMap,
    ros::{Domain, LogLines, MapFiles, check_remaps, run_node},
};
use anyhow::anyhow;
use clap::Parser;
use std::{fs, path::Path};
use tracing::Level;

/// Run live on ROS 2 until it is interrupted.
#[derive(Debug, Parser)]
pub(super) struct Args {
    /// After --ros-args: --params-file FILE, -p name:=value, -r from:=to, -r __ns:=/x, -r __node:=x, --log-level L.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "--ros-args ...")]
    ros_args: Vec<String>,
}

impl Args {
    /// What the arguments say to ROS 2.
    pub(super) fn parse_ros(&self) -> Result<RosArguments, Failure> {
        let (arguments, others) =
            RosArguments::parse(&self.ros_args, NODE).map_err(|e| Failure::Usage(e.to_string()))?;
        match others.first() {
            None => Ok(arguments),
            Some(other) => Err(Failure::Usage(format!(
                "`{other}` is no argument of node; those of ROS 2 come after --ros-args"
            ))),
        }
    }

    /// What `--log-level` says; ROS 2's default otherwise.
    pub(super) fn level(&self) -> Level {
        // Arguments that cannot be read are named by `run`.
        let arguments = self.parse_ros().ok();
        let given = arguments.and_then(|arguments| arguments.log_level(&arguments.logger()));
        match given {
            Some(LogLevel::Debug) => Level::DEBUG,
            None | Some(LogLevel::Info) => Level::INFO,
            Some(LogLevel::Warn) => Level::WARN,
            Some(LogLevel::Error | LogLevel::Fatal) => Level::ERROR,
        }
    }
}

pub(super) fn run(args: &Args, lines: LogLines) -> Outcome {
    let arguments = args.parse_ros()?;
    let mut parameters = Parameters::default();
    let without = arguments
        .apply(&mut parameters, |path| fs::read_to_string(path))
        .map_err(|e| Failure::Usage(e.to_string()))?;
    for path in without {
        tracing::warn!("{path} has no parameters for {}", arguments.full_name());
    }
    check_remaps(&arguments, &parameters.node.topics).map_err(|e| Failure::Usage(e.to_string()))?;
    let files = MapFiles {
        at_start: map_at_start(&parameters.node.map)?,
        load: Box::new(load),
        save: Box::new(|path, map| {
            save_map(path, map).map_err(|e| format!("{}: {e}", path.display()))
        }),
    };
    let detector = detector::load(&parameters.node.detector)?;
    if let Some(loaded) = &detector {
        tracing::info!("boxes are found by {}", loaded.described);
    }
    let find = detector.map(|loaded| loaded.find);
    run_node(Domain::from_environment()?, &arguments, parameters, files, find, lines)?;
    Ok(())
}

/// A first run has no map yet. A file that is there and no map is not passed over: it would be overwritten at the end.
fn map_at_start(settings: &MapFileSettings) -> Result<Option<SavedMap>, Failure> {
    let path = Path::new(&settings.file);
    if !settings.load_on_start {
        return Ok(None);
    }
    if settings.file.is_empty() {
        return Err(Failure::Usage("map.load_on_start needs map.file".into()));
    }
    if !path.exists() {
        tracing::warn!("there is no map in {} yet: an empty one is begun", path.display());
        return Ok(None);
    }
    load(path).map(Some).map_err(|why| Failure::Failed(anyhow!(why)))
}

fn load(path: &Path) -> Result<SavedMap, String> {
    load_saved_map(path).map_err(|e| format!("{}: {e}", path.display()))
}

/// The node's name where no argument gives another.
const NODE: &str = "ellipsoid_slam";
