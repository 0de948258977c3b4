//! `inspect`: what a bag has and what is missing.

use super::{
    Outcome,
    detector::DetectorArgs,
    parameter_args::{ParameterArgs, RemapArgs},
};
use crate::io::inspect;
use anyhow::anyhow;
use clap::Parser;
use std::path::PathBuf;

/// Say which topics of a bag would be used for what, how well they fit and what is missing. The status is 1 where a replay
/// would fail.
#[derive(Debug, Parser)]
pub(super) struct Args {
    /// An `.mcap` or `.db3` file or a rosbag2 folder.
    bag: PathBuf,
    #[command(flatten)]
    detector: DetectorArgs,
    #[command(flatten)]
    parameters: ParameterArgs,
    #[command(flatten)]
    remaps: RemapArgs,
    /// Print JSON instead.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Outcome {
    let parameters = args.parameters.load()?;
    let finds_boxes = !args.detector.over(&parameters.node.detector).model.is_empty();
    let remaps = args.remaps.over(&parameters);
    let report = inspect(&args.bag, &remaps, &parameters.slam.sync, finds_boxes)?;
    if args.json {
        say!("{}", serde_json::to_string_pretty(&report)?);
    } else {
        say!("{report}");
    }
    if report.can_be_replayed {
        return Ok(());
    }
    Err(anyhow!("{} cannot be replayed: {}", args.bag.display(), report.problems.join("; ")).into())
}
