//! A map from a bag, as `ellipsoid_slam replay` makes it.
//!
//! `cargo run --example from_a_bag -- bags/desk.mcap`

use ellipsoid_slam::{
    io::{BagInput, map_json},
    mapping::SavedMap,
    pipeline::{ObjectSlam, Settings},
};
use std::{env, error::Error, path::PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let bag = env::args_os().nth(1).map_or("bags/desk.mcap".into(), PathBuf::from);
    // Topics are found by type, format and name; the second argument names those that are not.
    let bag = BagInput::open(&bag, &[])?;
    let mut slam = ObjectSlam::new(Settings::default());
    let mut inputs = bag.inputs();
    for input in &mut inputs {
        let update = slam.handle(input, &mut ());
        for change in &update.changes {
            println!("{change:?}");
        }
    }
    slam.finish(&mut ());
    for (topic, _, count, first) in inputs.skipped().iter() {
        println!("{count} messages on {topic} were not used, such as: {first}");
    }

    // What `map.json` holds, for a later visit: `ObjectSlam::continuing`.
    let saved = SavedMap::of(slam.objects(), "map");
    println!("{} objects in {} bytes", saved.objects.len(), map_json(&saved)?.len());
    Ok(())
}
