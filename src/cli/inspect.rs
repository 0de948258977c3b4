//! `inspect`: what a bag has and what is missing.

use super::Outcome;
use crate::io::{BagInput, Remap};
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
    let input = BagInput::open(&args.bag, &args.remaps)?;
    println!("{:?} {}", input.roles(), args.json);
    Ok(())
}
