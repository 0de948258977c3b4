//! Our own interfaces: the files in `msg/` and `srv/`.

use crate::msg::{
    Message, Service,
    builtin_interfaces::Time,
    geometry_msgs::{Point, Pose, PoseStamped, Vector3},
    std_msgs::Header,
};
use serde::{Deserialize, Serialize};

/// How probable it is that an object has a label.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LabelBelief {
    /// As the detector says it.
    pub label: String,
    /// In [0, 1].
    pub probability: f64,
}

impl Message for LabelBelief {
    const TYPE: &'static str = "ellipsoid_slam/msg/LabelBelief";
}

/// An object of the map; `Object.msg` says what each field means.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Object {
    /// Identity in the map.
    pub id: u64,
    /// The most probable label.
    pub label: String,
    /// What people call it.
    pub name: String,
    /// Whether it stays whatever images say.
    pub locked: bool,
    /// All labels.
    pub labels: Vec<LabelBelief>,
    /// Probability that it exists.
    pub existence: f64,
    /// Measurements that were joined to it.
    pub observations: u32,
    /// Stamp of the first measurement.
    pub first_seen: Time,
    /// Stamp of the latest measurement.
    pub last_seen: Time,
    /// Where it is.
    pub pose: Pose,
    /// Half its extents (m).
    pub semi_axes: Vector3,
    /// Of rotation (rad), translation (m), log semi-axes, in its own frame.
    pub covariance: [[f64; 9]; 9],
    /// One of the constants.
    pub outline: u8,
    /// `e1` of the superquadric.
    pub profile_exponent: f64,
    /// `e2` of the superquadric.
    pub footprint_exponent: f64,
    /// Height of the plane it stands on (m); NaN where none was seen.
    pub support_height: f64,
}

impl Message for Object {
    const TYPE: &'static str = "ellipsoid_slam/msg/Object";
}

impl Object {
    /// `outline` of an ellipsoid.
    pub const ELLIPSOID: u8 = 0;
    /// `outline` of a cuboid.
    pub const CUBOID: u8 = 1;
    /// `outline` of an upright cylinder.
    pub const CYLINDER: u8 = 2;
    /// `outline` of anything between.
    pub const SUPERQUADRIC: u8 = 3;
}

/// The objects of the map.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ObjectArray {
    /// When this was so, and the frame of all poses.
    pub header: Header,
    /// The objects.
    pub objects: Vec<Object>,
}

impl Message for ObjectArray {
    const TYPE: &'static str = "ellipsoid_slam/msg/ObjectArray";
}

/// What one image says about one object.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EllipsoidMeasurement {
    /// The object it was joined to; 0 for none.
    pub object_id: u64,
    /// The detector's labels, most probable first.
    pub labels: Vec<LabelBelief>,
    /// Where it is.
    pub pose: Pose,
    /// Half its extents (m).
    pub semi_axes: Vector3,
    /// As in [`Object::covariance`].
    pub covariance: [[f64; 9]; 9],
    /// How the faces -x, +x, -y, +y, -z, +z are known: one of the constants each.
    pub sides: [u8; 6],
    /// `P_det` of the paper.
    pub detection_probability: f64,
    /// `P_sym` of the paper.
    pub symmetry_probability: f64,
    /// `P_fit` of the paper.
    pub fit_probability: f64,
}

impl Message for EllipsoidMeasurement {
    const TYPE: &'static str = "ellipsoid_slam/msg/EllipsoidMeasurement";
}

impl EllipsoidMeasurement {
    /// A face whose edge stands out against what is behind.
    pub const SEEN: u8 = 0;
    /// A face that rests on the support plane.
    pub const SUPPORT: u8 = 1;
    /// The mirror image of a face that was seen.
    pub const MIRRORED: u8 = 2;
    /// A face of which only the detector's box says how far it reaches.
    pub const OUTLINE: u8 = 3;
    /// A face that is cut by the box or by another object.
    pub const CUT: u8 = 4;
    /// A face that nothing shows.
    pub const HIDDEN: u8 = 5;
}

/// What one image and its boxes gave.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EllipsoidMeasurementArray {
    /// Stamp of the image, and the camera's optical frame.
    pub header: Header,
    /// What the boxes gave.
    pub measurements: Vec<EllipsoidMeasurement>,
    /// Heights of the support planes in the map (m).
    pub support_heights: Vec<f64>,
}

impl Message for EllipsoidMeasurementArray {
    const TYPE: &'static str = "ellipsoid_slam/msg/EllipsoidMeasurementArray";
}

/// Writes the map to a file.
#[derive(Clone, Copy, Debug)]
pub struct SaveMap;

/// Which file to write.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SaveMapRequest {
    /// Empty: the file of the parameters.
    pub path: String,
}

/// What came of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SaveMapResponse {
    /// Whether the file is there.
    pub success: bool,
    /// Where it is, or why it is not.
    pub message: String,
}

impl Service for SaveMap {
    const TYPE: &'static str = "ellipsoid_slam/srv/SaveMap";
    type Request = SaveMapRequest;
    type Response = SaveMapResponse;
}

