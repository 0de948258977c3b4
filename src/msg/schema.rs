//! Definitions of the message types as text, as result bags carry them.

/// The definition of `type_name` (`pkg/msg/Name`) followed by those of all types it is made of, in the layout of
/// the MCAP schema encoding `ros2msg`; nothing for a type that is not known here.
pub fn schema_text(type_name: &str) -> Option<String> {
    let root = type_name.replace("/msg/", "/");
    let mut text = definition(&root)?.to_owned();
    let mut todo = parts_of(&root);
    let mut done = vec![root];
    while !todo.is_empty() {
        let name = todo.remove(0);
        if done.contains(&name) {
            continue;
        }
        text.push_str(&format!("{SEPARATOR}\nMSG: {name}\n{}", definition(&name)?));
        todo.extend(parts_of(&name));
        done.push(name);
    }
    Some(text)
}

pub(super) const SEPARATOR: &str =
    "================================================================================";

/// Text of the `.msg` file of `pkg/Name`.
pub(super) fn definition(name: &str) -> Option<&'static str> {
    DEFINITIONS.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// `pkg/Name` of each field of `name` that is not a primitive.
fn parts_of(name: &str) -> Vec<String> {
    let package = name.split('/').next().unwrap_or_default();
    let text = definition(name).unwrap_or_default().lines();
    let fields = text.map(without_comment).filter(|line| !line.contains('='));
    let types = fields.filter_map(|line| line.split_whitespace().next()?.split('[').next());
    types
        .filter(|kind| !PRIMITIVES.contains(kind))
        .map(|kind| if kind.contains('/') { kind.to_owned() } else { format!("{package}/{kind}") })
        .collect()
}

pub(super) fn without_comment(line: &str) -> &str {
    line.split('#').next().unwrap_or_default()
}

/// The primitives that the definitions below use.
const PRIMITIVES: &[&str] =
    &["bool", "byte", "int8", "uint8", "int32", "uint32", "uint64", "float32", "float64", "string"];

