//! A map that is kept over days: the same home, driven through twice.

use crate::run::{run, stderr};
use ellipsoid_slam::{
    geometry::{local, yaw_of},
    io::{load_saved_map, read_trajectory},
    mapping::SavedMap,
};
use serde_json::Value;
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

const SEED: &str = "11";

/// A drive through the home; odometry starts at zero wherever the robot was switched on.
fn drive(folder: &Path, name: &str, seed: &str, trajectory: &str, visit: &str) -> PathBuf {
    let bag = folder.join(name).with_extension("mcap");
    let zero = format!("odometry.starts_at_zero={}", visit != "0");
    let path = bag.to_str().unwrap();
    let simulated = run(&[
        "simulate",
        "--scene",
        "home",
        "--trajectory",
        trajectory,
        "--seed",
        seed,
        "--visit",
        visit,
        "--set",
        &zero,
        "--no-color",
        "--output",
        path,
    ]);
    assert!(simulated.status.success(), "{}", stderr(&simulated));
    bag
}

fn replayed(bag: &Path, map: Option<&Path>) -> (PathBuf, String) {
    let out = bag.with_extension("out");
    let mut args = vec!["replay", bag.to_str().unwrap(), "--output", out.to_str().unwrap()];
    args.extend(map.map(|map| ["--map", map.to_str().unwrap()]).into_iter().flatten());
    let output = run(&args);
    assert!(output.status.success(), "{}", stderr(&output));
    let said = stderr(&output);
    (out, said)
}

fn ids(map: &SavedMap) -> Vec<u64> {
    map.objects.iter().map(|object| object.id).collect()
}

/// Largest distance of an object's centre from the true object next to it, of those that were seen often (m).
fn worst(map: &SavedMap, truth: &Path) -> f64 {
    let truth: Value = serde_json::from_str(&fs::read_to_string(truth).unwrap()).unwrap();
    let nearest = |at: nalgebra::Point3<f64>| {
        let apart = |o: &Value| {
            let p: [f64; 3] = std::array::from_fn(|i| o["position"][i].as_f64().unwrap());
            (nalgebra::Point3::from(p) - at).norm()
        };
        truth["objects"].as_array().unwrap().iter().map(apart).fold(f64::MAX, f64::min)
    };
    let often = map.objects.iter().filter(|object| object.observations >= 20);
    often.map(|object| nearest(object.ellipsoid.center())).fold(0.0, f64::max)
}

#[test]
fn a_second_visit_at_an_unknown_start_continues_the_map() {
    let folder = tempfile::tempdir().unwrap();
    let (first, _) = replayed(&drive(folder.path(), "first", SEED, "forward", "0"), None);
    let saved = load_saved_map(&first.join("map.json")).unwrap();
    let bytes = fs::read(first.join("map.json")).unwrap();

    let bag = drive(folder.path(), "second", SEED, "loop", "1");
    let (second, said) = replayed(&bag, Some(&first.join("map.json")));
    assert!(!said.contains("not recognised"), "{said}");
    assert_eq!(fs::read(first.join("map.json")).unwrap(), bytes, "the file is only read");
    let continued = load_saved_map(&second.join("map.json")).unwrap();
    let kept = ids(&saved).into_iter().filter(|id| ids(&continued).contains(id)).count();
    println!("{kept} of {} identities are still there", saved.objects.len());
    // What was a ghost in the first visit may be seen through in the second.
    assert!(kept * 10 >= saved.objects.len() * 8, "{kept} of {}", saved.objects.len());
    let labels: BTreeMap<u64, &str> =
        continued.objects.iter().map(|o| (o.id, o.label.as_str())).collect();
    for often in saved.objects.iter().filter(|object| object.observations >= 20) {
        assert_eq!(labels.get(&often.id), Some(&often.label.as_str()), "object {}", often.id);
    }
    let highest = ids(&saved).into_iter().max().unwrap();
    let is_new = |id: &u64| !ids(&saved).contains(id);
    assert!(ids(&continued).iter().filter(|id| is_new(id)).all(|id| *id > highest));
    let worst = worst(&continued, &bag.with_extension("gt.json"));
    println!("the worst object is {worst:.3} m off");
    assert!(worst < 0.35, "{worst} m");

    // In the saved map's frame, which is the true one: odometry's start is metres and a quarter turn away from it.
    let poses = |path: &Path| read_trajectory(path).unwrap();
    let (found, truth) =
        (poses(&second.join("trajectory.tum")), poses(&bag.with_extension("gt.tum")));
    assert!(truth[0].1.translation.vector.norm() > 1.0 && yaw_of(&truth[0].1).abs() > 1.0);
    assert_eq!(found.len(), truth.len());
    let error = |(a, b): (&(_, _), &(_, _))| local(&a.1, &b.1).fixed_rows::<3>(3).norm_squared();
    let squares: f64 = found.iter().zip(&truth).map(error).sum();
    let ate = (squares / found.len() as f64).sqrt();
    println!("absolute trajectory error {ate:.3} m");
    assert!(ate < 0.15, "{ate} m");
}

#[test]
fn a_map_of_another_place_stays_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let bag = drive(folder.path(), "home", SEED, "forward", "0");
    let (first, _) = replayed(&bag, None);
    let map = first.join("map.json");
    let (other, said) = {
        let other = folder.path().join("elsewhere.mcap");
        let path = other.to_str().unwrap();
        let simulated = run(&[
            "simulate",
            "--scene",
            "desk",
            "--trajectory",
            "orbit",
            "--seed",
            "3",
            "--frames",
            "8",
            "--no-color",
            "--output",
            path,
        ]);
        assert!(simulated.status.success(), "{}", stderr(&simulated));
        replayed(&other, Some(&map))
    };
    assert!(said.contains("was not recognised: "), "{said}");
    let (before, after) =
        (load_saved_map(&map).unwrap(), load_saved_map(&other.join("map.json")).unwrap());
    assert_eq!(ids(&before), ids(&after));
    for (a, b) in before.objects.iter().zip(&after.objects) {
        assert!((a.ellipsoid.center() - b.ellipsoid.center()).norm() < 1e-9, "{a:?} became {b:?}");
        assert_eq!(a.observations, b.observations);
    }
    let local = load_saved_map(&other.join("local_map.json")).unwrap();
    let highest = ids(&before).into_iter().max().unwrap();
    assert!(!local.objects.is_empty() && ids(&local).iter().all(|id| *id > highest));
}

#[test]
fn a_map_that_is_none_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let map = folder.path().join("broken.json");
    fs::write(&map, "{\"version\": 9}").unwrap();
    let out = folder.path().join("out");
    let output = run(&[
        "replay",
        "bags/desk.mcap",
        "--map",
        map.to_str().unwrap(),
        "--output",
        out.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("version 9"), "{}", stderr(&output));
    assert!(!out.exists());
}
