"""Runs the launch files with a stand-in for ROS 2's `launch` and `launch_ros`, which no package index here has.

It knows what they use: arguments with their scopes, conditions, includes, nodes and functions. So names that do not exist, and what
the node would be started with, are seen; what the real ones think of it is not.
"""

import re
import sys
import types
from pathlib import Path

ROOT = Path(__file__).parents[2]
SHARE = "share:ellipsoid_slam"


class Context(dict):
    """Arguments that are set, and what was started."""

    def __init__(self, given, started):
        super().__init__(given)
        self.started = started


def text(value, context):
    if isinstance(value, (list, tuple)):
        return "".join(text(part, context) for part in value)
    return value.perform(context) if hasattr(value, "perform") else str(value)


def substitution(compute):
    class Substitution:
        def __init__(self, *given):
            self.given = given

        def perform(self, context):
            return compute(context, *self.given)

    return Substitution


LaunchConfiguration = substitution(lambda context, name: context[name])
FindPackageShare = substitution(lambda context, package: f"share:{package}")
PathJoinSubstitution = substitution(lambda context, parts: "/".join(text(part, context) for part in parts))
PythonExpression = substitution(lambda context, parts: str(eval(text(parts, context))))
PythonLaunchDescriptionSource = substitution(lambda context, path: text(path, context))
IfCondition = substitution(lambda context, what: text(what, context).lower() in ("true", "1"))


class DeclareLaunchArgument:
    def __init__(self, name, default_value=None, description=""):
        assert description, f"{name} says nothing of itself"
        self.name, self.default = name, default_value

    def run(self, context):
        if self.name not in context:
            assert self.default is not None, f"the argument {self.name} is missing"
            context[self.name] = text(self.default, context)


class OpaqueFunction:
    def __init__(self, function):
        self.function = function

    def run(self, context):
        run_all(self.function(context), context)


class Conditional:
    def run(self, context):
        if self.condition is None or self.condition.perform(context):
            self.act(context)


class GroupAction(Conditional):
    def __init__(self, actions, condition=None):
        self.actions, self.condition = actions, condition

    def act(self, context):
        run_all(self.actions, Context(context, context.started))


class IncludeLaunchDescription(Conditional):
    def __init__(self, source, launch_arguments=(), condition=None):
        self.source, self.arguments, self.condition = source, list(launch_arguments), condition

    def act(self, context):
        for name, value in self.arguments:
            context[name] = text(value, context)
        path = self.source.perform(context)
        if not path.startswith(SHARE):
            # Another package's may declare whatever it likes.
            context["namespace"] = "theirs"
            context.started.append((path, {name: context[name] for name, _ in self.arguments}))
            return
        described = load(ROOT / path.removeprefix(f"{SHARE}/"))
        declared = {action.name for action in described if isinstance(action, DeclareLaunchArgument)}
        for name, _ in self.arguments:
            assert name in declared, f"{path} has no argument {name}"
        run_all(described, context)


class Node(Conditional):
    def __init__(self, package, executable, condition=None, **more):
        self.package, self.executable, self.condition, self.more = package, executable, condition, more

    def act(self, context):
        parameters = {}
        for given in self.more.get("parameters", []):
            if isinstance(given, dict):
                parameters.update({name: v if isinstance(v, bool) else text(v, context) for name, v in given.items()})
            else:
                check_share(text(given, context))
                parameters["file"] = text(given, context)
        arguments = [text(a, context) for a in self.more.get("arguments", []) + self.more.get("ros_arguments", [])]
        for argument in arguments:
            check_share(argument)
        namespace = text(self.more.get("namespace", ""), context)
        context.started.append((self.executable, {"arguments": arguments, "namespace": namespace, **parameters}))
        if self.package == "ellipsoid_slam":
            unknown = set(parameters) - KEYS - {"file"}
            assert not unknown, f"the node has no parameters {unknown}"


def check_share(path):
    if path.startswith(SHARE):
        assert (ROOT / path.removeprefix(f"{SHARE}/")).is_file(), path


