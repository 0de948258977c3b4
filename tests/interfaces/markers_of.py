"""The last markers of a result bag as JSON: markers_of.py BAG."""

import json
import sys

from mcap_ros2.reader import read_ros2_messages

last = list(read_ros2_messages(sys.argv[1], topics=["/ellipsoid_slam/markers"]))[-1].ros_msg


def values(message, names):
    return [getattr(message, name) for name in names]


rows = [
    {
        "ns": marker.ns, "id": marker.id, "type": marker.type, "action": marker.action, "text": marker.text,
        "position": values(marker.pose.position, "xyz"), "orientation": values(marker.pose.orientation, "xyzw"),
        "scale": values(marker.scale, "xyz"), "color": values(marker.color, "rgba"),
    }
    for marker in last.markers
]  # fmt: skip
print(json.dumps(rows))
