//! Meaning of the keys that only a live node has.

use super::keys::{Key, number, other};

/// Keys of [`NodeSettings`](super::NodeSettings) in the order of the file.
pub(super) const NODE_KEYS: &[Key] = &[
    other("use_sim_time", "time comes from /clock").at_start(),
    other("map_frame", "frame of the map").at_start(),
    other("publish_tf", "publish map -> odom; two programs that do so fight"),
    other(
        "topics",
        "Topics of the input; relative to the namespace unless they begin with a slash. auto: found by type and name.",
    ),
    other("topics.rgb", "colour images; empty: none are received").at_start(),
    other("topics.rgb_transport", "raw or compressed, where topics.rgb is named").at_start(),
    other("topics.depth", "depth images").at_start(),
    other("topics.depth_transport", "raw, compressed or compressedDepth, likewise").at_start(),
    other("topics.camera_info", "calibration of the colour camera").at_start(),
    other(
        "topics.depth_camera_info",
        "calibration of the depth camera; empty: it is the colour camera's",
    )
    .at_start(),
    other("topics.odometry", "odometry; empty: TF says where the base is").at_start(),
    other("topics.detections", "2D boxes").at_start(),
    other(
        "topics.detections_3d",
        "objects that a detector measured in space; auto: where there is no depth; empty: none",
    )
    .at_start(),
    other(
        "topics.detections_type",
        "vision_msgs, or yolo_msgs of yolo_ros, where the topic is named",
    )
    .at_start(),
    other(
        "qos",
        "Quality of service: sensor_data (best effort, matches any publisher) or reliable.",
    ),
    other("qos.rgb", "of colour images").at_start(),
    other("qos.depth", "of depth images").at_start(),
    other("qos.camera_info", "of both calibrations").at_start(),
    other("qos.odometry", "of odometry").at_start(),
    other("qos.detections", "of boxes").at_start(),
    other("detector", "A detector of our own, for robots that run none: docs/detectors.md."),
    other("detector.model", "its ONNX file; empty: boxes come from topics.detections").at_start(),
    other("detector.labels", "a file with a class name a line; empty: the model's own, or COCO's")
        .at_start(),
    other(
        "detector.form",
        "of its output: auto, yolox, yolov5, yolov8 (and later), end_to_end or rtdetr",
    )
    .at_start(),
    number("detector.min_score", 0.01, 1.0, "boxes with a lower score are left out").at_start(),
    number(
        "detector.max_overlap",
        0.0,
        1.0,
        "of boxes of one class that overlap more (IoU) the best is kept",
    )
    .at_start(),
    other("detector.classes", "only these, joined by commas; empty: all").at_start(),
    number("detector.max_hz", 0.1, 100.0, "most images a second that are looked at").at_start(),
    other("map", "The map's file."),
    other("map.file", "where the map is saved and loaded; empty: nowhere").at_start(),
    other(
        "map.directory",
        "folder in which services save and load maps by name; empty: that of map.file",
    )
    .at_start(),
    other("map.load_on_start", "load it when the node starts").at_start(),
    other(
        "map.start_pose",
        "where the base is in it then: X,Y,YAW [m, m, deg]; empty: its objects tell",
    )
    .at_start(),
    other("map.save_on_shutdown", "save it when the node is stopped"),
    other("lifecycle", "Who starts the work of the node: docs/ros2.md."),
    other(
        "lifecycle.autostart",
        "be active from the start; false: be unconfigured until somebody manages it",
    )
    .at_start(),
    other("publish", "What is published besides markers, boxes, objects, path and odometry."),
    other("publish.ellipsoids", "mark objects by their ellipsoids, not by their outlines"),
    other("publish.cuboids", "mark objects by the box round them, too"),
    other(
        "publish.measurements",
        "what single images say: ellipsoids, symmetry and support planes",
    ),
    other("publish.landmarks", "objects as landmarks for RTAB-Map"),
    other("publish.debug_image", "the colour image with boxes and outlines drawn into it")
        .at_start(),
    other("publish.costmap", "the ground that objects cover, as nav_msgs/OccupancyGrid"),
    other(
        "publish.object_frames",
        "a TF frame for each object: object_ID, and object_NAME where it has been named",
    ),
    number("publish.path_step_m", 0.0, 10.0, "a new pose of the path after so much way [m]"),
    other("ground", "What stands in a robot's way, for publish.costmap and ~/approach_object."),
    number(
        "ground.cell_m",
        0.01,
        1.0,
        "size of the costmap's cells; larger where they would be more than a million [m]",
    ),
    number(
        "ground.inflation_m",
        0.0,
        2.0,
        "how far objects are wider in the costmap than they are [m]",
    ),
    number(
        "ground.robot_height_m",
        0.1,
        10.0,
        "it passes under objects whose lower side is higher above the floor [m]",
    ),
    number(
        "ground.robot_radius_m",
        0.05,
        2.0,
        "kept free of objects and walls where it is sent [m]",
    ),
    number(
        "ground.approach_distance_m",
        0.05,
        10.0,
        "from an object's footprint to where it is sent [m]",
    ),
];
