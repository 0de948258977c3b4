//! Over a router of Zenoh's own Python package, with keys as `rmw_zenoh` has them and ROS 2's own hashes of types and CDR.

use crate::{
    environment::{self, run},
    fast_dds::check_markers,
    processes::{BAG, BAG_TOPICS, Running, Stage, succeeded},
};
use ellipsoid_slam::msg::{
    schema_text,
    type_hash::{message_hash, service_hash},
};
use serde_json::Value;
use std::{collections::BTreeMap, fs, process::Command};

const REQUIREMENTS: &str = "tests/ros/zenoh/requirements.txt";

/// A stage whose nodes meet at a router.
struct Network {
    stage: Stage,
    port: String,
}

impl Network {
    fn new() -> Self {
        let stage = Stage::new();
        let port = (17_400 + stage.domain()).to_string();
        Self { stage, port }
    }

    fn router(&self) -> Running {
        let router = self.stage.peer_with(REQUIREMENTS, "zenoh_router.py", &[&self.port]);
        let router = self.stage.start(router, "router");
        router.wait_for("the router listens");
        router
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
    let network = Network::new();
    let _router = network.router();
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
    assert!(!node.log().contains(NO_ROUTER), "{}", node.log());

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
    let network = Network::new();
    let _router = network.router();
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

#[test]
fn a_node_that_starts_before_the_router_says_so_and_meets_others_later() {
    let network = Network::new();
    let node = network.node("node", &BAG_TOPICS);
    assert!(node.log().contains(NO_ROUTER), "{}", node.log());
    let _router = network.router();
    let play = network.program(&["play", BAG, "--rate", "4", "--wait", "60"]).output().unwrap();
    succeeded(&play, &node);
    let said = String::from_utf8_lossy(&play.stderr);
    assert!(!said.contains("nobody listens"), "{said}");
}

#[test]
fn what_is_no_setting_of_zenoh_is_named() {
    let network = Network::new();
    for wrong in ["nonsense", "mode=\"pear\"", "no/such=1"] {
        let mut node = network.program(&["node"]);
        let refused = node.env("ZENOH_CONFIG_OVERRIDE", wrong).output().unwrap();
        assert_eq!(refused.status.code(), Some(1));
        let said = String::from_utf8_lossy(&refused.stderr);
        assert!(said.contains(wrong) && said.lines().count() == 1, "{said}");
    }
}

const NO_ROUTER: &str = "no Zenoh router answers yet";

/// Against the hashes that ROS 2's own generator wrote into its packages, and makes of our files.
#[test]
fn hashes_of_types_are_those_of_ros_2() {
    let python = environment::python(REQUIREMENTS).unwrap();
    let share = python.ancestors().nth(2).unwrap().join("share");
    let ours = run(Command::new(python).arg("tests/ros/zenoh_hashes.py")).unwrap();
    let ours: BTreeMap<String, String> =
        serde_json::from_str(ours.lines().last().unwrap()).unwrap();
    let published = |name: &str| {
        if let Some(hash) = ours.get(name) {
            return hash.clone();
        }
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

const MESSAGES: [&str; 23] = [
    "builtin_interfaces/msg/Time",
    "diagnostic_msgs/msg/DiagnosticArray",
    "ellipsoid_slam/msg/EllipsoidMeasurementArray",
    "ellipsoid_slam/msg/ObjectArray",
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/TransformStamped",
    "lifecycle_msgs/msg/TransitionEvent",
    "nav_msgs/msg/OccupancyGrid",
    "nav_msgs/msg/Odometry",
    "nav_msgs/msg/Path",
    "rcl_interfaces/msg/Log",
    "rosgraph_msgs/msg/Clock",
    "rtabmap_msgs/msg/LandmarkDetections",
    "sensor_msgs/msg/CameraInfo",
    "sensor_msgs/msg/CompressedImage",
    "sensor_msgs/msg/Image",
    "std_msgs/msg/Header",
    "tf2_msgs/msg/TFMessage",
    "vision_msgs/msg/Detection2DArray",
    "vision_msgs/msg/Detection3DArray",
    "visualization_msgs/msg/Marker",
    "visualization_msgs/msg/MarkerArray",
    "yolo_msgs/msg/DetectionArray",
];
const SERVICES: [&str; 20] = [
    "ellipsoid_slam/srv/AddObject",
    "ellipsoid_slam/srv/ApproachObject",
    "ellipsoid_slam/srv/DeleteObject",
    "ellipsoid_slam/srv/LoadMap",
    "ellipsoid_slam/srv/LockObject",
    "ellipsoid_slam/srv/QueryObjects",
    "ellipsoid_slam/srv/RenameObject",
    "ellipsoid_slam/srv/SaveMap",
    "lifecycle_msgs/srv/ChangeState",
    "lifecycle_msgs/srv/GetAvailableStates",
    "lifecycle_msgs/srv/GetAvailableTransitions",
    "lifecycle_msgs/srv/GetState",
    "rcl_interfaces/srv/DescribeParameters",
    "rcl_interfaces/srv/GetParameters",
    "rcl_interfaces/srv/GetParameterTypes",
    "rcl_interfaces/srv/ListParameters",
    "rcl_interfaces/srv/SetParameters",
    "rcl_interfaces/srv/SetParametersAtomically",
    "std_srvs/srv/SetBool",
    "std_srvs/srv/Trigger",
];
