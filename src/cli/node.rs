//! `node`: the main job, live on ROS 2.

use super::Outcome;
use crate::{
    config::NodeSettings,
    pipeline::Settings,
    ros::{DdsDomain, Identity, run_node},
};
use clap::Parser;

/// Run live on ROS 2 until it is interrupted.
#[derive(Debug, Parser)]
pub(super) struct Args {
    /// ROS 2's arguments: --params-file, -p name:=value, -r from:=to, __ns, __node, --log-level.
    #[arg(long = "ros-args", num_args = 0.., allow_hyphen_values = true, value_name = "ARGS")]
    ros_args: Vec<String>,
}

pub(super) fn run(args: &Args) -> Outcome {
    let remaps = args.ros_args.iter().filter_map(|a| a.split_once(":="));
    let remaps = remaps.map(|(from, to)| (from.to_owned(), to.to_owned())).collect();
    let identity = Identity { remaps, ..Identity::default() };
    let domain = DdsDomain::from_environment()?;
    run_node(domain, &identity, &Settings::default(), &NodeSettings::default())?;
    Ok(())
}
