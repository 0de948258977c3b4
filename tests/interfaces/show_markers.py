"""Publishes markers of a JSON file in ROS 1, for its RViz: show_markers.py FILE. Runs in the system's Python."""

import json
import sys

import rospy
from geometry_msgs.msg import Point, Pose, Quaternion, Vector3
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

rows = json.load(open(sys.argv[1]))
rospy.init_node("relay", disable_signals=True)
publisher = rospy.Publisher("/ellipsoid_slam/markers", MarkerArray, queue_size=1, latch=True)
markers = []
for row in rows:
    marker = Marker(ns=row["ns"], id=row["id"], type=row["type"], action=row["action"], text=row["text"])
    marker.header.frame_id = "map"
    marker.pose = Pose(Point(*row["position"]), Quaternion(*row["orientation"]))
    marker.scale, marker.color = Vector3(*row["scale"]), ColorRGBA(*row["color"])
    markers.append(marker)
publisher.publish(MarkerArray(markers))
rospy.spin()
