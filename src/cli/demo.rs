//! `demo`: the main job on the demo bag.

use super::{Outcome, replay};
use clap::Parser;
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
}

pub(super) fn run(args: &Args) -> Outcome {
    let replay_args = replay::Args {
        bag: args.bag.clone(),
        config: None,
        output: Some(args.output.clone()),
        remaps: Vec::new(),
        force: true,
        json: false,
    };
    replay::run(&replay_args)?;
    let map: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(args.output.join("map.json"))?)?;
    println!("\n{:>3}  {:<16} {:>24}  {:>20}", "id", "label", "position [m]", "full size [m]");
    for object in map["objects"].as_array().into_iter().flatten() {
        let numbers = |key: &str, factor: f64| -> String {
            let parts = object[key].as_array().into_iter().flatten();
            parts.map(|v| format!("{:6.2}", factor * v.as_f64().unwrap_or(f64::NAN))).collect()
        };
        println!(
            "{:>3}  {:<16} {:>24}  {:>20}",
            object["id"],
            object["label"].as_str().unwrap_or_default(),
            numbers("position", 1.0),
            numbers("semi_axes", 2.0),
        );
    }
    println!(
        "\nlook at {0}/result.mcap in Foxglove, or in RViz with `ros2 bag play {0}/result.mcap`;\n\
         {0}/map.json has the objects, {0}/trajectory.tum the poses",
        args.output.display()
    );
    Ok(())
}
