//! Where a robot starts in a map that it continues.

use crate::geometry::Pose;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};
use thiserror::Error;

/// About where the base starts in a saved map, on its ground: x and y (m), yaw (deg). As text `X,Y,YAW`, or nothing where
/// that is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct StartPose {
    known: Option<[f64; 3]>,
}

/// Text that is no such pose.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("expected three numbers X,Y,YAW: metres, metres, degrees")]
pub struct NoStartPose;

impl StartPose {
    /// `map_from_base`, if it is known.
    pub fn map_from_base(&self) -> Option<Pose> {
        let [x, y, yaw_deg] = self.known?;
        Some(Pose::new(Vector3::new(x, y, 0.0), Vector3::z() * yaw_deg.to_radians()))
    }
}

impl FromStr for StartPose {
    type Err = NoStartPose;

    fn from_str(text: &str) -> Result<Self, NoStartPose> {
        Ok(Self { known: numbers(text).ok_or(NoStartPose)? })
    }
}

/// So many finite numbers with commas between them, or none of them in an empty text. Nothing for any other text.
pub(super) fn numbers<const N: usize>(text: &str) -> Option<Option<[f64; N]>> {
    if text.trim().is_empty() {
        return Some(None);
    }
    let parts: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let numbers: [f64; N] = parts.ok()?.try_into().ok()?;
    numbers.iter().all(|number| number.is_finite()).then_some(Some(numbers))
}

impl fmt::Display for StartPose {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.known {
            Some([x, y, yaw_deg]) => write!(f, "{x},{y},{yaw_deg}"),
            None => Ok(()),
        }
    }
}

impl From<StartPose> for String {
    fn from(pose: StartPose) -> Self {
        pose.to_string()
    }
}

impl TryFrom<String> for StartPose {
    type Error = NoStartPose;

    fn try_from(text: String) -> Result<Self, NoStartPose> {
        text.parse()
    }
}
