"""The node on a bag, as if it were live: ros2 launch ellipsoid_slam play.launch.py bag:=/my/bag config:=/my/parameters.yaml"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    share = FindPackageShare("ellipsoid_slam")
    node = PathJoinSubstitution([share, "launch", "node.launch.py"])
    defaults = PathJoinSubstitution([share, "config", "ellipsoid_slam.yaml"])
    return LaunchDescription(
        [
            DeclareLaunchArgument("bag", description="an .mcap file or a rosbag2 folder"),
            DeclareLaunchArgument("config", default_value=defaults, description="parameter file"),
            DeclareLaunchArgument("rate", default_value="1.0", description="times real time"),
            IncludeLaunchDescription(
                PythonLaunchDescriptionSource(node),
                launch_arguments={
                    "config": LaunchConfiguration("config"),
                    "use_sim_time": "true",
                }.items(),
            ),
            Node(
                package="ellipsoid_slam",
                executable="ellipsoid_slam",
                arguments=[
                    "play",
                    LaunchConfiguration("bag"),
                    "--clock",
                    "--rate",
                    LaunchConfiguration("rate"),
                ],
                output="screen",
            ),
        ]
    )
