//! The ROS package `visualization_msgs`.

use crate::msg::{
    Message,
    builtin_interfaces::Duration,
    geometry_msgs::{Point, Pose, Vector3},
    sensor_msgs::CompressedImage,
    std_msgs::{ColorRGBA, Header},
};
use serde::{Deserialize, Serialize};

/// A texture coordinate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct UVCoordinate {
    /// Across.
    pub u: f32,
    /// Down.
    pub v: f32,
}

impl Message for UVCoordinate {
    const TYPE: &'static str = "visualization_msgs/msg/UVCoordinate";
}

/// A mesh sent along.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeshFile {
    /// Name of the file.
    pub filename: String,
    /// The bytes.
    #[serde(with = "serde_bytes")]
    pub data: Vec<u8>,
}

impl Message for MeshFile {
    const TYPE: &'static str = "visualization_msgs/msg/MeshFile";
}

/// One shape for RViz and Foxglove.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Marker {
    /// Stamp and frame.
    pub header: Header,
    /// Namespace; with the id it names the shape.
    pub ns: String,
    /// Number within the namespace.
    pub id: i32,
    /// Which shape.
    #[serde(rename = "type")]
    pub kind: i32,
    /// Add, modify or delete.
    pub action: i32,
    /// The pose.
    pub pose: Pose,
    /// Full extents in metres.
    pub scale: Vector3,
    /// Colour.
    pub color: ColorRGBA,
    /// How long it stays; zero means for ever.
    pub lifetime: Duration,
    /// Whether it moves with its frame.
    pub frame_locked: bool,
    /// Corners of lines and lists.
    pub points: Vec<Point>,
    /// A colour for each point.
    pub colors: Vec<ColorRGBA>,
    /// Where a texture is found.
    pub texture_resource: String,
    /// A texture sent along.
    pub texture: CompressedImage,
    /// Where the texture goes.
    pub uv_coordinates: Vec<UVCoordinate>,
    /// What a text shape says.
    pub text: String,
    /// Where a mesh is found.
    pub mesh_resource: String,
    /// A mesh sent along.
    pub mesh_file: MeshFile,
    /// Whether the mesh brings its colours.
    pub mesh_use_embedded_materials: bool,
}

impl Message for Marker {
    const TYPE: &'static str = "visualization_msgs/msg/Marker";
}

/// Several shapes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MarkerArray {
    /// The shapes.
    pub markers: Vec<Marker>,
}

impl Message for MarkerArray {
    const TYPE: &'static str = "visualization_msgs/msg/MarkerArray";
}

impl Marker {
    /// `kind` of an arrow.
    pub const ARROW: i32 = 0;
    /// `kind` of a box.
    pub const CUBE: i32 = 1;
    /// `kind` of an ellipsoid.
    pub const SPHERE: i32 = 2;
    /// `kind` of a cylinder along z.
    pub const CYLINDER: i32 = 3;
    /// `kind` of connected lines.
    pub const LINE_STRIP: i32 = 4;
    /// `kind` of separate lines.
    pub const LINE_LIST: i32 = 5;
    /// `kind` of points.
    pub const POINTS: i32 = 8;
    /// `kind` of a text that faces the viewer; only `scale.z` counts.
    pub const TEXT_VIEW_FACING: i32 = 9;
    /// `kind` of triangles.
    pub const TRIANGLE_LIST: i32 = 11;
    /// `action` that adds or replaces.
    pub const ADD: i32 = 0;
    /// `action` that removes.
    pub const DELETE: i32 = 2;
    /// `action` that removes everything of the namespace.
    pub const DELETEALL: i32 = 3;
}
