"""A RealSense D400 with everything round it: ros2 launch ellipsoid_slam realsense.launch.py model:=/my/yolox_s.onnx

The camera, its odometry (rtabmap_odom; visual_odometry:=false where the robot has its own), the node with the detector in it,
and RViz. Takes the arguments of node.launch.py, too.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction, IncludeLaunchDescription
from launch.conditions import IfCondition
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

CAMERA = "/camera/camera"


def included(package, *path):
    return PythonLaunchDescriptionSource(PathJoinSubstitution([FindPackageShare(package), *path]))


def generate_launch_description():
    config = PathJoinSubstitution([FindPackageShare("ellipsoid_slam"), "config", "realsense.yaml"])
    return LaunchDescription(
        [
            DeclareLaunchArgument("model", description="ONNX model that finds the boxes: docs/detectors.md"),
            DeclareLaunchArgument("config", default_value=config, description="parameter file"),
            DeclareLaunchArgument("camera", default_value="true", description="start the camera's driver"),
            DeclareLaunchArgument("visual_odometry", default_value="true", description="start rtabmap_odom"),
            DeclareLaunchArgument("rviz", default_value="true", description="start RViz"),
            # What another file calls its arguments stays in its group.
            GroupAction(
                [
                    IncludeLaunchDescription(
                        included("realsense2_camera", "launch", "rs_launch.py"),
                        launch_arguments={"align_depth.enable": "true", "enable_sync": "true"}.items(),
                    )
                ],
                condition=IfCondition(LaunchConfiguration("camera")),
            ),
            Node(
                package="rtabmap_odom",
                executable="rgbd_odometry",
                condition=IfCondition(LaunchConfiguration("visual_odometry")),
                parameters=[{"frame_id": "camera_link", "approx_sync": True}],
                remappings=[
                    ("rgb/image", f"{CAMERA}/color/image_raw"),
                    ("rgb/camera_info", f"{CAMERA}/color/camera_info"),
                    ("depth/image", f"{CAMERA}/aligned_depth_to_color/image_raw"),
                ],
                output="screen",
            ),
            IncludeLaunchDescription(
                included("ellipsoid_slam", "launch", "node.launch.py"),
                launch_arguments={
                    "config": LaunchConfiguration("config"),
                    "model": LaunchConfiguration("model"),
                    "rviz": LaunchConfiguration("rviz"),
                }.items(),
            ),
        ]
    )
