"""Publishes what a JSON file of markers_of.py has in ROS 1, for its RViz: show_markers.py FILE. Runs in the system's Python."""

import base64
import json
import sys

import rospy
from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion, Vector3
from nav_msgs.msg import Path
from sensor_msgs.msg import Image, PointCloud2, PointField
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

shown = json.load(open(sys.argv[1]))
rospy.init_node("relay", disable_signals=True)


def publisher(topic, kind):
    return rospy.Publisher(f"/ellipsoid_slam/{topic}", kind, queue_size=1, latch=True)


markers = []
for row in shown["markers"]:
    marker = Marker(ns=row["ns"], id=row["id"], type=row["type"], action=row["action"], text=row["text"])
    marker.header.frame_id = "map"
    marker.pose = Pose(Point(*row["position"]), Quaternion(*row["orientation"]))
    marker.scale, marker.color = Vector3(*row["scale"]), ColorRGBA(*row["color"])
    marker.points = [Point(*place) for place in row["points"]]
    markers.append(marker)
path = Path(poses=[PoseStamped(pose=Pose(Point(*place), Quaternion(0, 0, 0, 1))) for place in shown["path"]])
path.header.frame_id = "map"
publishers = [publisher("markers", MarkerArray), publisher("path", Path), publisher("debug_image", Image)]
publishers.append(publisher("points", PointCloud2))
publishers[0].publish(MarkerArray(markers))
publishers[1].publish(path)
if shown["image"]:
    width, height = shown["image"]["size"]
    image = Image(width=width, height=height, encoding="rgb8", step=3 * width, data=base64.b64decode(shown["image"]["rgb"]))
    image.header.frame_id = "map"
    publishers[2].publish(image)
if shown["points"]:
    count, step = shown["points"]["count"], shown["points"]["step"]
    cloud = PointCloud2(height=1, width=count, point_step=step, row_step=count * step, is_dense=True)
    cloud.fields = [PointField(*field) for field in shown["points"]["fields"]]
    cloud.data = base64.b64decode(shown["points"]["data"])
    cloud.header.frame_id = "map"
    publishers[3].publish(cloud)
rospy.spin()
