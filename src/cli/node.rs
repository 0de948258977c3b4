//! `node`: the main job, live on ROS 2.

use super::{Failure, Outcome};
use crate::{
    config::{LogLevel, Parameters, RosArguments},
    io::{map_json, write_atomically},
    pipeline::ObjectSlam,
    ros::{DdsDomain, run_node},
};
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
        let given = arguments.and_then(|arguments| {
            let logger = arguments.full_name().trim_start_matches('/').replace('/', ".");
            arguments.log_level(&logger)
        });
        match given {
            Some(LogLevel::Debug) => Level::DEBUG,
            None | Some(LogLevel::Info) => Level::INFO,
            Some(LogLevel::Warn) => Level::WARN,
            Some(LogLevel::Error | LogLevel::Fatal) => Level::ERROR,
        }
    }
}

pub(super) fn run(args: &Args) -> Outcome {
    let arguments = args.parse_ros()?;
    let mut parameters = Parameters::default();
    let without = arguments
        .apply(&mut parameters, |path| fs::read_to_string(path))
        .map_err(|e| Failure::Usage(e.to_string()))?;
    for path in without {
        tracing::warn!("{path} has no parameters for {}", arguments.full_name());
    }
    let frame = parameters.node.map_frame.clone();
    let save = move |slam: &ObjectSlam, path: &Path| {
        let text = map_json(slam.objects(), &frame).map_err(|e| e.to_string())?;
        write_atomically(path, text.as_bytes())
            .map_err(|e| format!("cannot write {}: {e}", path.display()))
    };
    run_node(DdsDomain::from_environment()?, &arguments, parameters, Box::new(save))?;
    Ok(())
}

/// The node's name where no argument gives another.
const NODE: &str = "ellipsoid_slam";
