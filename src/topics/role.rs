//! What topics are for.

use crate::msg::{
    Message,
    nav_msgs::Odometry,
    sensor_msgs::{CameraInfo, CompressedImage, Image},
    vision_msgs::{Detection2DArray, Detection3DArray},
    yolo_msgs::DetectionArray,
};
use serde::Serialize;
use std::fmt;

/// What a topic can be used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Colour images.
    Rgb,
    /// Depth images.
    Depth,
    /// Calibration of the colour camera.
    CameraInfo,
    /// Calibration of the depth camera, where it is another one.
    DepthCameraInfo,
    /// Odometry.
    Odometry,
    /// 2D boxes.
    Detections,
    /// Objects that a detector measured in space, in place of depth and boxes.
    Detections3d,
}

impl Role {
    /// All roles.
    pub const ALL: &'static [Self] = &[
        Self::Rgb,
        Self::Depth,
        Self::CameraInfo,
        Self::DepthCameraInfo,
        Self::Odometry,
        Self::Detections,
        Self::Detections3d,
    ];

    /// The name on the command line, and in the section `topics` of a parameter file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rgb => "rgb",
            Self::Depth => "depth",
            Self::CameraInfo => "camera_info",
            Self::DepthCameraInfo => "depth_camera_info",
            Self::Odometry => "odometry",
            Self::Detections => "detections",
            Self::Detections3d => "detections_3d",
        }
    }

    /// The name of the node's topic in ROS 2, which a remapping changes.
    pub fn ros_name(self) -> &'static str {
        match self {
            Self::Rgb => "rgb/image",
            Self::Depth => "depth/image",
            Self::CameraInfo => "rgb/camera_info",
            Self::DepthCameraInfo => "depth/camera_info",
            Self::Odometry => "odom",
            Self::Detections => "detections",
            Self::Detections3d => "detections_3d",
        }
    }

    /// Message types that fit.
    pub fn types(self) -> &'static [&'static str] {
        match self {
            Self::Rgb | Self::Depth => &[Image::TYPE, CompressedImage::TYPE],
            Self::CameraInfo | Self::DepthCameraInfo => &[CameraInfo::TYPE],
            Self::Odometry => &[Odometry::TYPE],
            Self::Detections => &[Detection2DArray::TYPE, DetectionArray::TYPE],
            Self::Detections3d => &[Detection3DArray::TYPE, DetectionArray::TYPE],
        }
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
