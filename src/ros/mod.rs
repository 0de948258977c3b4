//! ROS 2, live: topics in, the core, topics out. An adapter: it converts, calls and publishes.
//!
//! One thread perceives (`perceiver.rs`), another owns the map (`worker.rs`): what takes long, as closing a loop or
//! recognising a place, delays the map and never perception. Everything else runs on one asynchronous thread:
//! subscriptions put what they receive into an inbox, which drops the oldest depth image when it is full; timers
//! broadcast `map → odom` and diagnostics; what services ask for comes before images that wait.
//!
//! ros2-client's spinner is not used: it answers parameter services without descriptions and ranges, and what it
//! would tell of publishers is in discovery's own tables (`discovery.rs`).

mod broadcast;
mod clock;
mod color;
mod detecting;
mod diagnostics;
mod discovery;
mod domain;
mod finding;
mod inbox;
mod initial_pose;
mod jobs;
pub mod lifecycle;
mod log_form;
mod managed;
mod names;
mod node;
mod object_services;
mod outputs;
mod parameters;
mod perceiver;
mod player;
mod problems;
mod progress;
mod qos;
mod remaps;
mod rosout;
mod services;
mod status;
mod subscriptions;
mod topic;
mod transport;
mod worker;

pub use domain::{Domain, DomainError, Middleware};
pub use log_form::{LogForm, is_colored};
pub use node::{NodeError, NotCreated, run_node};
pub use player::{PlayError, Player};
pub use remaps::{UnmatchedRemap, check_remaps};
pub use rosout::{LogLayer, LogLines, log_lines};
pub use worker::{LoadMap, MapFiles, SaveMaps};
