//! Object-level SLAM for indoor robots: from RGB-D frames, 2D boxes and odometry to a map of ellipsoids.
//!
//! The map of the house, in reading order.

pub mod time;

pub mod geometry;
pub mod perception;
pub mod pipeline;
pub mod sim;
