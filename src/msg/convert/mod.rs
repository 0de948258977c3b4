//! From wire types to the core's types and back.

mod camera;
mod color;
mod color_message;
mod compressed;
mod depth;
mod detections;
mod error;
mod image_topic;
mod in_space;
mod markers;
mod measurements;
mod objects;
mod points;
mod pose;
mod surface;

pub use camera::{camera, camera_info};
pub use color::{
    RgbImage, check_jpeg_head, color_image, color_image_message, compressed_color_image,
    compressed_color_message, jpeg, png,
};
pub use color_message::ColorMessage;
pub use compressed::{compressed_depth_message, png_depth};
pub use depth::{compressed_depth_image, depth_image, depth_image_message};
pub use detections::{
    FindBoxes, detection_array, detections, yolo_detection_array, yolo_detections,
};
pub use error::ConvertError;
pub use image_topic::{is_rectified, without_transport};
pub use in_space::{detection_3d_array, found_in_space, yolo_found_in_space};
pub use markers::{
    ObjectShapes, color_of, deletion_markers, measurement_markers, object_markers, outlined,
};
pub use measurements::{landmark_detections, measurement_array};
pub use objects::{boxes_3d, detections_3d, object_array, occupancy_grid, path};
pub use points::point_cloud;
pub use pose::{
    odometry, odometry_message, pose_covariance, pose_from_message, pose_message, tf_message,
    transform_message, transforms,
};

use crate::{
    msg::{builtin_interfaces::Time, std_msgs::Header},
    time::Stamp,
};

const NANOS_PER_SEC: i64 = 1_000_000_000;

impl From<Time> for Stamp {
    fn from(time: Time) -> Self {
        Stamp::from_nanos(i64::from(time.sec) * NANOS_PER_SEC + i64::from(time.nanosec))
    }
}

impl From<Stamp> for Time {
    /// Stamps beyond the year 2038 do not fit the wire type and saturate.
    fn from(stamp: Stamp) -> Self {
        let nanos = stamp.as_nanos();
        let (sec, nanosec) = (nanos.div_euclid(NANOS_PER_SEC), nanos.rem_euclid(NANOS_PER_SEC));
        let saturated = if sec < 0 { i32::MIN } else { i32::MAX };
        Self { sec: i32::try_from(sec).unwrap_or(saturated), nanosec: nanosec as u32 }
    }
}

/// A header as the wire knows it.
pub fn header(stamp: Stamp, frame_id: &str) -> Header {
    Header { stamp: stamp.into(), frame_id: frame_id.to_owned() }
}

/// A frame's name without the leading slash that bags from ROS 1 still carry.
///
/// # Errors
/// When it is longer than any frame's name: names are kept, and must not take what memory there is.
fn frame(name: &str) -> Result<String, ConvertError> {
    checked_name("frame", name.trim_start_matches('/'))
}

/// The name of a frame or class, which is kept for long.
fn checked_name(what: &'static str, name: &str) -> Result<String, ConvertError> {
    if name.len() > MAX_NAME_BYTES {
        return Err(ConvertError::LongName { what, name: shown(name) });
    }
    Ok(name.to_owned())
}

/// As long as the name of a file may be, and a DDS topic's.
const MAX_NAME_BYTES: usize = 255;

/// How a text from the wire is shown to people: on one line, and only its beginning where it is long.
fn shown(text: &str) -> String {
    const MOST_CHARS: usize = 64;
    let printable = |c: char| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c };
    let start: String = text.chars().take(MOST_CHARS).map(printable).collect();
    match text.chars().nth(MOST_CHARS) {
        None => start,
        Some(_) => format!("{start}… ({} bytes)", text.len()),
    }
}
