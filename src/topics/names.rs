//! What names and formats of topics say.

use super::Topic;
use crate::msg::convert::without_transport;

/// Topics under these names are never taken by themselves: the truth, and what this program publishes.
const NEVER: [&str; 2] = ["/ground_truth/", "/ellipsoid_slam/"];
/// Images that are neither colour nor depth as the camera took them, though of the same type.
const BYPRODUCTS: [&str; 9] = [
    "infra",
    "confidence",
    "disparity",
    "mask",
    "debug",
    "annotated",
    "detection",
    "rgb_to_depth",
    "color_to_depth",
];
/// Encodings of depth; of compressed images, what their format begins with or has in it.
const DEPTH_FORMATS: [&str; 3] = ["16UC1", "32FC1", "compressedDepth"];
/// What formats of other images begin with. A `mono16` or a PNG of which nothing else is said may be either.
const OTHER_FORMATS: [&str; 11] =
    ["rgb", "bgr", "mono8", "yuv", "uyvy", "yuyv", "nv", "bayer", "8U", "jpeg", "jpg"];

pub(super) fn is_never_input(name: &str) -> bool {
    NEVER.iter().any(|prefix| name.starts_with(prefix))
}

pub(super) fn is_byproduct(name: &str) -> bool {
    BYPRODUCTS.iter().any(|word| name.contains(word)) || name.split('/').any(|part| part == "ir")
}

pub(super) fn is_compressed(name: &str) -> bool {
    without_transport(name) != name
}

/// What an image's format says of whether it is depth; nothing if that is not known or may be either.
fn format_says_depth(topic: &Topic) -> Option<bool> {
    let format = topic.format.as_deref()?;
    if DEPTH_FORMATS.iter().any(|depth| format.contains(depth)) {
        return Some(true);
    }
    OTHER_FORMATS.iter().any(|other| format.starts_with(other)).then_some(false)
}

/// Whether a part of the name other than the camera's says depth. OAK cameras call it `stereo/image_raw`.
pub(super) fn is_named_depth(name: &str) -> bool {
    let parts: Vec<&str> = without_transport(name).split('/').collect();
    let (last, folders) = parts.split_last().unwrap_or((&"", &[]));
    last.contains("depth")
        || folders.last() == Some(&"stereo")
        || folders.iter().any(|part| part.contains("depth") && !part.contains("cam"))
}

/// Whether an image can be depth: by its format, or by its name where the format does not say.
pub(super) fn may_be_depth(topic: &Topic) -> bool {
    let by_name = is_named_depth(&topic.name) || topic.name.contains("depth");
    format_says_depth(topic).unwrap_or(by_name)
}

/// The same of colour.
pub(super) fn may_be_color(topic: &Topic) -> bool {
    !format_says_depth(topic).unwrap_or_else(|| is_named_depth(&topic.name))
}

pub(super) fn is_grey(topic: &Topic) -> bool {
    topic.format.as_deref().is_some_and(|format| format.starts_with("mono"))
}

/// Whether the name says that depth is as the colour camera would see it.
pub(super) fn is_aligned(name: &str) -> bool {
    ["aligned", "registered", "depth_to_color", "depth_to_rgb"].iter().any(|w| name.contains(w))
}

pub(super) fn is_named_color(name: &str) -> bool {
    ["color", "colour", "rgb"].iter().any(|word| name.contains(word))
}

/// Whether it is one of the two images of a stereo camera.
pub(super) fn is_one_eye(name: &str) -> bool {
    name.split('/').any(|part| part == "left" || part == "right")
}

/// The folder of a name.
pub(super) fn namespace(name: &str) -> &str {
    name.rsplit_once('/').map_or("", |(namespace, _)| namespace)
}

/// The first part of a name that has several: that of the camera or the robot.
pub(super) fn root(name: &str) -> &str {
    name.trim_start_matches('/').split_once('/').map_or("", |(root, _)| root)
}
