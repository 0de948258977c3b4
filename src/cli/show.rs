//! `show`: pictures of a result.

use super::Outcome;
use crate::{
    geometry::Pose,
    io::{load_saved_map, read_trajectory, write_atomically},
    report::plan,
};
use anyhow::Context;
use clap::Parser;
use std::path::PathBuf;

/// Draw a result's map from above, to scale, with names and sizes: map.svg.
#[derive(Debug, Parser)]
pub(super) struct Args {
    /// The folder that replay wrote.
    result: PathBuf,
    /// Where the picture goes; by default into that folder.
    #[arg(long, short, value_name = "FILE.svg")]
    output: Option<PathBuf>,
}

pub(super) fn run(args: &Args) -> Outcome {
    let map_file = args.result.join("map.json");
    let map = load_saved_map(&map_file).with_context(|| map_file.display().to_string())?;
    let trajectory = read_trajectory(&args.result.join("trajectory.tum"))?;
    let poses: Vec<Pose> = trajectory.iter().map(|(_, pose)| *pose).collect();
    let path = args.output.clone().unwrap_or_else(|| args.result.join("map.svg"));
    write_atomically(&path, plan(&map, &poses, &[]).as_bytes())
        .with_context(|| format!("cannot write {}", path.display()))?;
    say!("{}", path.display());
    Ok(())
}
