//! Parameter files.

use crate::run::{run, stderr};
use ellipsoid_slam::{
    config::{NodeSettings, Parameters, keys, parameters_from_yaml, parameters_to_yaml},
    perception::FitModel,
    pipeline::Settings,
    publication::OutputTopic,
};
use serde_json::Value;
use std::fs;

const SHIPPED: &str = include_str!("../../config/ellipsoid_slam.yaml");

#[test]
fn the_shipped_file_is_the_defaults() {
    assert_eq!(parameters_from_yaml(SHIPPED).unwrap(), Parameters::default());
    let printed = parameters_to_yaml(&Parameters::default()).unwrap();
    assert!(printed == SHIPPED, "run `ellipsoid_slam config > config/ellipsoid_slam.yaml`");
}

#[test]
fn the_reference_is_what_the_program_says() {
    let output = run(&["config", "--markdown"]);
    let printed = String::from_utf8(output.stdout).unwrap();
    let kept = include_str!("../../docs/configuration.md");
    assert!(printed == kept, "run `ellipsoid_slam config --markdown > docs/configuration.md`");
    for key in keys().filter(|key| key.range.is_some()) {
        assert!(kept.contains(&format!("| `{}` |", key.path)), "{}", key.path);
    }
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
    leaves(&serde_json::to_value(NodeSettings::default()).unwrap(), "", &mut existing);
    leaves(&serde_json::to_value(Settings::default()).unwrap(), "", &mut existing);
    let mut documented: Vec<String> = keys().map(|k| k.path.to_owned()).collect();
    existing.sort();
    documented.sort();
    assert_eq!(documented, existing);
}

#[test]
fn a_file_changes_only_what_it_names() {
    let text = "/**:\n  ros__parameters:\n    perception:\n      fit: quadric\n      classes:\n        listed:\n          robot vacuum: {symmetry: dual_plane, outline: cylinder}\n";
    let parameters = parameters_from_yaml(text).unwrap();
    let settings = parameters.slam.clone();
    assert_eq!(settings.perception.fit, FitModel::Quadric);
    let mut expected = Settings::default();
    expected.perception.fit = FitModel::Quadric;
    let vacuum = settings.perception.classes.prior("robot vacuum");
    expected.perception.classes.listed.insert("robot vacuum".into(), vacuum);
    assert_eq!(settings, expected);
    let again = parameters_from_yaml(&parameters_to_yaml(&parameters).unwrap()).unwrap();
    assert_eq!(again, parameters);
}

/// What a file says for all nodes may be for another one, unless it is ours with a slip of the pen.
#[test]
fn a_slip_of_the_pen_below_a_wildcard_is_named_and_what_is_for_other_nodes_passed_over() {
    let text = |inside: &str| format!("/**:\n  ros__parameters:\n    {inside}\n");
    let why = parameters_from_yaml(&text("mappng: {min_observations: 4}")).unwrap_err();
    assert_eq!(why.to_string(), "unknown key `mappng`; did you mean `mapping`?");
    for others in ["controller_frequency: 20.0", "robot_radius: 0.2", "map_topic: /map"] {
        assert_eq!(parameters_from_yaml(&text(others)).unwrap(), Parameters::default());
    }
}

#[test]
fn mistakes_are_named() {
    let cases = [
        ("sync: {slopp_s: 0.1}", "unknown key `sync.slopp_s`; did you mean `sync.slop_s`?"),
        ("perception: {segmentation: {max_range_m: -1}}", "perception.segmentation.max_range_m"),
        ("perception: {segmentation: {max_range_m: far}}", "must be a number"),
        ("perception: {fit: spline}", "spline"),
        ("perception: {classes: {listed: {keyboard: {size_m: [0.13, 0.44, 0.03]}}}}", "the longer"),
        ("mapping: {labels: {wrong: 0.2}}", "mapping.labels.confused"),
        ("mapping: {gate: {ambiguity: .nan}}", "line 3"),
    ];
    for (body, words) in cases {
        let text = format!("ellipsoid_slam:\n  ros__parameters:\n    {body}\n");
        let error = parameters_from_yaml(&text).unwrap_err().to_string();
        assert!(error.contains(words), "{body}: {error}");
    }
    assert!(parameters_from_yaml("sync: {slop_s: 0.1}").unwrap_err().to_string().contains("ros__"));
    assert!(parameters_from_yaml("a: [").is_err());
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

#[test]
fn every_file_for_a_robot_loads_and_differs() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/config");
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let robots: Vec<_> = files
        .filter(|path| path.extension().is_some_and(|end| end == "yaml"))
        .filter(|path| path.file_stem().unwrap() != "ellipsoid_slam")
        .collect();
    assert!(robots.len() >= 3, "{robots:?}");
    for path in robots {
        let parameters = parameters_from_yaml(&fs::read_to_string(&path).unwrap());
        let parameters = parameters.unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        assert_ne!(parameters.node.topics, NodeSettings::default().topics, "{}", path.display());
    }
}

/// RViz drops a display whose topic is misspelt without a word.
#[test]
fn rviz_shows_topics_that_are_published() {
    let text = include_str!("../../config/ellipsoid_slam.rviz");
    let shown: Vec<&str> =
        text.lines().filter_map(|line| line.trim().strip_prefix("Value: /")).collect();
    assert!(shown.len() >= 5, "{shown:?}");
    let names = OutputTopic::ALL.map(OutputTopic::default_name);
    // Result bags have coloured points besides what the node publishes.
    let recorded = ["ellipsoid_slam/points"];
    for topic in shown {
        let is_known = names.contains(&format!("/{topic}")) || recorded.contains(&topic);
        assert!(is_known, "{topic}");
    }
}

#[test]
fn a_start_pose_is_three_numbers() {
    let with = |text: &str| {
        parameters_from_yaml(&format!(
            "/**:\n  ros__parameters:\n    map: {{start_pose: {text}}}\n"
        ))
    };
    let pose = with("'1.5, -2,90'").unwrap().node.map.start_pose.map_from_base().unwrap();
    let ahead = pose * nalgebra::Point3::new(1.0, 0.0, 0.0);
    assert!((ahead - nalgebra::Point3::new(1.5, -1.0, 0.0)).norm() < 1e-12, "{ahead}");
    assert!(with("''").unwrap().node.map.start_pose.map_from_base().is_none());
    for wrong in ["'1,2'", "'1,2,x'", "'1,2,nan'"] {
        let why = with(wrong).unwrap_err().to_string();
        assert!(why.contains("expected three numbers X,Y,YAW"), "{why}");
    }
}
