"""A ROS 2 user after a bag was played: the latched map, diagnostics, parameters and services.

Writes the markers to the file given. Fails with a sentence when something does not come in time.
"""

import json
import sys
import time

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from marker_summary import summary
from nav_msgs.msg import OccupancyGrid, Path
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_srvs.srv import SetBool
from visualization_msgs.msg import Marker, MarkerArray

PATIENCE_S = 60.0
NODE = "/ellipsoid_slam"

rclpy.init()
node = rclpy.create_node("peer")


def wait_for(what, condition):
    end = time.monotonic() + PATIENCE_S
    while not condition():
        if time.monotonic() > end:
            sys.exit(f"{what} did not come")
        rclpy.spin_once(node, timeout_sec=0.1)


class Latest:
    def __init__(self, kind, topic, latched=False):
        durability = DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE
        self.message = None
        self.name = topic
        node.create_subscription(kind, topic, self.take, QoSProfile(depth=10, durability=durability))

    def take(self, message):
        self.message = message

    def wait(self, condition=lambda message: True):
        wait_for(f"{self.name}", lambda: self.message is not None and condition(self.message))
        return self.message


def call(kind, name, **request):
    client = node.create_client(kind, name)
    wait_for(f"the service {name}", lambda: client.service_is_ready())
    future = client.call_async(kind.Request(**request))
    wait_for(f"the answer of {name}", future.done)
    return future.result()


def values(status):
    return {pair.key: pair.value for pair in status.values}


diagnostics = Latest(DiagnosticArray, "/diagnostics")
# The worker has done all it can when the number of frames no longer grows.
array = diagnostics.wait(lambda a: any(int(values(s).get("frames", 0)) >= 29 for s in a.status))
mapping = [s for s in array.status if s.name.endswith("mapping")][0]
assert int(values(mapping)["objects"]) > 0, values(mapping)
assert values(mapping)["dropped: overflow"] == "0", values(mapping)


def is_whole(array):
    """Whether all objects are marked that diagnostics count."""
    counted = [values(s)["objects"] for s in diagnostics.message.status if s.name.endswith("mapping")]
    return [str(sum(m.ns == "objects" and m.action == Marker.ADD for m in array.markers))] == counted


# This subscriber comes late: all images are through.
markers = Latest(MarkerArray, f"{NODE}/markers", latched=True).wait(is_whole)


def cell(grid, x, y):
    """As any reader of a costmap computes it."""
    origin = grid.info.origin.position
    column, row = ((v - low) // grid.info.resolution for v, low in ((x, origin.x), (y, origin.y)))
    inside = 0 <= column < grid.info.width and 0 <= row < grid.info.height
    return grid.data[int(row) * grid.info.width + int(column)] if inside else None


def covers_all(grid):
    assert grid.header.frame_id == "map" and len(grid.data) == grid.info.width * grid.info.height, grid.info
    assert set(grid.data) <= {-1, 100}
    centres = [m.pose.position for m in markers.markers if m.ns == "objects" and m.action == Marker.ADD]
    return all(cell(grid, at.x, at.y) == 100 for at in centres)


Latest(OccupancyGrid, f"{NODE}/costmap", latched=True).wait(covers_all)
path = Latest(Path, f"{NODE}/path", latched=True).wait(lambda path: len(path.poses) > 5)
assert path.header.frame_id == "map"
with open(sys.argv[1], "w") as file:
    json.dump(summary(markers), file)

# Parameters.
names = call(ListParameters, f"{NODE}/list_parameters").result.names
assert "publish_tf" in names and "map_frame" in names, names
names = call(ListParameters, f"{NODE}/list_parameters", prefixes=["mapping"], depth=0).result.names
assert "mapping.min_observations" in names and "publish_tf" not in names, names
got = call(GetParameters, f"{NODE}/get_parameters", names=["sync.slop_s", "map_frame", "no.such"]).values
assert got[0].double_value == 0.02 and got[1].string_value == "map", got
assert got[2].type == ParameterType.PARAMETER_NOT_SET, got
described = call(DescribeParameters, f"{NODE}/describe_parameters", names=["sync.slop_s", "map_frame"]).descriptors
assert described[0].description and described[0].floating_point_range[0].to_value == 1.0, described
assert not described[0].read_only and described[1].read_only, described


def double(name, value):
    kind = ParameterType.PARAMETER_DOUBLE
    return Parameter(name=name, value=ParameterValue(type=kind, double_value=value))


def text(name, value):
    kind = ParameterType.PARAMETER_STRING
    return Parameter(name=name, value=ParameterValue(type=kind, string_value=value))


wanted = [double("sync.slop_s", 0.03), double("sync.slop_s", 7.0), text("map_frame", "world"), double("sync.slap", 1.0)]
results = call(SetParameters, f"{NODE}/set_parameters", parameters=wanted).results
assert [r.successful for r in results] == [True, False, False, False], results
assert "between" in results[1].reason and "start" in results[2].reason and "sync.slop_s" in results[3].reason, results
got = call(GetParameters, f"{NODE}/get_parameters", names=["sync.slop_s"]).values
assert got[0].double_value == 0.03, got

# What would end a node is refused, and the node goes on.
def numbers(name, values):
    value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE_ARRAY, double_array_value=values)
    return Parameter(name=name, value=value)


size = "perception.classes.listed.tv.size_m"
sizes = [[-0.9, 0.2, 0.6], [0.13, 0.44, 0.03], [1e300, 0.2, 0.6], [float("nan"), 0.2, 0.6], [0.9, 0.2]]
wanted = [numbers(size, values) for values in sizes]
wanted += [double("perception.max_boxes", -1.0), double("sync.slop_s", float("nan")), text("map.file", "/etc/passwd")]
results = call(SetParameters, f"{NODE}/set_parameters", parameters=wanted).results
assert not any(r.successful for r in results) and all(r.reason for r in results), results
assert results[0].reason.startswith(size) or size in results[0].reason, results[0]

# Services of std_srvs.
paused = call(SetBool, f"{NODE}/pause", data=True)
assert paused.success, paused
diagnostics.wait(lambda a: any(values(s).get("paused") == "true" for s in a.status))
assert call(SetBool, f"{NODE}/pause", data=False).success
