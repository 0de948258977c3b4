//! Object-level SLAM for indoor robots: from RGB-D frames, 2D boxes and odometry to a map of ellipsoids.
//!
//! The map of the house, in reading order. Every layer uses only layers above it; a test holds this.

pub mod time;

pub mod geometry;

pub mod perception;

pub mod graph;

pub mod mapping;

pub mod pipeline;

pub mod config;

pub mod msg;

pub mod topics;

#[cfg(feature = "detector")]
pub mod detector;

pub mod publication;

pub mod report;

pub mod io;

#[cfg(feature = "ros")]
pub mod ros;

pub mod sim;

pub mod eval;

pub mod cli;
