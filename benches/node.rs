//! The node under a robot's load: 640x480 colour and depth at 30 Hz, five boxes at 10 Hz, on the machine of its publisher.
//!
//! Prints how many keyframes were lost, the time from publishing boxes to receiving the markers they changed, and
//! the node's memory. `cargo bench --bench node -- --seconds 60`.

use anyhow::{Context as _, Result, ensure};
use ellipsoid_slam::{
    io::{BagReader, RawMessage},
    msg::{Message, cdr, vision_msgs::Detection2DArray, visualization_msgs::MarkerArray},
    ros::{Domain, Middleware, Player},
    time::Stamp,
};
use ros2_client::{
    MessageTypeName, Name, NodeName, NodeOptions, QosProfile,
    dds::{Context, Subscription, rustdds::DomainParticipantBuilder},
    qos::{History, WhenFull},
};
use std::{
    collections::BTreeMap,
    env, fs,
    path::Path,
    process::{Child, Command},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc,
    },
    thread,
    time::{Duration, Instant},
};

/// Frames of the scene; they are shown forwards and backwards, so that the camera moves evenly.
const FRAMES: usize = 60;
const RATE_HZ: f64 = 30.0;
/// Boxes come for every third image, this long after it (s).
const BOXES_EVERY: usize = 3;
const BOXES_LATE_FRAMES: usize = 2;
const MOST_BOXES: usize = 5;
const DOMAIN: u16 = 98;
const DEPTH: &str = "/camera/aligned_depth_to_color/image_raw";
const DETECTIONS: &str = "/detections";

fn main() -> Result<()> {
    let seconds = argument("--seconds")?.unwrap_or(60.0);
    let folder = tempfile::tempdir()?;
    let bag = folder.path().join("load.mcap");
    simulate(&bag)?;
    let frames = Frames::read(&bag)?;
    let (told, received) = mpsc::channel();
    let stop = Arc::new(AtomicBool::new(false));
    let stopped = Arc::clone(&stop);
    let listener = thread::spawn(move || listen(&told, &stopped));
    let mut node = Node::start()?;
    let topics = frames.topics.iter().map(|(topic, kind)| (topic.as_str(), kind.as_str()));
    let domain = Domain { id: DOMAIN, local_only: true, middleware: Middleware::Dds };
    let player = Player::new(domain, topics, false)?;
    ensure!(player.wait_for_listeners(Duration::from_secs(60)) >= 4, "the node does not listen");
    let load = publish(&frames, &player, seconds, &node)?;
    thread::sleep(Duration::from_secs(3));
    node.stop()?;
    drop(player);
    let markers: BTreeMap<Stamp, Instant> = received.try_iter().collect();
    report(&load, &markers);
    stop.store(true, Ordering::Relaxed);
    listener.join().map_err(|_| anyhow::anyhow!("the listener panicked"))?
}

fn argument(name: &str) -> Result<Option<f64>> {
    let mut arguments = env::args().skip_while(|argument| argument != name).skip(1);
    arguments.next().map(|text| text.parse().with_context(|| format!("{name} {text}"))).transpose()
}

fn simulate(bag: &Path) -> Result<()> {
    let frames = FRAMES.to_string();
    let arguments = ["--scene", "desk", "--trajectory", "orbit", "--frames", &frames, "--raw"];
    let status = Command::new(env!("CARGO_BIN_EXE_ellipsoid_slam"))
        .args(["simulate", "--perfect", "--seed", "1"])
        .args(arguments)
        .arg("--output")
        .arg(bag)
        .status()?;
    ensure!(status.success(), "simulate failed");
    Ok(())
}

/// The messages of each frame.
struct Frames {
    topics: BTreeMap<String, String>,
    fixed: Vec<RawMessage>,
    frames: Vec<Vec<RawMessage>>,
}

