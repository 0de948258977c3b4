//! Bags in, the core's inputs out: encodings, damage, roles and bad input, through the public API.
#![expect(clippy::unwrap_used, reason = "a test ends where something is not as it should be")]

mod bags;
mod cameras;
mod cdr;
mod choice;
mod color;
mod damage;
mod definitions;
mod depth;
mod detections;
#[cfg(feature = "detector")]
mod detector;
mod fixtures;
mod fuzz;
mod generations;
mod in_space;
mod inspect;
#[cfg(feature = "detector")]
mod instance_masks;
mod mutants;
#[cfg(feature = "detector")]
mod onnx;
mod poses;
mod publication;
mod replay;
mod robot;
mod roles;
mod sqlite;
