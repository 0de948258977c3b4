//! `demo`: the main job on the demo bag.

use super::{
    Outcome,
    detector::DetectorArgs,
    parameter_args::{ParameterArgs, RemapArgs},
    replay,
};
use crate::io::read_map;
use clap::Parser;
use nalgebra::Vector3;
use std::{fs, path::PathBuf};

/// Replay the demo bag, then say what was found and where to look.
#[derive(Debug, Parser)]
pub(super) struct Args {
    /// The demo bag.
    #[arg(long, default_value = "bags/desk.mcap")]
    bag: PathBuf,
    /// Folder for the results; an earlier demo's are overwritten.
    #[arg(long, short, default_value = "target/demo")]
    output: PathBuf,
    /// Write no report and no pictures.
    #[arg(long)]
    no_report: bool,
}

pub(super) fn run(args: &Args) -> Outcome {
    let replay_args = replay::Args {
        bag: args.bag.clone(),
        parameters: ParameterArgs::default(),
        detector: DetectorArgs::default(),
        map: None,
        start: None,
        output: Some(args.output.clone()),
        remaps: RemapArgs::default(),
        force: true,
        json: false,
        no_report: args.no_report,
        no_images: false,
        ground_truth: None,
    };
    replay::run(&replay_args)?;
    let map = read_map(&fs::read_to_string(args.output.join("map.json"))?)?;
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
        args.output.display()
    );
    Ok(())
}
