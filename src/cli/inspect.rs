//! `inspect`: what a bag has and what is missing.

use super::Outcome;
use crate::{
    io::{self, Remap},
    pipeline::Settings,
};
use clap::Parser;
use std::path::PathBuf;

/// Say which topics of a bag would be used for what, how well they fit and what is missing.
#[derive(Debug, Parser)]
pub(super) struct Args {
    /// An `.mcap` file or a rosbag2 folder.
    bag: PathBuf,
    /// Use a topic for a role, as for replay.
    #[arg(short = 'r', long = "remap", value_name = "ROLE:=/TOPIC")]
    remaps: Vec<Remap>,
    /// Print JSON instead.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Outcome {
    let report = io::inspect(&args.bag, &args.remaps, Settings::default().sync.slop_s)?;
    if args.json {
        println!("{}", serde_json::to_string_pretty(&report)?);
    } else {
        println!("{report}");
    }
    Ok(())
}
