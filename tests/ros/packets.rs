//! No packet ends the node, or takes its memory: neither what claims to be much, nor noise.

use crate::{
    mutants::{Mutants, cases},
    processes::{BAG, BAG_TOPICS, Running, Stage, now, succeeded},
    rtps::{Message, PARTICIPANTS, PUBLICATIONS, Prefix, SUBSCRIPTIONS, endpoint, participant},
};
use std::{net::UdpSocket, thread, time::Duration};

/// A peer that everybody would take for one.
const PEER: Prefix = [1, 16, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7];
const WRITER: [u8; 4] = [0, 0, 9, 3];
const MOST_MEMORY_MB: f64 = 120.0;
/// Faster, and the system itself would drop most.
const PACKETS_PER_MS: u64 = 12;

#[test]
fn packets_that_claim_much_and_random_ones_leave_the_node_and_its_objects_as_they_are() {
    let stage = Stage::new();
    let maps = format!("map.directory:={}", stage.path(""));
    let node = stage
        .node(&[&BAG_TOPICS[..], &["-p", &maps, "-p", "publish.object_frames:=true"]].concat());
    node.wait_for("runs in domain");
    succeeded(
        &stage.program(&["play", BAG, "--rate", "4", "--wait", "60"]).output().unwrap(),
        &node,
    );

    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let ports = [7410, 7411].map(|port| port + 250 * stage.domain());
    let send = |packet: &[u8]| {
        for port in ports {
            let _ = socket.send_to(packet, ("127.0.0.1", port));
        }
    };
    let acquaintance = introductions(PEER);
    for _ in 0..3 {
        acquaintance.iter().for_each(|packet| send(packet));
        thread::sleep(Duration::from_millis(300));
    }
    let claims = claims(PEER);
    for claim in &claims {
        send(claim);
        thread::sleep(Duration::from_millis(20));
    }
    memory_is_bounded(&node, "claims");

    let seeds = [acquaintance, claims].concat();
    let mut mutants = Mutants::of(&seeds);
    let started = now();
    for sent in 0..cases(100_000) {
        let mut packet = mutants.next();
        if mutants.any(3) == 0 && packet.len() >= 20 {
            // From anybody.
            packet[8..20].fill_with(|| mutants.any(256) as u8);
        }
        send(&packet);
        if sent % PACKETS_PER_MS == 0 {
            thread::sleep(Duration::from_millis(1));
        }
    }
    println!("{} packets in {:.1} s", cases(100_000), started.elapsed().as_secs_f64());
    memory_is_bounded(&node, "random packets");

    let map = stage.path("map.json");
    let peer = stage.peer("cyclone_services.py", &[&map]).output().unwrap();
    succeeded(&peer, &node);
    memory_is_bounded(&node, "services");
    assert!(!node.log().contains("panicked"), "{}", node.log());
}

fn memory_is_bounded(node: &Running, after: &str) {
    let peak = node.peak_memory_mb();
    println!("{peak:.0} MB at the peak after {after}");
    assert!(peak < MOST_MEMORY_MB, "{peak:.0} MB after {after}:\n{}", node.log());
}

/// A participant that publishes what a service and a subscription of the node listen to, and subscribes to its markers.
fn introductions(prefix: Prefix) -> Vec<Vec<u8>> {
    let request = [
        "rq/ellipsoid_slam/query_objectsRequest",
        "ellipsoid_slam::srv::dds_::QueryObjects_Request_",
    ];
    let detections = ["rt/detections", "vision_msgs::msg::dds_::Detection2DArray_"];
    let markers = ["rt/ellipsoid_slam/markers", "visualization_msgs::msg::dds_::MarkerArray_"];
    let said = [
        (PARTICIPANTS, 1, participant(prefix)),
        (PUBLICATIONS, 1, endpoint(prefix, WRITER, request)),
        (PUBLICATIONS, 2, endpoint(prefix, [0, 0, 10, 3], detections)),
        (SUBSCRIPTIONS, 1, endpoint(prefix, [0, 0, 11, 4], markers)),
    ];
    said.map(|(ends, number, payload)| Message::from(prefix).data(ends, number, &payload).bytes())
        .to_vec()
}

/// What a few bytes can claim.
fn claims(prefix: Prefix) -> Vec<Vec<u8>> {
    let message = || Message::from(prefix);
    let many = i64::from(i32::MAX);
    let mut claims = vec![message().reply_to(u32::MAX)];
    for (count, last) in [(1, many), (2, i64::MAX - 1), (3, i64::MAX)] {
        claims.push(message().heartbeat(PUBLICATIONS, [1, last], count));
        claims.push(message().heartbeat(SUBSCRIPTIONS, [last, i64::MAX], count));
        claims.push(message().gap(PUBLICATIONS, [last / 2, last]));
        claims.push(message().ack_nack(PUBLICATIONS, last, count));
    }
    for (at, size) in [u32::MAX, i32::MAX as u32, 1 << 26, 1 << 20].into_iter().enumerate() {
        for number in 1..300 {
            let fragment = if number % 2 == 0 { 1 } else { 60_000 };
            claims.push(message().last_fragment(PUBLICATIONS, number, [size, fragment]));
        }
        let fragments = [0, 1, u32::MAX - 1, u32::MAX];
        claims.push(message().nack_frag(PUBLICATIONS, 1 + at as i64, fragments[at], at as i32));
        // Which of the fragments are missing is asked for.
        claims.push(message().heartbeat(PUBLICATIONS, [1, 300], 10 + at as i32));
    }
    claims.into_iter().map(Message::bytes).collect()
}
