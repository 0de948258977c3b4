//! `experiment` as a user calls it, cut down to what a test has time for.

use crate::commands::{fails, succeeds};
use serde_json::Value;
use std::{fs, path::Path};

const REDUCED: &str = "experiment --seeds 1 --rows dwb,ours --frames 6";

fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    let mut files: Vec<_> = entries.map(|path| (name(&path), fs::read(&path).unwrap())).collect();
    files.sort();
    files
}

#[test]
fn the_same_command_gives_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    succeeds(folder, &format!("{REDUCED} --output first"));
    // On one thread, too: nothing hangs on which trial is ready first.
    let again = std::process::Command::new(env!("CARGO_BIN_EXE_ellipsoid_slam"))
        .args(REDUCED.split_whitespace())
        .args(["--output", "second", "--json"])
        .env("RAYON_NUM_THREADS", "1")
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(again.status.success());
    let first = files(&folder.join("first"));
    let names: Vec<&str> = first.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names,
        [
            "experiments.html",
            "experiments.json",
            "experiments.md",
            "experiments_eps_z.svg",
            "experiments_views.svg"
        ]
    );
    assert_eq!(first, files(&folder.join("second")));
    // What is printed is what is written.
    let (_, json) = &first[1];
    assert_eq!(String::from_utf8_lossy(json), String::from_utf8_lossy(&again.stdout));
    what_is_written_is_whole(&folder.join("first"));
    a_new_run_is_compared(folder);
}

fn what_is_written_is_whole(folder: &Path) {
    let text = fs::read_to_string(folder.join("experiments.md")).unwrap();
    assert!(text.contains(&format!("\ncargo run --release -- {REDUCED} --force\n")), "{text}");
    for part in ["Table 2", "DwB", "0.357", "| desk, orbit | ours |", "experiments_views.svg"] {
        assert!(text.contains(part), "{part} is missing:\n{text}");
    }
    // The page has the table and the plots themselves, and asks for nothing else.
    let page = fs::read_to_string(folder.join("experiments.html")).unwrap();
    assert_eq!(page.matches("<svg").count(), 2);
    assert!(page.contains("<td>DwB</td>") || page.contains("<td>ours</td>"), "no table: {page}");
    assert!(!page.contains("<img") && !page.contains("src=") && !page.contains("<script"));
    let json = fs::read_to_string(folder.join("experiments.json")).unwrap();
    let json: Value = serde_json::from_str(&json).unwrap();
    let cell = |key: &str| &json["cells"][key];
    let given = &cell("desk-orbit/drifting-given/ours")["metrics"];
    assert_eq!(given["id_switches_per200"]["mean"], 0.0, "{given}");
    assert_ne!(given["ate_m"], given["odometry_ate_m"], "the graph has corrected the poses");
    let exact = &cell("desk-orbit/true-given/ours")["metrics"];
    // Given poses are held to a tenth of a millimetre.
    assert!(exact["ate_m"]["mean"].as_f64().unwrap() < 1e-4, "{exact}");
    assert!(exact["translation_m"]["mean"].as_f64().unwrap() < 0.2, "{exact}");
    assert_eq!(exact["shape"]["half_width"], Value::Null, "one seed has no interval");
    let ours = cell("desk-orbit/paper/ours");
    assert!(ours["found"].as_u64() > Some(0), "no object is whole and sure in 5 of 6 frames");
    let curve = ours["curves"]["shape"].as_array().unwrap();
    // The last point of the curve is the table's figure, but for the last optimisation of everything together.
    let last = curve.last().unwrap()["mean"].as_f64().unwrap();
    let table = ours["metrics"]["shape"]["mean"].as_f64().unwrap();
    assert!((last - table).abs() < 0.01, "{last} and {table}");
}

/// A file of an earlier run is agreed with, and disagreed with where it says something else.
fn a_new_run_is_compared(folder: &Path) {
    let check = format!("{REDUCED} --check first/experiments.json");
    let says = succeeds(folder, &check);
    assert!(says.starts_with("all ") && says.contains("lie in the intervals"), "{says}");
    assert!(!folder.join("docs").exists(), "a check writes nothing");

    let mut kept: Value =
        serde_json::from_slice(&fs::read(folder.join("first/experiments.json")).unwrap()).unwrap();
    let metrics = &mut kept["cells"]["desk-orbit/paper/ours"]["metrics"];
    let shape = metrics["shape"]["mean"].as_f64().unwrap();
    // One is wrong and says so, the other is wrong by less than its interval.
    metrics["shape"]["mean"] = (shape + 0.5).into();
    let iou = metrics["iou"]["mean"].as_f64().unwrap();
    (metrics["iou"]["mean"], metrics["iou"]["half_width"]) = ((iou + 0.1).into(), 0.2.into());
    fs::write(folder.join("other.json"), kept.to_string()).unwrap();
    let output = crate::commands::call(folder, &check.replace("first/experiments", "other"));
    let says = String::from_utf8(output.stdout).unwrap();
    assert_eq!((output.status.code(), says.lines().count()), (Some(1), 1), "{says}");
    assert!(says.starts_with("desk-orbit/paper/ours, shape: is "), "{says}");
    let errors = String::from_utf8(output.stderr).unwrap();
    assert!(errors.starts_with("error: 1 of "), "{errors}");
}

#[test]
fn bad_arguments_get_a_sentence_and_status_2() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (arguments, expected) in [
        ("--seeds 0", "0"),
        ("--seeds many", "many"),
        ("--frames 1", "1"),
        ("--rows ours,theirs", "one-frame, "),
        ("--rows", "--rows"),
        ("--check a.json --force", "--force"),
    ] {
        let says = fails(folder, &format!("experiment {arguments}"), 2);
        assert!(says.contains(expected), "{arguments}: {says}");
    }
    fs::create_dir(folder.join("docs")).unwrap();
    for existing in ["experiments.md", "experiments.json", "experiments_views.svg"] {
        let file = folder.join("docs").join(existing);
        fs::write(&file, "mine").unwrap();
        let says = fails(folder, "experiment", 2);
        assert!(says.contains(existing) && says.contains("--force"), "{says}");
        assert_eq!(fs::read_to_string(&file).unwrap(), "mine");
        fs::remove_file(file).unwrap();
    }
}

#[test]
fn a_file_that_cannot_be_compared_is_refused_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let says = fails(folder, "experiment --check nowhere.json", 1);
    assert!(says.contains("nowhere.json"), "{says}");
    fs::write(folder.join("a.json"), "[]").unwrap();
    assert!(fails(folder, "experiment --check a.json", 1).contains("a.json holds no results"));
    fs::write(folder.join("b.json"), r#"{"seeds": 1, "frames": 6, "cells": {}}"#).unwrap();
    let says = fails(folder, "experiment --check b.json", 2);
    assert!(says.contains("6 frames") && says.contains("--frames"), "{says}");
}
