//! The program as its users run it: commands, exit codes, files.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod arguments;
mod bad_input;
mod completions;
mod configuration;
mod demo_bag;
mod disk;
mod evo;
mod environment;
mod export;
mod gtsam;
mod in_space;
mod interruption;
mod kill;
mod python;
mod replay;
mod report;
mod robots;
mod second_visit;
#[path = "../input/sqlite.rs"]
mod sqlite;
mod storages;
mod sparse_maps;
mod run;
mod what_is_what;
