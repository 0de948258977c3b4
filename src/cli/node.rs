//! `node`: the main job, live on ROS 2.

use super::{Failure, LogLines, Outcome, detector, map_folder::MapFolder};
use crate::{
    config::{LogLevel, MapFileSettings, Parameters, RosArguments},
    mapping::SavedMap,
    ros::{self, Domain, LogForm, MapFiles, check_remaps, run_node},
};
use anyhow::anyhow;
use clap::Parser;
use std::{env, fs, io, os::unix::process::CommandExt, path::Path, process::Command, sync::Arc};
use tracing::Level;
use tracing_subscriber::Layer;

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

    /// Log lines in ROS's form.
    pub(super) fn log_lines(&self) -> LogLines {
        // Arguments that cannot be read are named by `run`.
        let logger = self.parse_ros().map_or_else(|_| NODE.to_owned(), |known| known.logger());
        let lines = tracing_subscriber::fmt::layer().event_format(LogForm::of(logger));
        lines.with_writer(io::stderr).boxed()
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

/// Starts the program once more in its own place, with what makes glibc give the memory of images back.
///
/// Once a block of a megabyte has been freed, glibc keeps such blocks instead, between small ones that live longer: a node
/// grows for hours. It reads the limit only when a program starts. Where that cannot be done, the node only needs more.
fn keep_memory_small() {
    if !cfg!(target_env = "gnu") || env::var_os(MMAP_THRESHOLD).is_some() {
        return;
    }
    if let Ok(program) = env::current_exe() {
        let mut again = Command::new(program);
        again.args(env::args_os().skip(1));
        again.env(MMAP_THRESHOLD, BYTES).env("MALLOC_TRIM_THRESHOLD_", BYTES);
        // Returns only where it fails.
        let why = again.exec();
        tracing::debug!("memory of images stays with the program: {why}");
    }
}

/// glibc's name for the size from which blocks are given back at once.
const MMAP_THRESHOLD: &str = "MALLOC_MMAP_THRESHOLD_";
/// As glibc begins (bytes).
const BYTES: &str = "131072";

pub(super) fn run(args: &Args, lines: ros::LogLines) -> Outcome {
    keep_memory_small();
    let arguments = args.parse_ros()?;
    let mut parameters = Parameters::default();
    let without = arguments
        .apply(&mut parameters, |path| fs::read_to_string(path))
        .map_err(|e| Failure::Usage(e.to_string()))?;
    for path in without {
        tracing::warn!("{path} has no parameters for {}", arguments.full_name());
    }
    check_remaps(&arguments, &parameters.node.topics).map_err(|e| Failure::Usage(e.to_string()))?;
    let folder = Arc::new(MapFolder::new(&parameters.node.map));
    let at_start = map_at_start(&parameters.node.map, &folder)?;
    let saving = Arc::clone(&folder);
    let files = MapFiles {
        load: Arc::new(move |name| folder.load(name)),
        save: Arc::new(move |name, maps| saving.save(name, maps)),
    };
    let detector = detector::load(&parameters.node.detector)?;
    if let Some(loaded) = &detector {
        tracing::info!("boxes are found by {}", loaded.described);
    }
    let find = detector.map(|loaded| loaded.find);
    run_node(Domain::from_environment()?, &arguments, parameters, (at_start, files), find, lines)?;
    Ok(())
}

/// A first run has no map yet. A file that is there and no map is not passed over: it would not be overwritten at the end.
fn map_at_start(
    settings: &MapFileSettings,
    folder: &MapFolder,
) -> Result<Option<SavedMap>, Failure> {
    if !settings.load_on_start {
        return Ok(None);
    }
    if settings.file.is_empty() {
        return Err(Failure::Usage("map.load_on_start needs map.file".into()));
    }
    if !Path::new(&settings.file).exists() {
        tracing::warn!("there is no map in {} yet: an empty one is begun", settings.file);
        return Ok(None);
    }
    folder.load("").map(Some).map_err(|why| Failure::Failed(anyhow!(why)))
}

/// The node's name where no argument gives another.
const NODE: &str = "ellipsoid_slam";