def module(name, **content):
    sys.modules[name] = types.ModuleType(name)
    sys.modules[name].__dict__.update(content)


module("launch", LaunchDescription=list)
module(
    "launch.actions",
    DeclareLaunchArgument=DeclareLaunchArgument,
    GroupAction=GroupAction,
    IncludeLaunchDescription=IncludeLaunchDescription,
    OpaqueFunction=OpaqueFunction,
)
module("launch.conditions", IfCondition=IfCondition)
module("launch.launch_description_sources", PythonLaunchDescriptionSource=PythonLaunchDescriptionSource)
module(
    "launch.substitutions",
    LaunchConfiguration=LaunchConfiguration,
    PathJoinSubstitution=PathJoinSubstitution,
    PythonExpression=PythonExpression,
)
module("launch_ros", actions=None)
module("launch_ros.actions", Node=Node)
module("launch_ros.substitutions", FindPackageShare=FindPackageShare)


def load(path):
    scope = {}
    exec(compile(path.read_text(), path, "exec"), scope)
    return scope["generate_launch_description"]()


def run_all(actions, context):
    for action in actions:
        action.run(context)


def launched(name, **given):
    context = Context(given, [])
    run_all(load(ROOT / "launch" / f"{name}.launch.py"), context)
    return context.started


def keys():
    """Names of all parameters, by the indentation of the shipped file."""
    path, found = [], set()
    for line in (ROOT / "config/ellipsoid_slam.yaml").read_text().splitlines():
        if match := re.match(r"( *)([^\s#:]+):", line):
            depth = len(match[1]) // 2
            path[depth:] = [match[2]]
            found.add(".".join(path[2:]))
    return found


KEYS = keys()
[(program, node)] = launched("node")
assert (program, node["arguments"]) == ("ellipsoid_slam", ["node", "--log-level", "info"]), node
assert node["use_sim_time"] is False and set(node) == {"arguments", "namespace", "file", "use_sim_time"}, node
asked = dict(namespace="robot1", depth="/d", rgb="/c", camera_info="/i", odometry="/o", detections="/b", base_frame="base")
[(_, node), (viewer, _)] = launched("node", map="/m.json", rviz="true", use_sim_time="true", model="/m.onnx", **asked)
assert viewer == "rviz2" and node["namespace"] == "robot1" and node["use_sim_time"] is True, node
assert (node["map.file"], node["map.load_on_start"], node["map.save_on_shutdown"]) == ("/m.json", True, True), node
assert (node["topics.depth"], node["detector.model"], node["sync.base_frame"]) == ("/d", "/m.onnx", "base"), node
[(_, node)] = launched("node", localizer="true")
assert node["file"].endswith("config/nav2.yaml"), node
[(_, node), (_, player)] = launched("play", bag="/my/bag")
assert node["use_sim_time"] is True and player["arguments"][:3] == ["play", "/my/bag", "--clock"], player
[(driver, settings), (odometry, _), (_, node), (viewer, _)] = launched("realsense", model="/m.onnx")
assert driver.startswith("share:realsense2_camera/") and settings["align_depth.enable"] == "true", settings
assert (odometry, viewer, node["namespace"], node["detector.model"]) == ("rgbd_odometry", "rviz2", "", "/m.onnx"), node
assert node["file"].endswith("config/realsense.yaml"), node
[(_, node)] = launched("realsense", model="/m.onnx", camera="false", visual_odometry="false", rviz="false")
[(_, node), _] = launched("turtlebot4", model="/m.onnx")
assert node["detector.model"] == "/m.onnx" and node["file"].endswith("config/turtlebot4.yaml"), node
[(detector, settings), (_, node), _] = launched("turtlebot4", model="yolov8n.pt", yolo="true")
assert detector.startswith("share:yolo_bringup/") and settings["model"] == "yolov8n.pt", settings
assert "detector.model" not in node and node["namespace"] == "", node
print("the launch files start what they should")
