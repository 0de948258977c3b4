//! Where the camera is on its base, for robots whose TF does not say.

use super::start_pose::numbers;
use crate::geometry::Pose;
use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};
use thiserror::Error;

/// Where the camera is on the robot's base: x, y, z (m), then roll, pitch, yaw (deg) of its body, x forward, y left, z up,
/// about the base's fixed axes in this order, as `static_transform_publisher` has them. All angles zero: it looks where the
/// base does; a positive pitch looks lower. As text `X,Y,Z,ROLL,PITCH,YAW`, or nothing where TF says it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct CameraPose {
    known: Option<[f64; 6]>,
}

/// Text that is no such pose.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("expected six numbers X,Y,Z,ROLL,PITCH,YAW of the camera on the base: metres and degrees")]
pub struct NoCameraPose;

impl CameraPose {
    /// Pose of the optical frame (x right, y down, z forward) on the base, if it is known.
    pub fn base_from_camera(&self) -> Option<Pose> {
        let [x, y, z, roll, pitch, yaw] = self.known?;
        let [roll, pitch, yaw] = [roll, pitch, yaw].map(f64::to_radians);
        let body = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        let optical = UnitQuaternion::from_quaternion(Quaternion::new(0.5, -0.5, 0.5, -0.5));
        Some(Pose::from_parts(Translation3::new(x, y, z), body * optical))
    }
}

impl FromStr for CameraPose {
    type Err = NoCameraPose;

    fn from_str(text: &str) -> Result<Self, NoCameraPose> {
        Ok(Self { known: numbers(text).ok_or(NoCameraPose)? })
    }
}

impl fmt::Display for CameraPose {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let texts = self.known.map(|known| known.map(|number| number.to_string()).join(","));
        f.write_str(&texts.unwrap_or_default())
    }
}

impl From<CameraPose> for String {
    fn from(pose: CameraPose) -> Self {
        pose.to_string()
    }
}

impl TryFrom<String> for CameraPose {
    type Error = NoCameraPose;

    fn try_from(text: String) -> Result<Self, NoCameraPose> {
        text.parse()
    }
}