const DEFINITIONS: &[(&str, &str)] = &[
    ("builtin_interfaces/Time", include_str!("../../msg/ros/builtin_interfaces/Time.msg")),
    ("builtin_interfaces/Duration", include_str!("../../msg/ros/builtin_interfaces/Duration.msg")),
    ("std_msgs/Header", include_str!("../../msg/ros/std_msgs/Header.msg")),
    ("std_msgs/ColorRGBA", include_str!("../../msg/ros/std_msgs/ColorRGBA.msg")),
    ("geometry_msgs/Point", include_str!("../../msg/ros/geometry_msgs/Point.msg")),
    ("geometry_msgs/Vector3", include_str!("../../msg/ros/geometry_msgs/Vector3.msg")),
    ("geometry_msgs/Quaternion", include_str!("../../msg/ros/geometry_msgs/Quaternion.msg")),
    ("geometry_msgs/Pose", include_str!("../../msg/ros/geometry_msgs/Pose.msg")),
    ("geometry_msgs/PoseStamped", include_str!("../../msg/ros/geometry_msgs/PoseStamped.msg")),
    (
        "geometry_msgs/PoseWithCovariance",
        include_str!("../../msg/ros/geometry_msgs/PoseWithCovariance.msg"),
    ),
    (
        "geometry_msgs/PoseWithCovarianceStamped",
        include_str!("../../msg/ros/geometry_msgs/PoseWithCovarianceStamped.msg"),
    ),
    ("geometry_msgs/Twist", include_str!("../../msg/ros/geometry_msgs/Twist.msg")),
    (
        "geometry_msgs/TwistWithCovariance",
        include_str!("../../msg/ros/geometry_msgs/TwistWithCovariance.msg"),
    ),
    ("geometry_msgs/Transform", include_str!("../../msg/ros/geometry_msgs/Transform.msg")),
    (
        "geometry_msgs/TransformStamped",
        include_str!("../../msg/ros/geometry_msgs/TransformStamped.msg"),
    ),
    ("sensor_msgs/Image", include_str!("../../msg/ros/sensor_msgs/Image.msg")),
    ("sensor_msgs/CompressedImage", include_str!("../../msg/ros/sensor_msgs/CompressedImage.msg")),
    (
        "sensor_msgs/RegionOfInterest",
        include_str!("../../msg/ros/sensor_msgs/RegionOfInterest.msg"),
    ),
    ("sensor_msgs/PointField", include_str!("../../msg/ros/sensor_msgs/PointField.msg")),
    ("sensor_msgs/PointCloud2", include_str!("../../msg/ros/sensor_msgs/PointCloud2.msg")),
    ("sensor_msgs/CameraInfo", include_str!("../../msg/ros/sensor_msgs/CameraInfo.msg")),
    ("nav_msgs/MapMetaData", include_str!("../../msg/ros/nav_msgs/MapMetaData.msg")),
    ("nav_msgs/OccupancyGrid", include_str!("../../msg/ros/nav_msgs/OccupancyGrid.msg")),
    ("nav_msgs/Odometry", include_str!("../../msg/ros/nav_msgs/Odometry.msg")),
    ("nav_msgs/Path", include_str!("../../msg/ros/nav_msgs/Path.msg")),
    ("tf2_msgs/TFMessage", include_str!("../../msg/ros/tf2_msgs/TFMessage.msg")),
    ("vision_msgs/Point2D", include_str!("../../msg/ros/vision_msgs/Point2D.msg")),
    ("vision_msgs/Pose2D", include_str!("../../msg/ros/vision_msgs/Pose2D.msg")),
    ("vision_msgs/BoundingBox2D", include_str!("../../msg/ros/vision_msgs/BoundingBox2D.msg")),
    ("vision_msgs/BoundingBox3D", include_str!("../../msg/ros/vision_msgs/BoundingBox3D.msg")),
    (
        "vision_msgs/ObjectHypothesis",
        include_str!("../../msg/ros/vision_msgs/ObjectHypothesis.msg"),
    ),
    (
        "vision_msgs/ObjectHypothesisWithPose",
        include_str!("../../msg/ros/vision_msgs/ObjectHypothesisWithPose.msg"),
    ),
    ("vision_msgs/Detection2D", include_str!("../../msg/ros/vision_msgs/Detection2D.msg")),
    (
        "vision_msgs/Detection2DArray",
        include_str!("../../msg/ros/vision_msgs/Detection2DArray.msg"),
    ),
    ("vision_msgs/Detection3D", include_str!("../../msg/ros/vision_msgs/Detection3D.msg")),
    (
        "vision_msgs/Detection3DArray",
        include_str!("../../msg/ros/vision_msgs/Detection3DArray.msg"),
    ),
    (
        "visualization_msgs/UVCoordinate",
        include_str!("../../msg/ros/visualization_msgs/UVCoordinate.msg"),
    ),
    ("visualization_msgs/MeshFile", include_str!("../../msg/ros/visualization_msgs/MeshFile.msg")),
    ("visualization_msgs/Marker", include_str!("../../msg/ros/visualization_msgs/Marker.msg")),
    (
        "visualization_msgs/MarkerArray",
        include_str!("../../msg/ros/visualization_msgs/MarkerArray.msg"),
    ),
    ("ellipsoid_slam/LabelBelief", include_str!("../../msg/LabelBelief.msg")),
    ("ellipsoid_slam/Object", include_str!("../../msg/Object.msg")),
    ("ellipsoid_slam/ObjectArray", include_str!("../../msg/ObjectArray.msg")),
    ("ellipsoid_slam/EllipsoidMeasurement", include_str!("../../msg/EllipsoidMeasurement.msg")),
    (
        "ellipsoid_slam/EllipsoidMeasurementArray",
        include_str!("../../msg/EllipsoidMeasurementArray.msg"),
    ),
    ("diagnostic_msgs/KeyValue", include_str!("../../msg/ros/diagnostic_msgs/KeyValue.msg")),
    (
        "diagnostic_msgs/DiagnosticStatus",
        include_str!("../../msg/ros/diagnostic_msgs/DiagnosticStatus.msg"),
    ),
    (
        "diagnostic_msgs/DiagnosticArray",
        include_str!("../../msg/ros/diagnostic_msgs/DiagnosticArray.msg"),
    ),
    ("lifecycle_msgs/State", include_str!("../../msg/ros/lifecycle_msgs/State.msg")),
    ("lifecycle_msgs/Transition", include_str!("../../msg/ros/lifecycle_msgs/Transition.msg")),
    (
        "lifecycle_msgs/TransitionDescription",
        include_str!("../../msg/ros/lifecycle_msgs/TransitionDescription.msg"),
    ),
    (
        "lifecycle_msgs/TransitionEvent",
        include_str!("../../msg/ros/lifecycle_msgs/TransitionEvent.msg"),
    ),
    ("rcl_interfaces/Log", include_str!("../../msg/ros/rcl_interfaces/Log.msg")),
    ("rosgraph_msgs/Clock", include_str!("../../msg/ros/rosgraph_msgs/Clock.msg")),
    (
        "rtabmap_msgs/LandmarkDetection",
        include_str!("../../msg/ros/rtabmap_msgs/LandmarkDetection.msg"),
    ),
    (
        "rtabmap_msgs/LandmarkDetections",
        include_str!("../../msg/ros/rtabmap_msgs/LandmarkDetections.msg"),
    ),
    ("yolo_msgs/Point2D", include_str!("../../msg/ros/yolo_msgs/Point2D.msg")),
    ("yolo_msgs/Vector2", include_str!("../../msg/ros/yolo_msgs/Vector2.msg")),
    ("yolo_msgs/Pose2D", include_str!("../../msg/ros/yolo_msgs/Pose2D.msg")),
    ("yolo_msgs/BoundingBox2D", include_str!("../../msg/ros/yolo_msgs/BoundingBox2D.msg")),
    ("yolo_msgs/BoundingBox3D", include_str!("../../msg/ros/yolo_msgs/BoundingBox3D.msg")),
    ("yolo_msgs/Mask", include_str!("../../msg/ros/yolo_msgs/Mask.msg")),
    ("yolo_msgs/KeyPoint2D", include_str!("../../msg/ros/yolo_msgs/KeyPoint2D.msg")),
    ("yolo_msgs/KeyPoint2DArray", include_str!("../../msg/ros/yolo_msgs/KeyPoint2DArray.msg")),
    ("yolo_msgs/KeyPoint3D", include_str!("../../msg/ros/yolo_msgs/KeyPoint3D.msg")),
    ("yolo_msgs/KeyPoint3DArray", include_str!("../../msg/ros/yolo_msgs/KeyPoint3DArray.msg")),
    ("yolo_msgs/Detection", include_str!("../../msg/ros/yolo_msgs/Detection.msg")),
    ("yolo_msgs/DetectionArray", include_str!("../../msg/ros/yolo_msgs/DetectionArray.msg")),
    ("foxglove_msgs/Color", include_str!("../../msg/ros/foxglove_msgs/Color.msg")),
    ("foxglove_msgs/Point2", include_str!("../../msg/ros/foxglove_msgs/Point2.msg")),
    (
        "foxglove_msgs/CircleAnnotation",
        include_str!("../../msg/ros/foxglove_msgs/CircleAnnotation.msg"),
    ),
    (
        "foxglove_msgs/PointsAnnotation",
        include_str!("../../msg/ros/foxglove_msgs/PointsAnnotation.msg"),
    ),
    (
        "foxglove_msgs/TextAnnotation",
        include_str!("../../msg/ros/foxglove_msgs/TextAnnotation.msg"),
    ),
    (
        "foxglove_msgs/ImageAnnotations",
        include_str!("../../msg/ros/foxglove_msgs/ImageAnnotations.msg"),
    ),
];
