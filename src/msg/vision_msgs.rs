//! The ROS package `vision_msgs`.

use crate::msg::{
    Message,
    geometry_msgs::{Pose, PoseWithCovariance, Vector3},
    std_msgs::Header,
};
use serde::{Deserialize, Serialize};

/// A point in an image in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point2D {
    /// Along x.
    pub x: f64,
    /// Along y.
    pub y: f64,
}

impl Message for Point2D {
    const TYPE: &'static str = "vision_msgs/msg/Point2D";
}

/// A position in an image with a turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose2D {
    /// Position.
    pub position: Point2D,
    /// Turn in radians.
    pub theta: f64,
}

impl Message for Pose2D {
    const TYPE: &'static str = "vision_msgs/msg/Pose2D";
}

/// A box in an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BoundingBox2D {
    /// Centre.
    pub center: Pose2D,
    /// Width in pixels.
    pub size_x: f64,
    /// Height in pixels.
    pub size_y: f64,
}

impl Message for BoundingBox2D {
    const TYPE: &'static str = "vision_msgs/msg/BoundingBox2D";
}

/// An oriented box.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BoundingBox3D {
    /// Centre.
    pub center: Pose,
    /// Full extents in metres.
    pub size: Vector3,
}

impl Message for BoundingBox3D {
    const TYPE: &'static str = "vision_msgs/msg/BoundingBox3D";
}

/// A class with its score.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ObjectHypothesis {
    /// The class: a name, or an index.
    pub class_id: String,
    /// Probability.
    pub score: f64,
}

impl Message for ObjectHypothesis {
    const TYPE: &'static str = "vision_msgs/msg/ObjectHypothesis";
}

/// A class with its score, and a pose where there is one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ObjectHypothesisWithPose {
    /// The class.
    pub hypothesis: ObjectHypothesis,
    /// The pose.
    pub pose: PoseWithCovariance,
}

impl Message for ObjectHypothesisWithPose {
    const TYPE: &'static str = "vision_msgs/msg/ObjectHypothesisWithPose";
}

/// One box of a 2D detector.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Detection2D {
    /// Stamp and frame.
    pub header: Header,
    /// The candidates.
    pub results: Vec<ObjectHypothesisWithPose>,
    /// The box.
    pub bbox: BoundingBox2D,
    /// Identity over time; may be empty.
    pub id: String,
}

impl Message for Detection2D {
    const TYPE: &'static str = "vision_msgs/msg/Detection2D";
}

/// All boxes of one image.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Detection2DArray {
    /// Stamp and frame.
    pub header: Header,
    /// The boxes.
    pub detections: Vec<Detection2D>,
}

impl Message for Detection2DArray {
    const TYPE: &'static str = "vision_msgs/msg/Detection2DArray";
}

/// One object in space.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Detection3D {
    /// Stamp and frame.
    pub header: Header,
    /// The candidates.
    pub results: Vec<ObjectHypothesisWithPose>,
    /// The box.
    pub bbox: BoundingBox3D,
    /// Identity over time; may be empty.
    pub id: String,
}

impl Message for Detection3D {
    const TYPE: &'static str = "vision_msgs/msg/Detection3D";
}

/// Objects in space.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Detection3DArray {
    /// Stamp and frame.
    pub header: Header,
    /// The boxes.
    pub detections: Vec<Detection3D>,
}

impl Message for Detection3DArray {
    const TYPE: &'static str = "vision_msgs/msg/Detection3DArray";
}
