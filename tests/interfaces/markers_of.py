"""The last markers, way, annotated image and points of a result bag as JSON: markers_of.py BAG."""

import base64
import io
import json
import sys

from mcap_ros2.reader import read_ros2_messages
from PIL import Image

NODE = "/ellipsoid_slam"


def last(topic):
    messages = list(read_ros2_messages(sys.argv[1], topics=[f"{NODE}/{topic}"]))
    return messages[-1].ros_msg if messages else None


def values(message, names):
    return [getattr(message, name) for name in names]


rows = [
    {
        "ns": marker.ns, "id": marker.id, "type": marker.type, "action": marker.action, "text": marker.text,
        "position": values(marker.pose.position, "xyz"), "orientation": values(marker.pose.orientation, "xyzw"),
        "scale": values(marker.scale, "xyz"), "color": values(marker.color, "rgba"),
        "points": [values(point, "xyz") for point in marker.points],
    }
    for marker in last("markers").markers
]  # fmt: skip
path = [values(pose.pose.position, "xyz") for pose in last("path").poses]
image = last("debug_image/compressed")
picture = None
if image:
    pixels = Image.open(io.BytesIO(bytes(image.data))).convert("RGB")
    picture = {"size": pixels.size, "rgb": base64.b64encode(pixels.tobytes()).decode()}
cloud = last("points")
points = None
if cloud:
    points = {"count": cloud.width, "step": cloud.point_step, "data": base64.b64encode(bytes(cloud.data)).decode()}
    points["fields"] = [[field.name, field.offset, field.datatype, field.count] for field in cloud.fields]
print(json.dumps({"markers": rows, "path": path, "image": picture, "points": points}))
