//! The ROS package `sensor_msgs`.

use crate::msg::{Message, std_msgs::Header};
use serde::{Deserialize, Serialize};

/// An uncompressed image.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Image {
    /// Stamp and frame.
    pub header: Header,
    /// Rows.
    pub height: u32,
    /// Columns.
    pub width: u32,
    /// Meaning of the pixels, such as `rgb8` or `16UC1`.
    pub encoding: String,
    /// Not zero if the high byte of a pixel comes first.
    pub is_bigendian: u8,
    /// Bytes from one row to the next.
    pub step: u32,
    /// The bytes.
    #[serde(with = "serde_bytes")]
    pub data: Vec<u8>,
}

impl Message for Image {
    const TYPE: &'static str = "sensor_msgs/msg/Image";
}

/// An image as a JPEG, PNG or `compressedDepth` file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CompressedImage {
    /// Stamp and frame.
    pub header: Header,
    /// How the data is compressed, in words.
    pub format: String,
    /// The bytes.
    #[serde(with = "serde_bytes")]
    pub data: Vec<u8>,
}

impl Message for CompressedImage {
    const TYPE: &'static str = "sensor_msgs/msg/CompressedImage";
}

/// The part of the sensor that was read out, in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RegionOfInterest {
    /// First column.
    pub x_offset: u32,
    /// First row.
    pub y_offset: u32,
    /// Rows.
    pub height: u32,
    /// Columns.
    pub width: u32,
    /// Whether the region is to be rectified.
    pub do_rectify: bool,
}

impl Message for RegionOfInterest {
    const TYPE: &'static str = "sensor_msgs/msg/RegionOfInterest";
}

/// Calibration of a camera.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CameraInfo {
    /// Stamp and frame.
    pub header: Header,
    /// Rows.
    pub height: u32,
    /// Columns.
    pub width: u32,
    /// Name of the distortion model.
    pub distortion_model: String,
    /// Distortion coefficients.
    pub d: Vec<f64>,
    /// Intrinsic matrix of the raw image, row-major.
    pub k: [f64; 9],
    /// Rectification rotation, row-major.
    pub r: [f64; 9],
    /// Projection matrix of the rectified image, row-major 3x4.
    pub p: [f64; 12],
    /// Sensor columns a pixel; 0 means 1.
    pub binning_x: u32,
    /// Sensor rows a pixel; 0 means 1.
    pub binning_y: u32,
    /// The part of the sensor that was read out; all zero means all.
    pub roi: RegionOfInterest,
}

impl Message for CameraInfo {
    const TYPE: &'static str = "sensor_msgs/msg/CameraInfo";
}

/// A value that a point of a cloud has.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PointField {
    /// Its name, such as `x` or `rgb`.
    pub name: String,
    /// Bytes from the point's first one.
    pub offset: u32,
    /// Type of number: 7 for 32-bit floating point.
    pub datatype: u8,
    /// How many numbers.
    pub count: u32,
}

impl Message for PointField {
    const TYPE: &'static str = "sensor_msgs/msg/PointField";
}

/// Points with further values.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PointCloud2 {
    /// Stamp and frame.
    pub header: Header,
    /// Rows; 1 where points have no order.
    pub height: u32,
    /// Points of a row.
    pub width: u32,
    /// What a point has.
    pub fields: Vec<PointField>,
    /// Whether the high byte of a number comes first.
    pub is_bigendian: bool,
    /// Bytes of a point.
    pub point_step: u32,
    /// Bytes of a row.
    pub row_step: u32,
    /// The bytes.
    #[serde(with = "serde_bytes")]
    pub data: Vec<u8>,
    /// Whether all points are finite.
    pub is_dense: bool,
}

impl Message for PointCloud2 {
    const TYPE: &'static str = "sensor_msgs/msg/PointCloud2";
}
