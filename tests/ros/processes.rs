//! The processes of a test: the node, a bag being played, peers in Python.

use crate::environment;
use std::{
    fs::{self, File},
    path::{Path, PathBuf},
    process::{Child, Command, ExitStatus, Output, Stdio},
    sync::atomic::{AtomicU16, Ordering},
    thread,
    time::{Duration, Instant},
};

pub(crate) const BAG: &str = "bags/desk.mcap";
/// The node's arguments for the topics of the demo bag.
pub(crate) const BAG_TOPICS: [&str; 14] = [
    "-p",
    "topics.detections:=/detections",
    "-p",
    "topics.depth_camera_info:=''",
    "-p",
    "topics.depth:=/camera/aligned_depth_to_color/image_raw",
    "-p",
    "topics.depth_transport:=compressedDepth",
    "-p",
    "topics.rgb:=/camera/color/image_raw",
    "-r",
    "rgb/camera_info:=/camera/color/camera_info",
    "-p",
    "topics.odometry:=/odom",
];
/// A machine that does other things takes its time.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);

/// A DDS domain that no other test uses, with a folder for files.
pub(crate) struct Stage {
    domain: String,
    pub(crate) folder: tempfile::TempDir,
}

/// A process that ends with the test.
pub(crate) struct Running {
    child: Child,
    log: PathBuf,
}

impl Stage {
    pub(crate) fn new() -> Self {
        // Ports of domains above 100 are those that the system gives to others.
        static NEXT: AtomicU16 = AtomicU16::new(0);
        let own = NEXT.fetch_add(1, Ordering::Relaxed);
        let domain = 1 + (std::process::id() as u16 % 12) * 8 + own % 8;
        Self { domain: domain.to_string(), folder: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().unwrap().to_owned()
    }

    /// The domain's number.
    pub(crate) fn domain(&self) -> u16 {
        self.domain.parse().unwrap()
    }

    /// The program, in this domain.
    pub(crate) fn program(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_ellipsoid_slam"));
        command.args(args);
        self.inside(&mut command);
        command
    }

    /// The node with ROS 2's arguments.
    pub(crate) fn node(&self, ros_args: &[&str]) -> Running {
        self.node_as("node", ros_args)
    }

    /// Another one, whose words go to a file of this name.
    pub(crate) fn node_as(&self, log: &str, ros_args: &[&str]) -> Running {
        let args = ["-v", "node", "--ros-args"].iter().chain(ros_args);
        self.start(self.program(&args.copied().collect::<Vec<_>>()), log)
    }

    /// A peer in Python.
    pub(crate) fn peer(&self, script: &str, args: &[&str]) -> Command {
        self.peer_with("tests/ros/requirements.txt", script, args)
    }

    /// A peer in Python with the packages of a file.
    pub(crate) fn peer_with(&self, requirements: &str, script: &str, args: &[&str]) -> Command {
        let python = environment::python(requirements).unwrap();
        let mut command = Command::new(python);
        command.arg(Path::new("tests/ros").join(script)).args(args);
        self.inside(&mut command);
        command
    }

    pub(crate) fn start(&self, mut command: Command, name: &str) -> Running {
        let log = self.folder.path().join(format!("{name}.log"));
        let file = File::create(&log).unwrap();
        let child = command.stdout(file.try_clone().unwrap()).stderr(file).spawn().unwrap();
        Running { child, log }
    }

    fn inside(&self, command: &mut Command) {
        command
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .env("ROS_DOMAIN_ID", &self.domain)
            .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
            .env("ROS_LOG_DIR", self.folder.path())
            .env("CYCLONEDDS_URI", CYCLONE_ON_LOOPBACK)
            .env_remove("RMW_IMPLEMENTATION")
            .env("NO_COLOR", "1")
            .stdin(Stdio::null());
    }
}

const CYCLONE_ON_LOOPBACK: &str = "<CycloneDDS><Domain><General><Interfaces>\
    <NetworkInterface name='lo' multicast='false'/></Interfaces></General>\
    <Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>11</MaxAutoParticipantIndex>\
    <Peers><Peer address='127.0.0.1'/></Peers></Discovery></Domain></CycloneDDS>";

#[expect(clippy::disallowed_methods, reason = "a test that waits has to know for how long")]
pub(crate) fn now() -> Instant {
    Instant::now()
}

impl Running {
    /// All it has said so far.
    pub(crate) fn log(&self) -> String {
        fs::read_to_string(&self.log).unwrap()
    }

    /// Waits until it has said this.
    pub(crate) fn wait_for(&self, words: &str) {
        let started = now();
        while !self.log().contains(words) {
            assert!(started.elapsed() < PATIENCE, "`{words}` did not come:\n{}", self.log());
            thread::sleep(Duration::from_millis(50));
        }
    }

    /// The most memory that it has had so far, as Linux counts it.
    pub(crate) fn peak_memory_mb(&self) -> f64 {
        let status = fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
        line.trim().trim_end_matches(" kB").parse::<f64>().unwrap() / 1024.0
    }

    /// Sends a signal by its name, and waits for the end.
    pub(crate) fn stop(&mut self, signal: &str) -> ExitStatus {
        let id = self.child.id().to_string();
        let sent = Command::new("kill").args([format!("-{signal}"), id]).status().unwrap();
        assert!(sent.success());
        self.wait()
    }

    pub(crate) fn wait(&mut self) -> ExitStatus {
        let started = now();
        loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status;
            }
            assert!(started.elapsed() < PATIENCE, "it does not end:\n{}", self.log());
            thread::sleep(Duration::from_millis(20));
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// What a process printed, if it succeeded.
pub(crate) fn succeeded(output: &Output, others: &Running) -> String {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(
        output.status.success(),
        "{}\n{}\nthe node said:\n{}",
        text(&output.stdout),
        text(&output.stderr),
        others.log()
    );
    text(&output.stdout)
}
