//! Parameter files.

use crate::run::{run, stderr};
use ellipsoid_slam::{
    config::{KEYS, settings_from_yaml, settings_to_yaml},
    perception::FitModel,
    pipeline::Settings,
};
use serde_json::Value;
use std::fs;

const SHIPPED: &str = include_str!("../../config/ellipsoid_slam.yaml");

#[test]
fn the_shipped_file_is_the_defaults() {
    assert_eq!(settings_from_yaml(SHIPPED).unwrap(), Settings::default());
    let printed = settings_to_yaml(&Settings::default()).unwrap();
    assert!(printed == SHIPPED, "run `ellipsoid_slam config > config/ellipsoid_slam.yaml`");
}

#[test]
fn every_key_is_documented_and_every_documented_key_exists() {
    fn leaves(value: &Value, path: &str, out: &mut Vec<String>) {
        for (key, value) in value.as_object().into_iter().flatten() {
            let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            if path != "perception.classes.listed" && path != "perception.classes.unlisted" {
                leaves(value, &path, out);
            }
            out.push(path);
        }
    }
    let mut existing = Vec::new();
    leaves(&serde_json::to_value(Settings::default()).unwrap(), "", &mut existing);
    let mut documented: Vec<String> = KEYS.iter().map(|k| k.path.to_owned()).collect();
    existing.sort();
    documented.sort();
    assert_eq!(documented, existing);
}

#[test]
fn a_file_changes_only_what_it_names() {
    let text = "/**:\n  ros__parameters:\n    perception:\n      fit: quadric\n      classes:\n        listed:\n          robot vacuum: {symmetry: dual_plane, outline: cylinder}\n";
    let settings = settings_from_yaml(text).unwrap();
    assert_eq!(settings.perception.fit, FitModel::Quadric);
    let mut expected = Settings::default();
    expected.perception.fit = FitModel::Quadric;
    let vacuum = settings.perception.classes.prior("robot vacuum");
    expected.perception.classes.listed.insert("robot vacuum".into(), vacuum);
    assert_eq!(settings, expected);
    let again = settings_from_yaml(&settings_to_yaml(&settings).unwrap()).unwrap();
    assert_eq!(again, settings);
}

#[test]
fn mistakes_are_named() {
    let cases = [
        ("sync: {slopp_s: 0.1}", "unknown key `sync.slopp_s`; did you mean `sync.slop_s`?"),
        ("perception: {segmentation: {max_range_m: -1}}", "perception.segmentation.max_range_m"),
        ("perception: {segmentation: {max_range_m: far}}", "must be a number"),
        ("perception: {fit: spline}", "spline"),
        ("mapping: {gate: {ambiguity: .nan}}", "line 3"),
    ];
    for (body, words) in cases {
        let text = format!("ellipsoid_slam:\n  ros__parameters:\n    {body}\n");
        let error = settings_from_yaml(&text).unwrap_err().to_string();
        assert!(error.contains(words), "{body}: {error}");
    }
    assert!(settings_from_yaml("sync: {slop_s: 0.1}").unwrap_err().to_string().contains("ros__"));
    assert!(settings_from_yaml("a: [").is_err());
}

#[test]
fn the_file_with_the_mistake_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mine.yaml");
    fs::write(&file, "ellipsoid_slam:\n  ros__parameters:\n    snyc: {}\n").unwrap();
    let output = run(&["config", "--config", file.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    let text = stderr(&output);
    assert!(text.contains("mine.yaml") && text.contains("snyc"), "{text}");
}
