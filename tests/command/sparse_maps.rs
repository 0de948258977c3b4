//! First maps of nothing, or of next to nothing: they lock no robot out.

use crate::run::{run, stderr};
use ellipsoid_slam::{
    geometry::{Pose, yaw_of},
    io::{load_saved_map, read_trajectory, save_map},
    mapping::{SavedMap, SavedObject},
};
use nalgebra::Vector3;
use std::{fs, path::Path};

const BAG: &str = "bags/desk.mcap";

/// Replays the demo bag into a folder; what was said.
fn replayed(out: &Path, more: &[&str]) -> String {
    let args = [&["replay", BAG, "--no-report", "--output", out.to_str().unwrap()], more].concat();
    let output = run(&args);
    assert!(output.status.success(), "{}", stderr(&output));
    stderr(&output)
}

fn ids(map: &SavedMap) -> Vec<u64> {
    map.objects.iter().map(|object| object.id).collect()
}

#[test]
fn an_empty_map_is_none_and_a_map_of_two_objects_is_entered_where_told_or_kept_beside() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    replayed(&file("first"), &[]);
    let text = |name: &str| fs::read_to_string(file(name)).unwrap();
    let whole = load_saved_map(&file("first/map.json")).unwrap();

    save_map(&file("empty.json"), &SavedMap { objects: Vec::new(), ..whole.clone() }).unwrap();
    let said = replayed(&file("from_empty"), &["--map", file("empty.json").to_str().unwrap()]);
    assert!(!said.contains("recognised"), "{said}");
    assert_eq!(text("from_empty/map.json"), text("first/map.json"));

    // The same desk in another frame, and of it two objects.
    let moved = Pose::new(Vector3::new(3.0, -1.0, 0.0), 2.0 * Vector3::z());
    let mut two = whole.clone();
    two.objects.retain(|o| ["monitor", "tv", "cup", "bottle"].contains(&&*o.label));
    two.objects.truncate(2);
    assert_eq!(two.objects.len(), 2, "{:?}", whole.objects.iter().map(|o| &o.label));
    for object in &mut two.objects {
        object.id += 100;
        object.ellipsoid = object.ellipsoid.transformed(&moved);
    }
    save_map(&file("two.json"), &two).unwrap();
    let two_file = file("two.json");
    let map = ["--map", two_file.to_str().unwrap()];

    let said = replayed(&file("beside"), &map);
    assert!(said.contains("too few to recognise a place by"), "{said}");
    let aside = load_saved_map(&file("beside/set_aside_map.json")).unwrap();
    assert_eq!(ids(&aside), ids(&two));
    for (kept, was) in aside.objects.iter().zip(&two.objects) {
        assert!((kept.ellipsoid.center() - was.ellipsoid.center()).norm() < 1e-9);
    }
    let beside = load_saved_map(&file("beside/map.json")).unwrap();
    assert_eq!(beside.objects.len(), whole.objects.len());
    assert!(ids(&beside).iter().all(|id| *id > 102));

    let first: Pose = read_trajectory(&file("first/trajectory.tum")).unwrap()[0].1;
    let started = moved * first;
    // Nobody knows to the centimetre where a robot is switched on.
    let (at, yaw) = (started.translation.vector, yaw_of(&started).to_degrees());
    let start = format!("--start={},{},{}", at.x + 0.15, at.y - 0.1, yaw + 4.0);
    let said = replayed(&file("told"), &[map[0], map[1], &start]);
    assert!(!said.contains("not recognised"), "{said}");
    assert!(!file("told/set_aside_map.json").exists() && !file("told/local_map.json").exists());
    let told = load_saved_map(&file("told/map.json")).unwrap();
    assert_eq!(told.objects.len(), whole.objects.len(), "{said}");
    for known in &two.objects {
        let found = told.objects.iter().find(|o| o.id == known.id).expect("its identity");
        assert_eq!(found.label, known.label);
        let apart = (found.ellipsoid.center() - known.ellipsoid.center()).norm();
        assert!(apart < 0.05, "{} is {apart} m from where it was", known.label);
    }
    // The others are in the same frame: the heading was off by four degrees at the start.
    for object in &whole.objects {
        let there = moved * object.ellipsoid.center();
        let apart = |o: &SavedObject| (o.ellipsoid.center() - there).norm();
        let nearest = told.objects.iter().map(apart).fold(f64::MAX, f64::min);
        assert!(nearest < 0.12, "{} is {nearest} m from where it was", object.label);
    }
}
