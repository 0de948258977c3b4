//! The map's services.

use crate::processes::{BAG, BAG_TOPICS, Stage, succeeded};
use ellipsoid_slam::io::load_saved_map;
use std::path::Path;

const PLAY: [&str; 6] = ["play", BAG, "--rate", "2", "--wait", "60"];

#[test]
fn cyclone_dds_looks_objects_up_edits_them_and_saves_and_loads_the_map() {
    let stage = Stage::new();
    let maps = format!("map.directory:={}", stage.path(""));
    let frames = ["-p", "publish.object_frames:=true"];
    let mut node = stage.node(&[&BAG_TOPICS[..], &["-p", &maps], &frames].concat());
    node.wait_for("runs in domain");
    succeeded(&stage.program(&PLAY).output().unwrap(), &node);
    let map = stage.path("map.json");
    let peer = stage.peer("cyclone_services.py", &[&map]).output().unwrap();
    succeeded(&peer, &node);
    assert!(node.stop("TERM").success(), "{}", node.log());
    check_log(&node.log());
    for said in [
        "an initial pose is of use only where a map is loaded",
        "/initialpose: the pose is in `odom`, and has to be in `map`",
        "looked for about (1.25, -2.00)",
    ] {
        assert!(node.log().contains(said), "{said}\n{}", node.log());
    }
    assert!(!node.log().contains("about (7.00"), "{}", node.log());

    // Another node begins with this map, and does not begin with what is none.
    let file = format!("map.file:={map}");
    let next = stage.node_as("next", &["-p", &file, "-p", "map.load_on_start:=true"]);
    next.wait_for("objects is loaded");
    std::fs::write(&map, "no map").unwrap();
    let mut refused = stage.node_as("refused", &["-p", &file, "-p", "map.load_on_start:=true"]);
    assert!(!refused.wait().success());
    assert!(refused.log().contains("map.json"), "{}", refused.log());
}

#[test]
fn a_running_node_loads_a_map_and_finds_its_place_in_it() {
    let stage = Stage::new();
    let maps = format!("map.directory:={}", stage.path("first"));
    let node = stage.node(&[&BAG_TOPICS[..], &["-p", &maps]].concat());
    let first = visit(&stage, "first.mcap", "16", &[]);
    let second = visit(&stage, "second.mcap", "24", &SWITCHED_ON_ELSEWHERE);
    let replayed = stage.path("first");
    let replay = stage.program(&["replay", &first, "--output", &replayed]).output().unwrap();
    succeeded(&replay, &node);
    node.wait_for("runs in domain");
    let map = format!("{replayed}/map.json");
    let mut peer = stage.start(stage.peer("cyclone_load_map.py", &[&map]), "peer");
    peer.wait_for("loaded");
    let play = stage.program(&["play", &second, "--rate", "2", "--wait", "60"]).output().unwrap();
    succeeded(&play, &node);
    assert!(peer.wait().success(), "{}\n{}", peer.log(), node.log());
    node.wait_for("the place in the loaded map is recognised");
}

#[test]
fn a_node_looks_for_its_place_where_it_is_told_to_have_started() {
    let stage = Stage::new();
    let first = visit(&stage, "first.mcap", "16", &[]);
    let second = visit(&stage, "second.mcap", "24", &SWITCHED_ON_ELSEWHERE);
    let replayed = stage.path("first");
    let replay = stage.program(&["replay", &first, "--output", &replayed]).output().unwrap();
    assert!(replay.status.success());
    // Nothing of the map is there, so that the node must not believe what it sees.
    let file = format!("map.file:={replayed}/map.json");
    let map = ["map.load_on_start:=true", "map.save_on_shutdown:=true", "map.start_pose:='80,0,0'"];
    let mut args = [&BAG_TOPICS[..], &["-p", &file]].concat();
    args.extend(map.iter().flat_map(|setting| ["-p", setting]));
    let mut node = stage.node(&args);
    node.wait_for("objects is loaded");
    let play = stage.program(&["play", &second, "--rate", "2", "--wait", "60"]).output().unwrap();
    succeeded(&play, &node);
    assert!(node.stop("INT").success(), "{}", node.log());
    assert!(
        node.log().contains("the place in the loaded map was not recognised"),
        "{}",
        node.log()
    );
}

#[test]
fn a_managed_node_is_activated_paused_reset_cleaned_up_and_shut_down() {
    let stage = Stage::new();
    let mut args = BAG_TOPICS.to_vec();
    let map = stage.path("map.json");
    let file = format!("map.file:={map}");
    args.extend(["-p", "publish.debug_image:=true", "-p", "topics.rgb_transport:=compressed"]);
    args.extend(["-p", "lifecycle.autostart:=false", "-p", "map.save_on_shutdown:=true"]);
    args.extend(["-p", &file]);
    let mut node = stage.node(&args);
    node.wait_for("runs in domain");
    let _player = stage.start(stage.program(&["play", BAG, "--loop", "--wait", "60"]), "player");
    let peer = stage.peer("rclpy_manager.py", &[]).output().unwrap();
    succeeded(&peer, &node);
    assert!(node.wait().success(), "{}", node.log());
    // It was saved when it was cleaned up, and not overwritten by the empty map that was there at the end.
    let saved = load_saved_map(Path::new(&map)).unwrap();
    assert!(saved.objects.len() >= 3, "{} objects\n{}", saved.objects.len(), node.log());
    assert_eq!(node.log().matches("map.json").count(), 1, "{}", node.log());
}

/// Each line has ROS's form and no colours, and what works is said once.
fn check_log(log: &str) {
    let in_form = |line: &&str| {
        let parts = line.split_once("] [").and_then(|(severity, rest)| {
            let (stamp, rest) = rest.split_once("] [ellipsoid_slam]: ")?;
            let (seconds, nanos) = stamp.split_once('.')?;
            let is_stamp = seconds.parse::<u64>().is_ok() && nanos.len() == 9;
            Some((severity, is_stamp && !rest.is_empty()))
        });
        matches!(parts, Some(("[DEBUG" | "[INFO" | "[WARN" | "[ERROR", true)))
    };
    for line in log.lines() {
        assert!(in_form(&line) && !line.contains('\x1b'), "{line}");
    }
    let new: Vec<&str> = log.lines().filter(|line| line.contains("]: new: ")).collect();
    assert!(new.len() >= 5, "{log}");
    assert_eq!(new.len(), new.iter().collect::<std::collections::BTreeSet<_>>().len(), "{log}");
    let rates = log.lines().filter(|line| line.contains("all inputs come: "));
    assert_eq!(rates.count(), 1, "{log}");
}

/// The robot is switched on somewhere else: odometry starts at zero there.
const SWITCHED_ON_ELSEWHERE: [&str; 4] = ["--visit", "1", "--set", "odometry.starts_at_zero=true"];

/// A bag of the desk.
fn visit(stage: &Stage, name: &str, frames: &str, more: &[&str]) -> String {
    let bag = stage.path(name);
    let scene = ["simulate", "--scene", "desk", "--trajectory", "orbit", "--seed", "1"];
    let args = [&scene[..], &["--frames", frames, "--output", &bag], more].concat();
    assert!(stage.program(&args).output().unwrap().status.success());
    bag
}