/// Puts the objects of a file in place of the map.
#[derive(Clone, Copy, Debug)]
pub struct LoadMap;

/// Which file to read.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LoadMapRequest {
    /// Empty: the file of the parameters.
    pub path: String,
}

/// What came of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LoadMapResponse {
    /// Whether the map is now the file's.
    pub success: bool,
    /// Why it is not.
    pub message: String,
    /// How many objects were loaded.
    pub objects: u32,
}

impl Service for LoadMap {
    const TYPE: &'static str = "ellipsoid_slam/srv/LoadMap";
    type Request = LoadMapRequest;
    type Response = LoadMapResponse;
}

/// Looks up objects of the map.
#[derive(Clone, Copy, Debug)]
pub struct QueryObjects;

/// What has to hold for an object; what is not asked for holds for all.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct QueryObjectsRequest {
    /// One of these is its most probable label or its name; empty: any.
    pub labels: Vec<String>,
    /// At least this probable to exist.
    pub min_existence: f64,
    /// Whether its centre has to be in the region.
    pub in_region: bool,
    /// Lowest corner of the region in the map (m).
    pub region_min: Point,
    /// Highest corner of the region in the map (m).
    pub region_max: Point,
    /// Whether its centre has to be in the latest image.
    pub in_view: bool,
    /// How far from the camera it may be (m); 0: however far.
    pub max_range: f64,
    /// Whether the nearest objects come first.
    pub by_distance: bool,
    /// Nearest to this point of the map (m).
    pub nearest_to: Point,
    /// At most so many; 0: all.
    pub max_count: u32,
}

/// The objects for which it holds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct QueryObjectsResponse {
    /// Whether there is an answer.
    pub success: bool,
    /// Why there is none, or that there are more.
    pub message: String,
    /// When this was so, and the frame of the map.
    pub header: Header,
    /// The objects, at most 100; [`ObjectArray`] has all that is known of them.
    pub ids: Vec<u64>,
}

impl Service for QueryObjects {
    const TYPE: &'static str = "ellipsoid_slam/srv/QueryObjects";
    type Request = QueryObjectsRequest;
    type Response = QueryObjectsResponse;
}

/// Where a robot can stand before an object.
#[derive(Clone, Copy, Debug)]
pub struct ApproachObject;

/// Before which one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ApproachObjectRequest {
    /// The object; 0: the nearest one of the label.
    pub id: u64,
    /// Its label or name.
    pub label: String,
    /// From its footprint to the base (m); 0: as the parameters say.
    pub distance: f64,
}

/// Where.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ApproachObjectResponse {
    /// Whether there is such a pose.
    pub success: bool,
    /// Why there is none.
    pub message: String,
    /// The object.
    pub id: u64,
    /// Of the base, in the frame of the map.
    pub pose: PoseStamped,
}

impl Service for ApproachObject {
    const TYPE: &'static str = "ellipsoid_slam/srv/ApproachObject";
    type Request = ApproachObjectRequest;
    type Response = ApproachObjectResponse;
}

/// What came of an edit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EditResponse {
    /// Whether it was done.
    pub success: bool,
    /// What was done, or why not.
    pub message: String,
}

/// Gives an object a name.
#[derive(Clone, Copy, Debug)]
pub struct RenameObject;

/// Which name.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RenameObjectRequest {
    /// The object.
    pub id: u64,
    /// Its name.
    pub name: String,
}

impl Service for RenameObject {
    const TYPE: &'static str = "ellipsoid_slam/srv/RenameObject";
    type Request = RenameObjectRequest;
    type Response = EditResponse;
}

/// Takes an object out of the map.
#[derive(Clone, Copy, Debug)]
pub struct DeleteObject;

/// Which one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DeleteObjectRequest {
    /// The object.
    pub id: u64,
}

impl Service for DeleteObject {
    const TYPE: &'static str = "ellipsoid_slam/srv/DeleteObject";
    type Request = DeleteObjectRequest;
    type Response = EditResponse;
}

/// Keeps an object as it is.
#[derive(Clone, Copy, Debug)]
pub struct LockObject;

/// Which one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LockObjectRequest {
    /// The object.
    pub id: u64,
    /// False takes the lock away.
    pub locked: bool,
}

impl Service for LockObject {
    const TYPE: &'static str = "ellipsoid_slam/srv/LockObject";
    type Request = LockObjectRequest;
    type Response = EditResponse;
}

/// Adds an object that nobody has seen.
#[derive(Clone, Copy, Debug)]
pub struct AddObject;

/// What is where.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AddObjectRequest {
    /// Its class.
    pub label: String,
    /// Of its centre, in the map.
    pub pose: PoseStamped,
    /// Full extents (m).
    pub size: Vector3,
    /// Whether it stays if images do not show it.
    pub locked: bool,
}

/// What came of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AddObjectResponse {
    /// Whether it was done.
    pub success: bool,
    /// What was done, or why not.
    pub message: String,
    /// The new object.
    pub id: u64,
}

impl Service for AddObject {
    const TYPE: &'static str = "ellipsoid_slam/srv/AddObject";
    type Request = AddObjectRequest;
    type Response = AddObjectResponse;
}
