//! The demo bag is what the command in `bags/README.md` makes.

use crate::run::{run, stderr};
use ellipsoid_slam::{
    eval::{GroundTruth, evaluate_trajectory},
    io::{BagReader, decode_color, read_trajectory},
    sim::{SceneKind, Simulation, SimulationSettings, TrajectoryKind},
};
use std::{collections::BTreeMap, fs, path::Path, process::Command};

fn documented_command() -> Vec<String> {
    let text = fs::read_to_string(kept("README.md")).unwrap();
    let line = text.lines().find_map(|line| line.strip_prefix("cargo run --release -- simulate "));
    line.unwrap().split_whitespace().map(str::to_owned).collect()
}

fn kept(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("bags").join(name)
}

#[test]
fn the_documented_command_makes_the_demo_bag_again() {
    let folder = tempfile::tempdir().unwrap();
    let made = |name: &str| folder.path().join(name);
    let mut command = documented_command();
    let bag = command.iter_mut().find(|word| *word == "bags/desk.mcap").unwrap();
    *bag = made("desk.mcap").to_str().unwrap().to_owned();
    let mut arguments = vec!["simulate"];
    arguments.extend(command.iter().map(String::as_str));
    let output = run(&arguments);
    assert!(output.status.success(), "{}", stderr(&output));

    let messages = |bag: &Path| -> BTreeMap<String, u64> {
        let bag = BagReader::open(bag).unwrap();
        bag.topics().iter().map(|topic| (topic.name.clone(), topic.messages)).collect()
    };
    assert_eq!(messages(&made("desk.mcap")), messages(&kept("desk.mcap")));
    // Another machine's sines may differ in the last bit, so pixels and file sizes may, too, by a little.
    let size = |bag: &Path| fs::metadata(bag).unwrap().len() as f64;
    let ratio = size(&made("desk.mcap")) / size(&kept("desk.mcap"));
    assert!((ratio - 1.0).abs() < 0.01, "{ratio} of its size");
    let same = fs::read(made("desk.mcap")).unwrap() == fs::read(kept("desk.mcap")).unwrap();
    println!("the bag is {}", if same { "the same to the byte" } else { "another one" });

    let truth = |path: &Path| GroundTruth::from_json(&fs::read_to_string(path).unwrap()).unwrap();
    let (new, old) = (truth(&made("desk.gt.json")), truth(&kept("desk.gt.json")));
    assert_eq!(new.objects.len(), old.objects.len());
    for (new, old) in new.objects.iter().zip(&old.objects) {
        assert_eq!((new.id, &new.label), (old.id, &old.label));
        let moved = new.pose.inverse() * old.pose;
        assert!(moved.translation.vector.norm() < 1e-6 && moved.rotation.angle() < 1e-6, "{new:?}");
        assert!((new.size - old.size).norm() < 1e-6, "{new:?}");
    }
    let poses = |path: &Path| read_trajectory(path).unwrap();
    let scores = evaluate_trajectory(&poses(&made("desk.gt.tum")), &poses(&kept("desk.gt.tum")));
    let scores = scores.unwrap();
    assert!(scores.poses == 30 && scores.ate_m.max < 1e-6, "{scores:?}");
}

#[test]
fn the_demo_bags_colours_are_those_that_were_rendered() {
    // The settings of the documented command.
    let simulation = Simulation::new(SimulationSettings {
        scene: SceneKind::Desk,
        trajectory: TrajectoryKind::Orbit,
        seed: 3,
        frames: 30,
        ..SimulationSettings::default()
    });
    let simulation = simulation.unwrap();
    let bag = BagReader::open(&kept("desk.mcap")).unwrap();
    let images = bag.messages().only(["/camera/color/image_raw/compressed"]);
    let images: Vec<_> = images.map(|message| decode_color(&message).unwrap()).collect();
    assert_eq!(images.len(), simulation.frame_count());
    for (index, image) in images.iter().enumerate().step_by(7) {
        let rendered = simulation.frame(index).rgb;
        let pairs = image.data.iter().zip(&rendered);
        let far: u64 = pairs.map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        let mean = far as f64 / rendered.len() as f64;
        // JPEG of quality 80 blurs edges; stripes of wrong colours would be off by tens everywhere.
        assert!(image.data.len() == rendered.len() && mean < 3.0, "image {index} is off by {mean}");
    }
}

/// The program alone is enough: the bag is in it.
#[test]
fn the_demo_runs_from_any_folder() {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_ellipsoid_slam"))
        .args(["demo", "--no-report"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let made = folder.path().join("demo");
    assert_eq!(fs::read(made.join("desk.mcap")).unwrap(), fs::read(kept("desk.mcap")).unwrap());
    assert!(fs::read_to_string(made.join("map.json")).unwrap().contains("keyboard"));
}
