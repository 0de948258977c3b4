//! The ROS package `yolo_msgs` of the widely used node `yolo_ros`.

use crate::msg::{
    Message,
    geometry_msgs::{Point, Pose, Vector3},
    std_msgs::Header,
};
use serde::{Deserialize, Serialize};

/// A point in an image (px).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point2D {
    /// Along x.
    pub x: f64,
    /// Along y.
    pub y: f64,
}

impl Message for Point2D {
    const TYPE: &'static str = "yolo_msgs/msg/Point2D";
}

/// A size in an image (px).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Vector2 {
    /// Along x.
    pub x: f64,
    /// Along y.
    pub y: f64,
}

impl Message for Vector2 {
    const TYPE: &'static str = "yolo_msgs/msg/Vector2";
}

/// A position in an image with a turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose2D {
    /// Position.
    pub position: Point2D,
    /// Turn (rad).
    pub theta: f64,
}

impl Message for Pose2D {
    const TYPE: &'static str = "yolo_msgs/msg/Pose2D";
}

/// A box in an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BoundingBox2D {
    /// Centre.
    pub center: Pose2D,
    /// Width and height (px).
    pub size: Vector2,
}

impl Message for BoundingBox2D {
    const TYPE: &'static str = "yolo_msgs/msg/BoundingBox2D";
}

/// A box in space.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BoundingBox3D {
    /// Centre.
    pub center: Pose,
    /// Full extents (m).
    pub size: Vector3,
    /// Frame of the centre.
    pub frame_id: String,
}

impl Message for BoundingBox3D {
    const TYPE: &'static str = "yolo_msgs/msg/BoundingBox3D";
}

/// The border of what is one object.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Mask {
    /// Rows of the image.
    pub height: i32,
    /// Columns of the image.
    pub width: i32,
    /// Points of the border.
    pub data: Vec<Point2D>,
}

impl Message for Mask {
    const TYPE: &'static str = "yolo_msgs/msg/Mask";
}

/// A point of a body in an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KeyPoint2D {
    /// Which point.
    pub id: i32,
    /// Where.
    pub point: Point2D,
    /// Probability.
    pub score: f64,
}

impl Message for KeyPoint2D {
    const TYPE: &'static str = "yolo_msgs/msg/KeyPoint2D";
}

/// Points of a body in an image.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KeyPoint2DArray {
    /// The points.
    pub data: Vec<KeyPoint2D>,
}

impl Message for KeyPoint2DArray {
    const TYPE: &'static str = "yolo_msgs/msg/KeyPoint2DArray";
}

/// A point of a body in space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KeyPoint3D {
    /// Which point.
    pub id: i32,
    /// Where (m).
    pub point: Point,
    /// Probability.
    pub score: f64,
}

impl Message for KeyPoint3D {
    const TYPE: &'static str = "yolo_msgs/msg/KeyPoint3D";
}

/// Points of a body in space.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KeyPoint3DArray {
    /// The points.
    pub data: Vec<KeyPoint3D>,
    /// Their frame.
    pub frame_id: String,
}

impl Message for KeyPoint3DArray {
    const TYPE: &'static str = "yolo_msgs/msg/KeyPoint3DArray";
}

/// What the detector found in one place.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Detection {
    /// Index of the class.
    pub class_id: i32,
    /// Name of the class.
    pub class_name: String,
    /// Probability.
    pub score: f64,
    /// Identity over time; empty without a tracker.
    pub id: String,
    /// The box in the image.
    pub bbox: BoundingBox2D,
    /// The box in space, where the node estimates one.
    pub bbox3d: BoundingBox3D,
    /// The border, where the network gives one.
    pub mask: Mask,
    /// Points in the image, likewise.
    pub keypoints: KeyPoint2DArray,
    /// Points in space, likewise.
    pub keypoints3d: KeyPoint3DArray,
}

impl Message for Detection {
    const TYPE: &'static str = "yolo_msgs/msg/Detection";
}

/// What the detector found in one image.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DetectionArray {
    /// Stamp and frame of the image.
    pub header: Header,
    /// What it found.
    pub detections: Vec<Detection>,
}

impl Message for DetectionArray {
    const TYPE: &'static str = "yolo_msgs/msg/DetectionArray";
}
