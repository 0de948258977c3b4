//! `inspect`: what a bag has and what is missing.

use super::{Outcome, parameter_args::ParameterArgs};
use crate::io::{Remap, inspect};
use clap::Parser;
use std::path::PathBuf;

/// Say which topics of a bag would be used for what, how well they fit and what is missing.
#[derive(Debug, Parser)]
pub(super) struct Args {
    /// An `.mcap` or `.db3` file or a rosbag2 folder.
    bag: PathBuf,
    #[command(flatten)]
    parameters: ParameterArgs,
    /// Use a topic for a role, as for replay.
    #[arg(short = 'r', long = "remap", value_name = "ROLE:=/TOPIC")]
    remaps: Vec<Remap>,
    /// Print JSON instead.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Outcome {
    let parameters = args.parameters.load()?;
    let report = inspect(&args.bag, &args.remaps, parameters.slam.sync.slop_s)?;
    if args.json {
        say!("{}", serde_json::to_string_pretty(&report)?);
    } else {
        say!("{report}");
    }
    Ok(())
}
