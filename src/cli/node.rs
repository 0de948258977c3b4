//! `node`: the main job, live on ROS 2.

use super::{Failure, Outcome};
use crate::{
    config::{Parameters, RosArguments},
    io::save_map,
    mapping::SavedMap,
    pipeline::ObjectSlam,
    ros::{DdsDomain, run_node},
};
use clap::Parser;
use std::{fs, path::Path};

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
        save_map(path, &SavedMap::of(slam.objects(), &frame))
            .map_err(|e| format!("cannot write {}: {e}", path.display()))
    };
    run_node(DdsDomain::from_environment()?, &arguments, parameters, Box::new(save))?;
    Ok(())
}

/// The node's name where no argument gives another.
const NODE: &str = "ellipsoid_slam";
