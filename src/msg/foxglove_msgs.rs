//! The ROS package `foxglove_msgs`, as far as it is about what Foxglove draws over an image. Positions are pixels from the
//! image's upper left corner.

use crate::msg::{Message, builtin_interfaces::Time};
use serde::{Deserialize, Serialize};

/// A colour in [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Color {
    /// Red.
    pub r: f64,
    /// Green.
    pub g: f64,
    /// Blue.
    pub b: f64,
    /// 1 covers what is below, 0 shows it.
    pub a: f64,
}

impl Message for Color {
    const TYPE: &'static str = "foxglove_msgs/msg/Color";
}

/// A point of an image (px).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point2 {
    /// To the right.
    pub x: f64,
    /// Downwards.
    pub y: f64,
}

impl Message for Point2 {
    const TYPE: &'static str = "foxglove_msgs/msg/Point2";
}

/// A circle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CircleAnnotation {
    /// Of the image.
    pub timestamp: Time,
    /// Its centre.
    pub position: Point2,
    /// (px).
    pub diameter: f64,
    /// Of its line (px).
    pub thickness: f64,
    /// What it is filled with.
    pub fill_color: Color,
    /// Of its line.
    pub outline_color: Color,
}

impl Message for CircleAnnotation {
    const TYPE: &'static str = "foxglove_msgs/msg/CircleAnnotation";
}

/// Points or lines between points.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PointsAnnotation {
    /// Of the image.
    pub timestamp: Time,
    /// What is drawn of the points: one of the constants.
    #[serde(rename = "type")]
    pub kind: u8,
    /// The points.
    pub points: Vec<Point2>,
    /// Of all lines.
    pub outline_color: Color,
    /// Of each line; empty where all have one colour.
    pub outline_colors: Vec<Color>,
    /// What a closed line is filled with.
    pub fill_color: Color,
    /// Of lines (px).
    pub thickness: f64,
}

impl PointsAnnotation {
    /// A closed line through all points.
    pub const LINE_LOOP: u8 = 2;
    /// A line from each point of even index to the next one.
    pub const LINE_LIST: u8 = 4;
}

impl Message for PointsAnnotation {
    const TYPE: &'static str = "foxglove_msgs/msg/PointsAnnotation";
}

/// A text.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TextAnnotation {
    /// Of the image.
    pub timestamp: Time,
    /// Its lower left corner.
    pub position: Point2,
    /// What it says.
    pub text: String,
    /// Height of its letters (px).
    pub font_size: f64,
    /// Of its letters.
    pub text_color: Color,
    /// Behind it.
    pub background_color: Color,
}

impl Message for TextAnnotation {
    const TYPE: &'static str = "foxglove_msgs/msg/TextAnnotation";
}

/// What is drawn over one image.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ImageAnnotations {
    /// Circles.
    pub circles: Vec<CircleAnnotation>,
    /// Points and lines.
    pub points: Vec<PointsAnnotation>,
    /// Texts.
    pub texts: Vec<TextAnnotation>,
}

impl Message for ImageAnnotations {
    const TYPE: &'static str = "foxglove_msgs/msg/ImageAnnotations";
}
