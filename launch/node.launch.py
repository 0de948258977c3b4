"""The node alone: ros2 launch ellipsoid_slam node.launch.py config:=/my/parameters.yaml"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    defaults = PathJoinSubstitution(
        [FindPackageShare("ellipsoid_slam"), "config", "ellipsoid_slam.yaml"]
    )
    return LaunchDescription(
        [
            DeclareLaunchArgument("config", default_value=defaults, description="parameter file"),
            DeclareLaunchArgument("use_sim_time", default_value="false"),
            DeclareLaunchArgument("log_level", default_value="info"),
            Node(
                package="ellipsoid_slam",
                executable="ellipsoid_slam",
                name="ellipsoid_slam",
                arguments=["node"],
                ros_arguments=["--log-level", LaunchConfiguration("log_level")],
                parameters=[
                    LaunchConfiguration("config"),
                    {"use_sim_time": LaunchConfiguration("use_sim_time")},
                ],
                output="screen",
            ),
        ]
    )
