//! A detector that draws hundreds of boxes: the node is behind, and still answers and ends.

use crate::processes::{BAG, BAG_TOPICS, Stage, now, succeeded};
use ellipsoid_slam::{
    io::{BagReader, BagWriter, load_saved_map},
    msg::{cdr, vision_msgs::Detection2DArray},
};
use std::{path::Path, time::Duration};

/// Boxes an image.
const BOXES: usize = 400;

#[test]
fn a_node_that_is_behind_answers_at_once_and_saves_its_map_when_it_is_stopped() {
    let stage = Stage::new();
    let bag = stage.path("crowd.mcap");
    crowded(Path::new(&bag));
    let map = stage.path("map.json");
    let file = format!("map.file:={map}");
    let crowd = ["-p", &file, "-p", "map.save_on_shutdown:=true"];
    let mut node = stage.node(&[&BAG_TOPICS[..], &crowd].concat());
    node.wait_for("runs in domain");
    let play = stage.program(&["play", &bag, "--loop", "--rate", "5", "--wait", "60"]);
    let _player = stage.start(play, "player");
    let peer = stage.peer("cyclone_query_times.py", &[]).output().unwrap();
    println!("{}", succeeded(&peer, &node));
    let asked = now();
    assert!(node.stop("TERM").success(), "{}", node.log());
    let took = asked.elapsed();
    println!("stopped and saved in {took:.2?}");
    assert!(took < Duration::from_secs(2), "{took:?}\n{}", node.log());
    assert!(load_saved_map(Path::new(&map)).unwrap().objects.len() >= 3, "{}", node.log());
}

/// The demo bag with many boxes where it has few: each again and again, a little displaced.
fn crowded(path: &Path) {
    let bag = BagReader::open(Path::new(BAG)).unwrap();
    let mut crowd = BagWriter::create(path).unwrap();
    crowd.latch("/tf_static".into());
    for message in bag.messages() {
        if &*message.type_name != "vision_msgs/msg/Detection2DArray" {
            crowd
                .write_raw(&message.topic, &message.type_name, &message.data, message.log_time)
                .unwrap();
            continue;
        }
        let mut array: Detection2DArray = cdr::decode(&message.data).unwrap();
        let boxes = array.detections.clone();
        for copy in 0..BOXES.saturating_sub(boxes.len()) {
            let Some(mut another) = boxes.get(copy % boxes.len().max(1)).cloned() else { continue };
            another.bbox.center.position.x += (copy as f64 * 0.7).sin() * 40.0;
            another.bbox.center.position.y += (copy as f64 * 1.1).cos() * 30.0;
            array.detections.push(another);
        }
        crowd.write(&message.topic, &array, message.log_time).unwrap();
    }
    crowd.finish().unwrap();
}
