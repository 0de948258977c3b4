//! Meaning of the keys that only a live node has.

use super::keys::{Key, number, other};

/// Keys of [`NodeSettings`](super::NodeSettings) in the order of the file.
pub(super) const NODE_KEYS: &[Key] = &[
    other("use_sim_time", "time comes from /clock").at_start(),
    other("map_frame", "frame of the map").at_start(),
    other("publish_tf", "publish map -> odom; two programs that do so fight").at_start(),
    number("tf_rate_hz", 0.1, 1000.0, "how often map -> odom is published [Hz]").at_start(),
    number("queue_size", 1.0, 1000.0, "most depth images that wait to be worked on").at_start(),
    other("detections_type", "vision_msgs, or yolo_msgs of yolo_ros").at_start(),
    other("load_map", "a map file to begin with; empty: none").at_start(),
    other("save_map", "where the map is saved at the end and by the service; empty: nowhere"),
    other("topics", "Topics, relative to the node's namespace unless they begin with a slash."),
    other("topics.rgb", "colour images").at_start(),
    other("topics.depth", "depth images; .../compressedDepth if they come so").at_start(),
    other("topics.camera_info", "calibration of the colour camera").at_start(),
    other("topics.depth_camera_info", "the depth camera's, if depth is not aligned to colour")
        .at_start(),
    other("topics.odometry", "odometry; without it TF from sync.odom_frame").at_start(),
    other("topics.detections", "2D boxes").at_start(),
    other("qos", "Quality of service: sensor_data matches any publisher; reliable; latched."),
    other("qos.depth", "of depth images").at_start(),
    other("qos.camera_info", "of the colour camera's calibration").at_start(),
    other("qos.depth_camera_info", "of the depth camera's calibration").at_start(),
    other("qos.odometry", "of odometry").at_start(),
    other("qos.detections", "of boxes").at_start(),
    other("publish", "What is published besides markers, boxes, objects, path and odometry."),
    other("publish.cuboids", "mark objects by the box round them, too"),
    other(
        "publish.measurements",
        "what single images say: ellipsoids, symmetry and support planes",
    ),
    other("publish.landmarks", "objects as landmarks for RTAB-Map"),
    other("publish.debug_image", "the colour image with boxes and outlines drawn into it"),
    number("publish.path_step_m", 0.0, 10.0, "a new pose of the path after so much way [m]"),
];
