//! Settings of the live node alone: topics, frames, files.

use serde::{Deserialize, Serialize};

/// Settings of the live node alone; replay reads over them.
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
    /// Quality of service of the inputs.
    pub qos: InputQos,
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
            qos: InputQos::default(),
        }
    }
}
