//! Settings of the live node: topics, frames, files, and what is published.

use super::{DetectorSettings, GroundSettings};
use crate::pipeline::StartPose;
use serde::{Deserialize, Serialize};

/// What a live node is told besides the settings of the method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NodeSettings {
    /// Whether time comes from `/clock`.
    pub use_sim_time: bool,
    /// Frame of the map.
    pub map_frame: String,
    /// Whether `map -> odom` is published. Two programs that do so fight.
    pub publish_tf: bool,
    /// Topics, relative to the node's namespace unless they begin with a slash.
    pub topics: TopicSettings,
    /// Quality of service of what is received.
    pub qos: QosSettings,
    /// The detector that runs in here.
    pub detector: DetectorSettings,
    /// The map's file.
    pub map: MapFileSettings,
    /// Who starts the work.
    pub lifecycle: LifecycleSettings,
    /// What is published besides markers, boxes, objects, path and odometry.
    pub publish: PublishSettings,
    /// What stands in a robot's way.
    pub ground: GroundSettings,
}

/// What stands for a topic that is to be found by its type and name.
pub const AUTO: &str = "auto";

/// Names of the topics that are received; [`AUTO`]: they are found. A remapping changes them too.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TopicSettings {
    /// Colour images; empty: none are received.
    pub rgb: String,
    /// How colour images are sent.
    pub rgb_transport: RgbTransport,
    /// Depth images.
    pub depth: String,
    /// How depth images are sent.
    pub depth_transport: DepthTransport,
    /// Calibration of the colour camera.
    pub camera_info: String,
    /// Calibration of the depth camera; empty: it is that of the colour camera.
    pub depth_camera_info: String,
    /// Odometry; empty: TF says where the base is.
    pub odometry: String,
    /// 2D boxes.
    pub detections: String,
    /// Objects in space, in place of depth and boxes.
    pub detections_3d: String,
    /// The message type of either, where its topic is named.
    pub detections_type: DetectionsType,
}

/// How colour images are sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RgbTransport {
    /// `sensor_msgs/Image` on the topic itself.
    #[default]
    Raw,
    /// `sensor_msgs/CompressedImage` on `TOPIC/compressed`.
    Compressed,
}

/// How depth images are sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum DepthTransport {
    /// `sensor_msgs/Image` on the topic itself.
    #[default]
    #[serde(rename = "raw")]
    Raw,
    /// `sensor_msgs/CompressedImage` on `TOPIC/compressed`: a PNG.
    #[serde(rename = "compressed")]
    Compressed,
    /// `sensor_msgs/CompressedImage` on `TOPIC/compressedDepth`.
    #[serde(rename = "compressedDepth")]
    CompressedDepth,
}

/// Whose message the boxes come in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DetectionsType {
    /// `vision_msgs/Detection2DArray`.
    #[default]
    VisionMsgs,
    /// `yolo_msgs/DetectionArray` of `yolo_ros`.
    YoloMsgs,
}

/// Quality of service of a subscription.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Qos {
    /// Best effort: matches any publisher.
    #[default]
    SensorData,
    /// Reliable: matches only reliable publishers.
    Reliable,
}

/// Quality of service, a topic each.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct QosSettings {
    /// Of colour images.
    pub rgb: Qos,
    /// Of depth images.
    pub depth: Qos,
    /// Of both calibrations.
    pub camera_info: Qos,
    /// Of odometry.
    pub odometry: Qos,
    /// Of boxes.
    pub detections: Qos,
}

/// The map's file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MapFileSettings {
    /// Where the map is saved and loaded; empty: nowhere.
    pub file: String,
    /// The folder in which services save and load maps by name; empty: that of `file`.
    pub directory: String,
    /// Whether it is loaded at the start.
    pub load_on_start: bool,
    /// Where the base is in it then.
    pub start_pose: StartPose,
    /// Whether it is saved when the node is stopped.
    pub save_on_shutdown: bool,
}

/// Who starts the work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LifecycleSettings {
    /// Whether the node is active from its start; otherwise it is unconfigured until somebody manages it.
    pub autostart: bool,
}

/// What is published besides markers, boxes, objects, path and odometry.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PublishSettings {
    /// Whether objects are marked by their ellipsoids, as the paper draws them, and not by their outlines.
    pub ellipsoids: bool,
    /// Whether an object is also marked by the box round it.
    pub cuboids: bool,
    /// Whether what single images say is published: ellipsoids, symmetry and support planes.
    pub measurements: bool,
    /// Whether objects are published as landmarks for RTAB-Map.
    pub landmarks: bool,
    /// Whether the colour image is published with boxes and outlines drawn into it.
    pub debug_image: bool,
    /// Whether the objects' footprints are published as a costmap.
    pub costmap: bool,
    /// Whether each object has a frame in TF.
    pub object_frames: bool,
    /// Way (m) after which the path gets a new pose; a turn of 10 degrees gives one too.
    pub path_step_m: f64,
}

impl Default for NodeSettings {
    fn default() -> Self {
        Self {
            use_sim_time: false,
            map_frame: "map".into(),
            publish_tf: true,
            topics: TopicSettings::default(),
            qos: QosSettings::default(),
            detector: DetectorSettings::default(),
            map: MapFileSettings::default(),
            lifecycle: LifecycleSettings::default(),
            publish: PublishSettings::default(),
            ground: GroundSettings::default(),
        }
    }
}

impl Default for TopicSettings {
    fn default() -> Self {
        Self {
            rgb: AUTO.into(),
            rgb_transport: RgbTransport::Raw,
            depth: AUTO.into(),
            depth_transport: DepthTransport::Raw,
            camera_info: AUTO.into(),
            depth_camera_info: AUTO.into(),
            odometry: AUTO.into(),
            detections: AUTO.into(),
            detections_3d: AUTO.into(),
            detections_type: DetectionsType::VisionMsgs,
        }
    }
}

impl Default for LifecycleSettings {
    fn default() -> Self {
        Self { autostart: true }
    }
}

impl Default for PublishSettings {
    fn default() -> Self {
        Self {
            ellipsoids: false,
            cuboids: false,
            measurements: false,
            landmarks: false,
            debug_image: false,
            costmap: false,
            object_frames: false,
            path_step_m: 0.02,
        }
    }
}
