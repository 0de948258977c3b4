"""A TurtleBot 4 with its OAK-D and yolo_ros as the detector, and RViz: ros2 launch ellipsoid_slam turtlebot4.launch.py

The robot's own launch files run on the robot; this runs there or on a workstation.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.conditions import IfCondition
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    share = FindPackageShare("ellipsoid_slam")
    node = PathJoinSubstitution([share, "launch", "node.launch.py"])
    detector = PathJoinSubstitution([FindPackageShare("yolo_bringup"), "launch", "yolo.launch.py"])
    return LaunchDescription(
        [
            DeclareLaunchArgument("detector", default_value="true", description="start yolo_ros"),
            DeclareLaunchArgument("model", default_value="yolov8n.pt"),
            DeclareLaunchArgument("rviz", default_value="true", description="start RViz"),
            IncludeLaunchDescription(
                PythonLaunchDescriptionSource(node),
                launch_arguments={
                    "config": PathJoinSubstitution([share, "config", "turtlebot4.yaml"])
                }.items(),
            ),
            IncludeLaunchDescription(
                PythonLaunchDescriptionSource(detector),
                condition=IfCondition(LaunchConfiguration("detector")),
                launch_arguments={
                    "model": LaunchConfiguration("model"),
                    "input_image_topic": "/oakd/rgb/preview/image_raw",
                    "use_tracking": "False",
                    "use_3d": "False",
                }.items(),
            ),
            Node(
                package="rviz2",
                executable="rviz2",
                arguments=[
                    "-d",
                    PathJoinSubstitution([share, "config", "ellipsoid_slam.rviz"]),
                ],
                condition=IfCondition(LaunchConfiguration("rviz")),
            ),
        ]
    )
