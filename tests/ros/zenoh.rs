//! Over a router of Zenoh's own Python package, with keys as `rmw_zenoh` has them and ROS 2's own hashes of types and CDR.

use crate::{
    environment,
    fast_dds::check_markers,
    processes::{BAG, BAG_TOPICS, Running, Stage, succeeded},
};
use ellipsoid_slam::msg::{
    schema_text,
    type_hash::{message_hash, service_hash},
};
use serde_json::Value;
use std::{fs, process::Command};

const REQUIREMENTS: &str = "tests/ros/zenoh/requirements.txt";

/// A stage whose nodes meet at a router.
struct Network {
    stage: Stage,
    port: String,
    _router: Running,
}

impl Network {
    fn start() -> Self {
        let stage = Stage::new();
        let port = (17_400 + stage.domain()).to_string();
        let router = stage.peer_with(REQUIREMENTS, "zenoh_router.py", &[&port]);
        let router = stage.start(router, "router");
        router.wait_for("the router listens");
        Self { stage, port, _router: router }
    }

    fn program(&self, args: &[&str]) -> Command {
        let mut program = self.stage.program(args);
        let router = format!("connect/endpoints=[\"tcp/127.0.0.1:{}\"]", self.port);
        program.env("RMW_IMPLEMENTATION", "rmw_zenoh_cpp").env("ZENOH_CONFIG_OVERRIDE", router);
        program
    }

    fn node(&self, log: &str, ros_args: &[&str]) -> Running {
        let args = [&["-v", "node", "--ros-args"], ros_args].concat();
        let node = self.stage.start(self.program(&args), log);
        node.wait_for("runs in domain");
        node
    }

    fn peer(&self, script: &str, args: &[&str]) -> Command {
        let mut peer = self.stage.peer_with(REQUIREMENTS, script, args);
        peer.env("ZENOH_PORT", &self.port);
        peer
    }
}

#[test]
fn a_bag_played_over_zenoh_gives_the_objects_of_a_replay() {
    let network = Network::start();
    let path = |name: &str| network.stage.path(name);
    let file = format!("map.file:={}", path("map.json"));
    let save = ["-p", "map.save_on_shutdown:=true", "-p", &file];
    let mut node = network.node("node", &[&BAG_TOPICS[..], &save].concat());
    let play = network.program(&["play", BAG, "--rate", "2", "--wait", "60"]).output().unwrap();
    succeeded(&play, &node);
    let (markers, saved) = (path("markers.json"), path("saved.json"));
    let peer = network.peer("zenoh_peer.py", &[&markers, &saved]).output().unwrap();
    succeeded(&peer, &node);
    assert!(node.stop("INT").success(), "{}", node.log());

    let replayed = path("replay");
    let replay = network.program(&["replay", BAG, "--output", &replayed]).output().unwrap();
    succeeded(&replay, &node);
    let expected = fs::read_to_string(format!("{replayed}/map.json")).unwrap();
    assert_eq!(fs::read_to_string(path("map.json")).unwrap(), expected, "{}", node.log());
    check_markers(&fs::read_to_string(markers).unwrap(), &format!("{replayed}/result.mcap"));
    let objects = |map: &str| serde_json::from_str::<Value>(map).unwrap()["objects"].clone();
    let saved = objects(&fs::read_to_string(saved).unwrap());
    assert_eq!(saved.as_array().unwrap().len(), objects(&expected).as_array().unwrap().len());
}

#[test]
fn what_is_wrong_on_zenoh_is_named() {
    let network = Network::start();
    let node = network.node("node", &[]);
    node.wait_for("nobody publishes /detections");
    let mut twin = network.node("twin", &[]);
    node.wait_for("another node is called /ellipsoid_slam too");
    // It says goodbye, and is forgotten.
    assert!(twin.stop("TERM").success(), "{}", twin.log());
    node.wait_for("no longer: another node");
    let peer = network.peer("zenoh_wrong_type.py", &[]);
    let _peer = network.stage.start(peer, "peer");
    node.wait_for("/odom is published as sensor_msgs/msg/CameraInfo, but odometry needs");
}

/// Against the hashes that ROS 2's own generator wrote into its packages.
#[test]
fn hashes_of_types_are_those_of_ros_2() {
    let python = environment::python(REQUIREMENTS).unwrap();
    let share = python.ancestors().nth(2).unwrap().join("share");
    let published = |name: &str| {
        let text = fs::read_to_string(share.join(name).with_extension("json")).unwrap();
        let all: Value = serde_json::from_str(&text).unwrap();
        let hashes = all["type_hashes"].as_array().unwrap();
        let own = hashes.iter().find(|hash| hash["type_name"] == name).unwrap();
        own["hash_string"].as_str().unwrap().to_owned()
    };
    for name in MESSAGES {
        let text = schema_text(name).unwrap();
        assert_eq!(message_hash(name, &text).unwrap(), published(name), "{name}");
    }
    for name in SERVICES {
        assert_eq!(service_hash(name).unwrap(), published(name), "{name}");
    }
}

const MESSAGES: [&str; 13] = [
    "builtin_interfaces/msg/Time",
    "diagnostic_msgs/msg/DiagnosticArray",
    "geometry_msgs/msg/TransformStamped",
    "nav_msgs/msg/Odometry",
    "nav_msgs/msg/Path",
    "rcl_interfaces/msg/Log",
    "rosgraph_msgs/msg/Clock",
    "sensor_msgs/msg/CameraInfo",
    "sensor_msgs/msg/CompressedImage",
    "sensor_msgs/msg/Image",
    "std_msgs/msg/Header",
    "visualization_msgs/msg/Marker",
    "visualization_msgs/msg/MarkerArray",
];
const SERVICES: [&str; 8] = [
    "rcl_interfaces/srv/DescribeParameters",
    "rcl_interfaces/srv/GetParameters",
    "rcl_interfaces/srv/GetParameterTypes",
    "rcl_interfaces/srv/ListParameters",
    "rcl_interfaces/srv/SetParameters",
    "rcl_interfaces/srv/SetParametersAtomically",
    "std_srvs/srv/SetBool",
    "std_srvs/srv/Trigger",
];
