//! The ROS package `nav_msgs`.

use crate::msg::{
    Message,
    builtin_interfaces::Time,
    geometry_msgs::{Pose, PoseStamped, PoseWithCovariance, TwistWithCovariance},
    std_msgs::Header,
};
use serde::{Deserialize, Serialize};

/// Where the base is in the odometry's frame, and how fast it moves.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Odometry {
    /// Stamp and frame.
    pub header: Header,
    /// The child frame.
    pub child_frame_id: String,
    /// The pose.
    pub pose: PoseWithCovariance,
    /// The velocity, in the child frame.
    pub twist: TwistWithCovariance,
}

impl Message for Odometry {
    const TYPE: &'static str = "nav_msgs/msg/Odometry";
}

/// A sequence of poses.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Path {
    /// Stamp and frame.
    pub header: Header,
    /// In order of time.
    pub poses: Vec<PoseStamped>,
}

impl Message for Path {
    const TYPE: &'static str = "nav_msgs/msg/Path";
}

/// The cells of a grid on the ground.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MapMetaData {
    /// When it was made.
    pub map_load_time: Time,
    /// Size of a cell (m).
    pub resolution: f32,
    /// Cells along x.
    pub width: u32,
    /// Cells along y.
    pub height: u32,
    /// Pose of the corner of cell (0, 0).
    pub origin: Pose,
}

impl Message for MapMetaData {
    const TYPE: &'static str = "nav_msgs/msg/MapMetaData";
}

/// What is known of the ground, cell by cell.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OccupancyGrid {
    /// Stamp and frame.
    pub header: Header,
    /// The cells.
    pub info: MapMetaData,
    /// Along x first: 0 free to 100 occupied; -1 where nothing is known.
    pub data: Vec<i8>,
}

impl Message for OccupancyGrid {
    const TYPE: &'static str = "nav_msgs/msg/OccupancyGrid";
}

impl OccupancyGrid {
    /// A cell that is taken.
    pub const OCCUPIED: i8 = 100;
    /// A cell of which nothing is known.
    pub const UNKNOWN: i8 = -1;
}