impl Frames {
    fn read(bag: &Path) -> Result<Self> {
        let bag = BagReader::open(bag)?;
        let used = |name: &str| !name.starts_with("/ground_truth") && name != "/tf";
        let topics = bag.topics().iter().filter(|topic| used(&topic.name));
        let topics = topics.map(|topic| (topic.name.clone(), topic.type_name.clone())).collect();
        let (mut fixed, mut by_stamp) = (Vec::new(), BTreeMap::<Stamp, Vec<RawMessage>>::new());
        for mut message in bag.messages().filter(|message| used(&message.topic)) {
            if &*message.topic == DETECTIONS {
                let mut boxes: Detection2DArray = cdr::decode(&message.data)?;
                boxes.detections.truncate(MOST_BOXES);
                message.data = cdr::encode(&boxes)?;
            }
            if &*message.topic == "/tf_static" {
                fixed.push(message);
            } else {
                by_stamp.entry(stamp_of(&message.data)).or_default().push(message);
            }
        }
        let whole = |messages: &Vec<RawMessage>| messages.iter().any(|m| &*m.topic == DEPTH);
        let frames: Vec<_> = by_stamp.into_values().filter(whole).collect();
        ensure!(frames.len() == FRAMES, "{} frames in the bag", frames.len());
        Ok(Self { topics, fixed, frames })
    }

    /// The frame that is shown as the `i`th.
    fn shown(&self, i: usize) -> &[RawMessage] {
        let period = 2 * (FRAMES - 1);
        let at = i % period;
        &self.frames[if at < FRAMES { at } else { period - at }]
    }
}

/// Stamp of a message that begins with a header, after the four bytes that name the encoding.
fn stamp_of(cdr: &[u8]) -> Stamp {
    let word = |at: usize| cdr.get(at..at + 4).and_then(|b| b.try_into().ok()).unwrap_or_default();
    let (sec, nanosec) = (i32::from_le_bytes(word(4)), u32::from_le_bytes(word(8)));
    Stamp::from_nanos(i64::from(sec) * 1_000_000_000 + i64::from(nanosec))
}

fn stamped(message: &RawMessage, stamp: Stamp) -> Vec<u8> {
    let mut cdr = message.data.clone();
    let nanos = stamp.as_nanos();
    if let Some(header) = cdr.get_mut(4..12) {
        header[..4].copy_from_slice(&((nanos / 1_000_000_000) as i32).to_le_bytes());
        header[4..].copy_from_slice(&((nanos % 1_000_000_000) as u32).to_le_bytes());
    }
    cdr
}

/// What was published, and what it cost.
struct Load {
    /// When boxes with this stamp were published.
    boxes: BTreeMap<Stamp, Instant>,
    images: usize,
    memory_mb: Vec<f64>,
}

fn publish(frames: &Frames, player: &Player, seconds: f64, node: &Node) -> Result<Load> {
    let mut load = Load { boxes: BTreeMap::new(), images: 0, memory_mb: Vec::new() };
    for message in &frames.fixed {
        player.publish(&message.topic, &message.data)?;
    }
    let started = now();
    for i in 0..(seconds * RATE_HZ) as usize {
        let due = Duration::from_secs_f64(i as f64 / RATE_HZ);
        thread::sleep(due.saturating_sub(started.elapsed()));
        let stamp = |i: usize| Stamp::from_secs(1000.0).shifted(i as f64 / RATE_HZ);
        for message in frames.shown(i).iter().filter(|m| &*m.topic != DETECTIONS) {
            player.publish(&message.topic, &stamped(message, stamp(i)))?;
        }
        load.images += 1;
        let Some(seen) = i.checked_sub(BOXES_LATE_FRAMES).filter(|i| i % BOXES_EVERY == 0) else {
            continue;
        };
        for message in frames.shown(seen).iter().filter(|m| &*m.topic == DETECTIONS) {
            load.boxes.insert(stamp(seen), now());
            player.publish(&message.topic, &stamped(message, stamp(seen)))?;
        }
        if i % (RATE_HZ as usize * 5) == BOXES_LATE_FRAMES {
            load.memory_mb.push(node.memory_mb()?);
        }
    }
    Ok(load)
}

/// The node as a process of its own.
struct Node(Child);

