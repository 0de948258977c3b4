//! Another vendor's DDS sends what a robot sends, and receives the map.

use crate::processes::{BAG, BAG_TOPICS, Stage, succeeded};

#[test]
fn cyclone_dds_sends_a_robot_s_topics_and_receives_objects_and_transforms() {
    let stage = Stage::new();
    // Odometry comes by TF alone, and the time by /clock.
    let mut args: Vec<&str> = BAG_TOPICS[..12].to_vec();
    args.extend(["-p", "topics.odometry:=''", "-p", "use_sim_time:=true"]);
    args.extend(["-p", "qos.depth:=reliable", "-p", "qos.detections:=reliable"]);
    let node = stage.node(&args);
    node.wait_for("runs in domain");
    let peer = stage.peer("cyclone_peer.py", &[BAG]).output().unwrap();
    succeeded(&peer, &node);
}
