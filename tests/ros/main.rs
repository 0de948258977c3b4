//! The live node against real peers: ROS 2's own rclpy on Fast DDS, and Cyclone DDS.
//!
//! Every test has a domain of its own and stays on the loopback interface. With the feature `zenoh`, also against Zenoh's
//! own Python package, which speaks as `rmw_zenoh` does.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on shall say where")]

mod cyclone;
#[path = "../command/environment.rs"]
mod environment;
mod fast_dds;
mod faults;
mod finding;
mod lifecycle;
mod load;
#[path = "../input/mutants.rs"]
mod mutants;
#[cfg(feature = "detector")]
#[path = "../input/onnx.rs"]
#[expect(dead_code, reason = "tests of the detector alone need more of it")]
mod onnx;
mod packets;
mod processes;
mod rtps;
mod services;
#[cfg(feature = "zenoh")]
mod zenoh;