impl Node {
    fn start() -> Result<Self> {
        let set = |name: &str, value: &str| ["-p".to_owned(), format!("{name}:={value}")];
        let parameters = [
            set("topics.depth", DEPTH),
            set("topics.rgb", "/camera/color/image_raw"),
            set("topics.camera_info", "/camera/color/camera_info"),
            set("topics.odometry", "/odom"),
            set("topics.detections", "/detections"),
            set("topics.depth_camera_info", "''"),
        ];
        let child = Command::new(env!("CARGO_BIN_EXE_ellipsoid_slam"))
            .args(["node", "--ros-args"])
            .args(parameters.as_flattened())
            .env("ROS_DOMAIN_ID", DOMAIN.to_string())
            .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
            .spawn()?;
        Ok(Self(child))
    }

    fn memory_mb(&self) -> Result<f64> {
        let status = fs::read_to_string(format!("/proc/{}/status", self.0.id()))?;
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        let kilobytes = line.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
        Ok(kilobytes.context("the system does not say how much memory the node has")? / 1024.0)
    }

    fn stop(&mut self) -> Result<()> {
        Command::new("kill").args(["-TERM", &self.0.id().to_string()]).status()?;
        ensure!(self.0.wait()?.success(), "the node failed");
        Ok(())
    }
}

impl Drop for Node {
    fn drop(&mut self) {
        // Fails after `stop`, when it has ended already.
        let _ = self.0.kill();
    }
}

/// Tells the stamp of each array of markers and when it came, until it is stopped.
fn listen(told: &mpsc::Sender<(Stamp, Instant)>, stop: &AtomicBool) -> Result<()> {
    let participant = DomainParticipantBuilder::new(DOMAIN)
        .with_only_networks([std::net::Ipv4Addr::LOCALHOST])
        .build()
        .map_err(|e| anyhow::anyhow!("{e}"))?;
    let context = Context::from_domain_participant(participant)?;
    let options = NodeOptions::new().start_parameter_services(false);
    let mut node = context.new_node(NodeName::new("/", "listener")?, options)?;
    let qos = QosProfile::subscription_default()
        .reliability_reliable(WhenFull::DEFAULT)
        .history(History::KeepLast { depth: 100 });
    let kind = MessageTypeName::new("visualization_msgs", "MarkerArray");
    ensure!(MarkerArray::TYPE.ends_with(kind.type_name()));
    let topic = node.create_topic(&Name::new("/ellipsoid_slam", "markers")?, kind, &qos)?;
    let markers: Subscription<MarkerArray> = node.create_subscription(&topic, Some(qos))?;
    while !stop.load(Ordering::Relaxed) {
        while let Some((array, _)) = markers.take()? {
            let Some(first) = array.markers.first() else { continue };
            told.send((first.header.stamp.into(), now()))?;
        }
        thread::sleep(Duration::from_micros(500));
    }
    Ok(())
}

fn report(load: &Load, markers: &BTreeMap<Stamp, Instant>) {
    // The first keyframes have no confirmed objects yet, and so no markers.
    let first = markers.keys().next().copied();
    let expected = load.boxes.iter().filter(|(stamp, _)| first.is_some_and(|f| **stamp >= f));
    let mut latencies: Vec<f64> = Vec::new();
    let mut lost = 0;
    for (stamp, published) in expected {
        match markers.get(stamp) {
            Some(received) => latencies.push((*received - *published).as_secs_f64() * 1e3),
            None => lost += 1,
        }
    }
    latencies.sort_by(f64::total_cmp);
    let at = |share: f64| latencies[((latencies.len() - 1) as f64 * share).round() as usize];
    println!("{} images, {} sets of up to {MOST_BOXES} boxes", load.images, load.boxes.len());
    println!("{lost} of {} keyframes without markers", lost + latencies.len());
    if !latencies.is_empty() {
        let [p50, p99, max] = [0.5, 0.99, 1.0].map(at);
        println!("boxes to markers: p50 {p50:.1} ms, p99 {p99:.1} ms, longest {max:.1} ms");
    }
    let memory: Vec<String> = load.memory_mb.iter().map(|mb| format!("{mb:.1}")).collect();
    println!("memory every 5 s [MB]: {}", memory.join(" "));
}

#[expect(clippy::disallowed_methods, reason = "a benchmark measures time")]
fn now() -> Instant {
    Instant::now()
}
