//! What is measured, against numbers worked out by hand, through the public API and the command line.
#![expect(clippy::unwrap_used, reason = "a test ends where something is not as it should be")]

mod calibration;
mod commands;
mod errors;
mod experiment;
mod id_switches;
mod intervals;
mod maps;
mod matching;
mod trajectories;
mod truths;
