"""A TurtleBot 4 with its OAK-D: ros2 launch ellipsoid_slam turtlebot4.launch.py model:=/my/yolox_s.onnx

The node with the detector in it, and RViz. With yolo:=true yolo_ros is the detector instead, and model is its own: an ONNX file,
or a name as yolov8n.pt where its version loads those. The robot's own launch files run on the robot; this runs there or on a workstation.
Takes the arguments of node.launch.py, too.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction, IncludeLaunchDescription
from launch.conditions import IfCondition
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution, PythonExpression
from launch_ros.substitutions import FindPackageShare


def included(package, *path):
    return PythonLaunchDescriptionSource(PathJoinSubstitution([FindPackageShare(package), *path]))


def generate_launch_description():
    model, yolo = LaunchConfiguration("model"), LaunchConfiguration("yolo")
    config = PathJoinSubstitution([FindPackageShare("ellipsoid_slam"), "config", "turtlebot4.yaml"])
    own_model = PythonExpression(["'' if '", yolo, "'.lower() == 'true' else '", model, "'"])
    return LaunchDescription(
        [
            DeclareLaunchArgument("model", description="ONNX model that finds the boxes: docs/detectors.md"),
            DeclareLaunchArgument("yolo", default_value="false", description="start yolo_ros with the model"),
            DeclareLaunchArgument("config", default_value=config, description="parameter file"),
            DeclareLaunchArgument("rviz", default_value="true", description="start RViz"),
            # What another file calls its arguments stays in its group: `namespace` and `model` are ours, too.
            GroupAction(
                [
                    IncludeLaunchDescription(
                        included("yolo_bringup", "launch", "yolo.launch.py"),
                        launch_arguments={
                            "model": model,
                            "namespace": "yolo",
                            "input_image_topic": "/oakd/rgb/preview/image_raw",
                            "use_tracking": "False",
                            "use_3d": "False",
                        }.items(),
                    )
                ],
                condition=IfCondition(yolo),
            ),
            IncludeLaunchDescription(
                included("ellipsoid_slam", "launch", "node.launch.py"),
                launch_arguments={
                    "config": LaunchConfiguration("config"),
                    "model": own_model,
                    "rviz": LaunchConfiguration("rviz"),
                }.items(),
            ),
        ]
    )
