"""Pauses and resets a node that has a map: nothing is worked on in between, and each marker is deleted.

Before that, a debug image has to come.
"""

import sys
import time

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import Image
from std_srvs.srv import SetBool, Trigger
from visualization_msgs.msg import Marker, MarkerArray

NODE = "/ellipsoid_slam"
rclpy.init()
node = rclpy.create_node("reset_peer")
shown, colors, values, images = set(), set(), {}, []


def take_markers(array):
    for m in array.markers:
        (shown.add if m.action == Marker.ADD else shown.discard)((m.ns, m.id))
        if m.ns == "objects" and m.action == Marker.ADD:
            colors.add(tuple(round(255 * part) for part in (m.color.r, m.color.g, m.color.b)))


def take_diagnostics(array):
    for status in array.status:
        values.update({pair.key: pair.value for pair in status.values})


latched = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
node.create_subscription(MarkerArray, f"{NODE}/markers", take_markers, latched)
node.create_subscription(Image, f"{NODE}/debug_image", images.append, 10)
node.create_subscription(DiagnosticArray, "/diagnostics", take_diagnostics, 10)


def wait_for(what, condition):
    end = time.monotonic() + 60.0
    while not condition():
        if time.monotonic() > end:
            sys.exit(f"{what} did not come: {shown} {values}")
        rclpy.spin_once(node, timeout_sec=0.1)


def call(kind, name, **request):
    client = node.create_client(kind, name)
    wait_for(f"the service {name}", client.service_is_ready)
    future = client.call_async(kind.Request(**request))
    wait_for(f"the answer of {name}", future.done)
    assert future.result().success, future.result()


wait_for("markers", lambda: any(ns == "objects" for ns, _ in shown))
wait_for("a debug image", lambda: images)
image = images[0]
assert (image.encoding, len(image.data)) == ("rgb8", 3 * image.width * image.height), image.encoding
# Boxes and outlines are drawn in the colours of the markers, to the last bit of the conversion from floats.
pixels = set(zip(image.data[0::3], image.data[1::3], image.data[2::3]))
drawn = [c for c in colors if any(max(abs(a - b) for a, b in zip(c, p)) <= 1 for p in pixels)]
assert len(drawn) >= 5, (colors, len(pixels))
call(SetBool, f"{NODE}/pause", data=True)
wait_for("paused", lambda: values.get("paused") == "true")
before = values["frames"]
end = time.monotonic() + 2.0
wait_for("the end of the pause", lambda: time.monotonic() > end)
assert values["frames"] == before, values
call(Trigger, f"{NODE}/reset")
wait_for("no markers", lambda: not shown)
wait_for("no objects", lambda: values["objects"] == "0")
call(SetBool, f"{NODE}/pause", data=False)
wait_for("going on", lambda: values["paused"] == "false" and int(values["frames"]) > int(before))
wait_for("markers again", lambda: any(ns == "objects" for ns, _ in shown))
