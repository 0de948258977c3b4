//! Settings of the live node: topics, frames, files, and what is published.

use serde::{Deserialize, Serialize};

/// What a live node is told besides the settings of the method. Of these, replay heeds the map's frame and what is
/// published.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NodeSettings {
    /// Time comes from `/clock`.
    pub use_sim_time: bool,
    /// Whether `map → odom` is broadcast.
    pub publish_tf: bool,
    /// How often `map → odom` is broadcast (Hz).
    pub tf_rate_hz: f64,
    /// Frame of the map.
    pub map_frame: String,
    /// Most depth images that wait for the one before them to be worked on.
    pub queue_size: usize,
    /// What the detector publishes.
    pub detections_type: DetectionsType,
    /// A map to begin with; empty: none.
    pub load_map: String,
    /// Where the map is saved at the end and by the service; empty: at the end nowhere.
    pub save_map: String,
    /// Topics of the inputs.
    pub topics: InputTopics,
    /// Quality of service of the inputs.
    pub qos: InputQos,
    /// What is published besides markers, boxes, objects, path and odometry.
    pub publish: PublishSettings,
}

/// The topic of each input, before remapping. The end of an image's topic says how it comes: `/compressed`,
/// `/compressedDepth`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct InputTopics {
    /// Colour images.
    pub rgb: String,
    /// Depth images.
    pub depth: String,
    /// Calibration of the colour camera.
    pub camera_info: String,
    /// Calibration of the depth camera, where depth is not aligned to colour.
    pub depth_camera_info: String,
    /// Odometry; without it TF says where the base is.
    pub odometry: String,
    /// 2D boxes.
    pub detections: String,
}

/// Quality of service of each input.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct InputQos {
    /// Depth images.
    pub depth: Qos,
    /// Calibration of the colour camera.
    pub camera_info: Qos,
    /// Calibration of the depth camera.
    pub depth_camera_info: Qos,
    /// Odometry.
    pub odometry: Qos,
    /// 2D boxes.
    pub detections: Qos,
}

/// A profile of ROS 2 by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Qos {
    /// Best effort: it matches any publisher.
    #[default]
    SensorData,
    /// Lost messages are sent again; a best-effort publisher does not match.
    Reliable,
    /// Reliable, and what was published before is delivered.
    Latched,
}

/// The package of the detector's messages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DetectionsType {
    /// `vision_msgs/Detection2DArray`.
    #[default]
    VisionMsgs,
    /// `yolo_msgs/DetectionArray`.
    YoloMsgs,
}

/// What is published besides markers, boxes, objects, path and odometry.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PublishSettings {
    /// Whether an object is also marked by the box round it.
    pub cuboids: bool,
    /// Whether what single images say is published: ellipsoids, symmetry and support planes.
    pub measurements: bool,
    /// Whether objects are published as landmarks for RTAB-Map.
    pub landmarks: bool,
    /// Whether the colour image is published with boxes and outlines drawn into it.
    pub debug_image: bool,
    /// Way (m) after which the path gets a new pose; a turn of 10 degrees gives one too.
    pub path_step_m: f64,
}

impl Default for NodeSettings {
    fn default() -> Self {
        Self {
            use_sim_time: false,
            publish_tf: true,
            tf_rate_hz: 20.0,
            map_frame: "map".into(),
            queue_size: 10,
            detections_type: DetectionsType::VisionMsgs,
            load_map: String::new(),
            save_map: String::new(),
            topics: InputTopics::default(),
            qos: InputQos::default(),
            publish: PublishSettings::default(),
        }
    }
}

impl Default for InputTopics {
    fn default() -> Self {
        Self {
            rgb: "rgb".into(),
            depth: "depth".into(),
            camera_info: "camera_info".into(),
            depth_camera_info: "depth_camera_info".into(),
            odometry: "odometry".into(),
            detections: "detections".into(),
        }
    }
}

impl Default for PublishSettings {
    fn default() -> Self {
        Self {
            cuboids: false,
            measurements: false,
            landmarks: false,
            debug_image: false,
            path_step_m: 0.02,
        }
    }
}
