//! Which layer may know which, and which dependency lives where.

use crate::{
    paths::{names_crate, paths_below},
    source::SourceFile,
};

/// A layer and the layers it may use, innermost first. A new arrow is a change of design.
const LAYERS: &[(&str, &[&str])] = &[
    ("time", &[]),
    ("geometry", &[]),
    ("perception", &["time", "geometry"]),
    ("graph", &["geometry"]),
    ("mapping", &["time", "geometry", "perception", "graph"]),
    ("pipeline", &["time", "geometry", "perception", "graph", "mapping"]),
    ("config", &["geometry", "perception", "graph", "mapping", "pipeline"]),
    ("eval", &["time", "geometry"]),
    ("sim", &["time", "geometry"]),
    ("msg", &["time", "geometry", "perception", "mapping", "pipeline"]),
    ("topics", &["config", "msg"]),
    ("detector", &["geometry", "perception", "config", "msg"]),
    ("publication", &["time", "geometry", "mapping", "pipeline", "config", "msg"]),
    (
        "report",
        &["time", "geometry", "perception", "mapping", "pipeline", "eval", "msg", "publication"],
    ),
    ("io", &["time", "geometry", "perception", "mapping", "pipeline", "msg", "topics"]),
    (
        "ros",
        &[
            "time",
            "geometry",
            "perception",
            "mapping",
            "pipeline",
            "msg",
            "topics",
            "config",
            "publication",
        ],
    ),
    ("cli", SHELL_USES),
];
/// The outermost layer puts everything together.
const SHELL_USES: &[&str] = &[
    "time",
    "geometry",
    "perception",
    "mapping",
    "config",
    "pipeline",
    "eval",
    "sim",
    "report",
    "msg",
    "topics",
    "detector",
    "publication",
    "io",
    "ros",
];
/// Files that are no layer.
const ENTRANCES: &[&str] = &["lib", "main"];
/// Layers that get time and data handed in.
const PURE: &[&str] =
    &["time", "geometry", "perception", "graph", "mapping", "config", "pipeline", "eval"];
const OUTSIDE_WORLD: &[&str] = &["fs", "net", "env", "thread", "process", "time::SystemTime"];
const CLOCKS: &[&str] = &["Instant::now", "SystemTime"];
/// A large dependency and the layers it may be used in.
const HOMES: &[(&str, &[&str])] = &[
    ("faer", &["graph"]),
    ("parry3d", &["geometry", "sim", "mapping"]),
    ("mcap", &["io"]),
    ("rusqlite", &["io"]),
    ("zstd", &["io"]),
    ("rten", &["detector"]),
    ("rten_tensor", &["detector"]),
    ("plotters", &["cli"]),
    ("ros2_client", &["ros"]),
    ("tokio", &["ros", "cli"]),
    ("zenoh", &["ros"]),
    ("zenoh_ext", &["ros"]),
];

fn allowed(layer: &str) -> Option<&'static [&'static str]> {
    LAYERS.iter().find(|(name, _)| *name == layer).map(|(_, uses)| *uses)
}

pub(crate) fn homeless(file: &SourceFile) -> Vec<String> {
    let layer = file.layer();
    let known = allowed(layer).is_some() || ENTRANCES.contains(&layer);
    let what = format!("\"{layer}\" is no layer: give it a place and its arrows");
    (!known).then_some(what).into_iter().collect()
}

pub(crate) fn outward_uses(file: &SourceFile) -> Vec<String> {
    let layer = file.layer();
    let Some(allowed) = allowed(layer) else { return Vec::new() };
    let mut used = paths_below(&file.code, "crate");
    if file.is_layer_root() {
        used.extend(paths_below(&file.code, "super"));
    }
    used.sort();
    used.dedup();
    used.iter()
        .filter(|name| LAYERS.iter().any(|(other, _)| other == name))
        .filter(|name| *name != layer && !allowed.contains(&name.as_str()))
        .map(|name| format!("{layer} may not use {name}"))
        .collect()
}

pub(crate) fn impurities(file: &SourceFile) -> Vec<String> {
    let layer = file.layer();
    if !PURE.contains(&layer) {
        return Vec::new();
    }
    let mut named: Vec<String> = paths_below(&file.code, "std")
        .into_iter()
        .filter(|path| OUTSIDE_WORLD.contains(&path.as_str()))
        .map(|path| format!("std::{path}"))
        .collect();
    named.extend(CLOCKS.iter().filter(|clock| file.code.contains(**clock)).map(|c| (*c).into()));
    named.into_iter().map(|what| format!("{layer} is pure and may not name {what}")).collect()
}

