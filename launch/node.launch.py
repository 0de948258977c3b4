"""The node alone, on demand with RViz: ros2 launch ellipsoid_slam node.launch.py model:=/my/yolox_s.onnx

`ros2 launch ellipsoid_slam node.launch.py --show-args` lists the arguments.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

TOPICS = {
    "rgb": "colour images",
    "depth": "depth images",
    "camera_info": "calibration of the colour camera",
    "odometry": "odometry",
    "detections": "2D boxes",
}


def given(context, name):
    return LaunchConfiguration(name).perform(context)


def start(context):
    """Arguments that are empty leave what the parameter file says."""
    parameters = {"use_sim_time": given(context, "use_sim_time").lower() == "true"}
    for topic in TOPICS:
        if given(context, topic):
            parameters[f"topics.{topic}"] = given(context, topic)
    if given(context, "model"):
        parameters["detector.model"] = given(context, "model")
    if given(context, "base_frame"):
        parameters["sync.base_frame"] = given(context, "base_frame")
    if given(context, "map"):
        parameters["map.file"] = given(context, "map")
        parameters["map.load_on_start"] = parameters["map.save_on_shutdown"] = True
    files = [given(context, "config")]
    if given(context, "localizer").lower() == "true":
        share = FindPackageShare("ellipsoid_slam").perform(context)
        files.append(f"{share}/config/nav2.yaml")
    node = Node(
        package="ellipsoid_slam",
        executable="ellipsoid_slam",
        name="ellipsoid_slam",
        namespace=given(context, "namespace"),
        arguments=["node"],
        ros_arguments=["--log-level", given(context, "log_level")],
        parameters=[*files, parameters],
        output="screen",
    )
    return [node]


def generate_launch_description():
    share = FindPackageShare("ellipsoid_slam")
    defaults = PathJoinSubstitution([share, "config", "ellipsoid_slam.yaml"])
    view = PathJoinSubstitution([share, "config", "ellipsoid_slam.rviz"])
    topics = [
        DeclareLaunchArgument(name, default_value="", description=f"topic of {what}; empty: found or as config says")
        for name, what in TOPICS.items()
    ]
    return LaunchDescription(
        [
            DeclareLaunchArgument("config", default_value=defaults, description="parameter file"),
            DeclareLaunchArgument("namespace", default_value="", description="of the node and of topics without a slash"),
            *topics,
            DeclareLaunchArgument("model", default_value="", description="ONNX model that finds the boxes"),
            DeclareLaunchArgument("map", default_value="", description="map file: loaded at the start, saved at the end"),
            DeclareLaunchArgument("base_frame", default_value="", description="base frame where odometry comes from TF"),
            DeclareLaunchArgument(
                "localizer", default_value="false", description="AMCL or the like publishes map -> odom: config/nav2.yaml"
            ),
            DeclareLaunchArgument("rviz", default_value="false", description="start RViz"),
            DeclareLaunchArgument("use_sim_time", default_value="false", description="time comes from /clock"),
            DeclareLaunchArgument("log_level", default_value="info", description="debug, info, warn or error"),
            OpaqueFunction(function=start),
            Node(
                package="rviz2",
                executable="rviz2",
                arguments=["-d", view],
                parameters=[{"use_sim_time": LaunchConfiguration("use_sim_time")}],
                condition=IfCondition(LaunchConfiguration("rviz")),
            ),
        ]
    )
