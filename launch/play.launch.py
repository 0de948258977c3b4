"""The node on a bag, as if it were live: ros2 launch ellipsoid_slam play.launch.py bag:=/my/bag rviz:=true

Takes the arguments of node.launch.py, too.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    node = PathJoinSubstitution([FindPackageShare("ellipsoid_slam"), "launch", "node.launch.py"])
    return LaunchDescription(
        [
            DeclareLaunchArgument("bag", description="a file or a folder of rosbag2"),
            DeclareLaunchArgument("rate", default_value="1.0", description="times real time"),
            IncludeLaunchDescription(
                PythonLaunchDescriptionSource(node),
                launch_arguments={"use_sim_time": "true"}.items(),
            ),
            Node(
                package="ellipsoid_slam",
                executable="ellipsoid_slam",
                arguments=["play", LaunchConfiguration("bag"), "--clock", "--rate", LaunchConfiguration("rate")],
                output="screen",
            ),
        ]
    )
