//! `demo`: the main job on the demo bag.

use super::{
    Outcome,
    detector::DetectorArgs,
    parameter_args::{ParameterArgs, RemapArgs},
    replay,
};
use crate::io::{read_map, write_atomically};
use anyhow::Context;
use clap::Parser;
use nalgebra::Vector3;
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Replay the demo bag, then say what was found and where to look.
#[derive(Debug, Parser)]
pub(super) struct Args {
    /// Another bag; the demo bag is bags/desk.mcap, or where that is not there the same in the program.
    #[arg(long)]
    bag: Option<PathBuf>,
    /// Folder for the results; an earlier demo's are overwritten. By default target/demo, or where there is no target, demo.
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// Write no report and no pictures.
    #[arg(long)]
    no_report: bool,
}

/// The demo bag, for those who have the program only.
const BAG: &[u8] = include_bytes!("../../bags/desk.mcap");

/// Where the demo bag is: in the folder of the results, where it is nowhere else.
fn demo_bag(output: &Path) -> anyhow::Result<PathBuf> {
    let kept = PathBuf::from("bags/desk.mcap");
    if kept.exists() {
        return Ok(kept);
    }
    let written = output.join("desk.mcap");
    fs::create_dir_all(output)
        .and_then(|()| write_atomically(&written, BAG))
        .with_context(|| format!("cannot write {}", written.display()))?;
    Ok(written)
}

pub(super) fn run(args: &Args) -> Outcome {
    let default = if Path::new("target").is_dir() { "target/demo" } else { "demo" };
    let output = args.output.clone().unwrap_or_else(|| default.into());
    let bag = args.bag.clone().map_or_else(|| demo_bag(&output), Ok)?;
    let replay_args = replay::Args {
        bag,
        parameters: ParameterArgs::default(),
        detector: DetectorArgs::default(),
        map: None,
        start: None,
        output: Some(output.clone()),
        remaps: RemapArgs::default(),
        force: true,
        json: false,
        no_report: args.no_report,
        no_images: false,
        ground_truth: None,
    };
    replay::run(&replay_args)?;
    let map = read_map(&fs::read_to_string(output.join("map.json"))?)?;
    say!("\n{:>3}  {:<16} {:>24}  {:>20}", "id", "label", "position [m]", "full size [m]");
    for object in &map.objects {
        let numbers = |v: &Vector3<f64>| v.iter().map(|x| format!("{x:6.2}")).collect::<String>();
        say!(
            "{:>3}  {:<16} {:>24}  {:>20}",
            object.id,
            object.label,
            numbers(&object.ellipsoid.center().coords),
            numbers(&(object.ellipsoid.semi_axes * 2.0)),
        );
    }
    say!(
        "\nopen {0}/report.html in a browser; {0}/map.svg is the map from above;\n\
         look at {0}/result.mcap in Foxglove, or in RViz with `ros2 bag play {0}/result.mcap`;\n\
         {0}/map.json has the objects, {0}/trajectory.tum the poses",
        output.display()
    );
    Ok(())
}