pub(crate) fn strayed_dependencies(file: &SourceFile) -> Vec<String> {
    let layer = file.layer();
    HOMES
        .iter()
        .filter(|(name, homes)| !homes.contains(&layer) && names_crate(&file.code, name))
        .map(|(name, homes)| format!("{name} is at home in {homes:?}"))
        .collect()
}

#[test]
fn arrows_point_inwards_only() {
    for (at, (layer, uses)) in LAYERS.iter().enumerate() {
        for used in *uses {
            let place = LAYERS.iter().position(|(name, _)| name == used);
            assert!(place.is_some_and(|place| place < at), "{layer} → {used}");
        }
    }
    for name in PURE.iter().chain(HOMES.iter().flat_map(|(_, homes)| *homes)) {
        assert!(allowed(name).is_some(), "{name}");
    }
}

#[test]
fn planted_faults_are_found() {
    type Rule = fn(&SourceFile) -> Vec<String>;
    let faults: &[(Rule, &str, &str)] = &[
        (outward_uses, "src/geometry/pose.rs", "use crate::mapping::ObjectMap;"),
        (outward_uses, "src/geometry/pose.rs", "use crate::{\n    time::Stamp,\n};"),
        (outward_uses, "src/perception/fit.rs", "fn f() { crate::graph::solve() }"),
        (outward_uses, "src/graph/mod.rs", "use super::perception::Frame;"),
        (outward_uses, "src/time.rs", "use super::{geometry::Pose};"),
        (outward_uses, "src/io/bag.rs", "use crate::{msg::Cdr, ros};"),
        (outward_uses, "src/pipeline/slam.rs", "use crate::{geometry, io::{Bag}};"),
        (homeless, "src/extras/mod.rs", ""),
        (homeless, "src/extras.rs", ""),
        (impurities, "src/geometry/pose.rs", "use std::fs;"),
        (impurities, "src/mapping/map.rs", "use std::{collections::BTreeMap, fs::File};"),
        (impurities, "src/pipeline/slam.rs", "std::thread::spawn(f);"),
        (impurities, "src/pipeline/slam.rs", "use std::time::Instant; let t = Instant::now();"),
        (impurities, "src/eval/a.rs", "use std::{time::SystemTime};"),
        (strayed_dependencies, "src/mapping/map.rs", "use faer::Mat;"),
        (strayed_dependencies, "src/perception/a.rs", "parry3d::query::distance()"),
        (strayed_dependencies, "src/msg/a.rs", "use mcap::Writer;"),
        (strayed_dependencies, "src/io/a.rs", "use ros2_client::Node;"),
        (strayed_dependencies, "src/eval/a.rs", "use plotters::prelude::*;"),
        (strayed_dependencies, "src/io/a.rs", "use tokio as rt;"),
        (strayed_dependencies, "src/main.rs", "#[tokio::main]"),
    ];
    for (rule, path, text) in faults {
        assert!(!rule(&SourceFile::new(path, text)).is_empty(), "{path}: {text}");
    }
}

#[test]
fn honest_code_is_left_alone() {
    for (path, text) in [
        ("src/perception/fit.rs", "use crate::{geometry::{Ellipsoid, Outline}, time::Stamp};"),
        ("src/perception/fit.rs", "use crate::perception::Frame; // not crate::graph"),
        ("src/perception/symmetry.rs", "use super::{Frame, Sight};"),
        ("src/time.rs", "use std::{fmt, time::Duration};"),
        ("src/io/bag.rs", "use std::fs::File; use mcap::Writer; use crate::io::mcap_scan;"),
        ("src/cli/node.rs", "use tokio::runtime; use crate::{ros, io};"),
        ("src/main.rs", "use ellipsoid_slam::cli;"),
    ] {
        let file = SourceFile::new(path, text);
        let rules = [outward_uses, homeless, impurities, strayed_dependencies];
        let complaints: Vec<String> = rules.iter().flat_map(|rule| rule(&file)).collect();
        assert!(complaints.is_empty(), "{path}: {complaints:?}");
    }
}
