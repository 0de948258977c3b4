//! The core through its public interface: time, geometry, perception, graph, mapping, pipeline.
#![expect(clippy::unwrap_used, reason = "a test that cannot build its input has to stop")]

mod geometry;
mod graph;
mod mapping;
mod perception;
mod pipeline;
mod scene;
mod time;
