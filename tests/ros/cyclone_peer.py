"""A robot on Cyclone DDS: sends a bag's topics with /tf, /tf_static and /clock, receives objects, /tf and diagnostics."""

import sys
import time

from cyclone_messages import (
    CameraInfo,
    Clock,
    CompressedImage,
    Detection2DArray,
    Detection3DArray,
    DiagnosticArray,
    TFMessage,
    Time,
)
from cyclone_participant import LATCHED, PLAIN, reader, wait_for, writer
from cyclonedds.idl import IdlStruct
from mcap_ros2.reader import read_ros2_messages


def filled(kind, value):
    """A message of the bag's reader as one of the types above."""
    if isinstance(kind, type) and issubclass(kind, IdlStruct):
        fields = kind.__dataclass_fields__
        return kind(**{name: filled(field.type, getattr(value, name)) for name, field in fields.items()})
    inner = getattr(kind, "__metadata__", [None])[0]
    element = getattr(inner, "subtype", None)
    if isinstance(value, (bytes, bytearray, memoryview)):
        return list(bytes(value))
    if isinstance(value, (list, tuple)) or hasattr(value, "tolist"):
        items = value.tolist() if hasattr(value, "tolist") else value
        return [filled(element, item) for item in items] if element is not None else list(items)
    return value


KINDS = {
    "/camera/aligned_depth_to_color/image_raw/compressedDepth": CompressedImage,
    "/camera/color/camera_info": CameraInfo,
    "/detections": Detection2DArray,
    "/tf": TFMessage,
    "/tf_static": TFMessage,
}
writers = {topic: writer(topic, kind, LATCHED if topic == "/tf_static" else PLAIN) for topic, kind in KINDS.items()}
clock = writer("/clock", Clock)
objects = reader("/ellipsoid_slam/objects", Detection3DArray, LATCHED)
transforms = reader("/tf", TFMessage)
diagnostics = reader("/diagnostics", DiagnosticArray)

for topic, w in [*writers.items(), ("/clock", clock)]:
    if topic != "/tf":  # Our own reader hears it too.
        wait_for(f"a subscription of {topic}", lambda: w.get_matched_subscriptions())
wait_for("a subscription of /tf", lambda: len(writers["/tf"].get_matched_subscriptions()) > 1)

last = None
for m in read_ros2_messages(sys.argv[1], topics=list(KINDS)):
    kind = KINDS[m.channel.topic]
    stamp = m.log_time_ns
    if last is not None:
        time.sleep(min(max(stamp - last, 0) * 0.4e-9, 0.2))
    last = stamp
    clock.write(Clock(Time(stamp // 10**9, stamp % 10**9)))
    writers[m.channel.topic].write(filled(kind, m.ros_msg))

found, correction, sim_time = [], [], []


def heard():
    for array in objects.take(N=100):
        found[:] = [(d.id, d.results[0].hypothesis.class_id, d.bbox) for d in array.detections]
    for array in transforms.take(N=1000):
        correction.extend(t for t in array.transforms if (t.header.frame_id, t.child_frame_id) == ("map", "odom"))
    for array in diagnostics.take(N=100):
        sim_time.append(array.header.stamp.sec)
    return len(found) >= 5 and correction and sim_time and sim_time[-1] == last // 10**9


wait_for("objects, map -> odom and diagnostics in the bag's time", heard)
assert len({id for id, _, _ in found}) == len(found), found
assert {"chair", "keyboard"} & {label for _, label, _ in found}, found
for _, _, box in found:
    q = box.center.orientation
    assert abs(q.x**2 + q.y**2 + q.z**2 + q.w**2 - 1.0) < 1e-9 and 0.0 < box.size.x < 5.0, box
q = correction[-1].transform.rotation
assert abs(q.x**2 + q.y**2 + q.z**2 + q.w**2 - 1.0) < 1e-9, correction[-1]
