//! A 2D detector: an ONNX model finds boxes in colour images, and masks where it segments.
//!
//! Weights are not part of the project: `docs/detectors.md` says which model to take. What a network gives is of one of
//! a few forms ([`ModelForm`](crate::config::ModelForm)), and its form says how an image is fitted into its input, too.

mod labels;
mod letterbox;
mod model;
mod output;
mod prototypes;
mod suppression;

pub use labels::{LabelError, Labels};
pub use model::{Detector, ModelError};
