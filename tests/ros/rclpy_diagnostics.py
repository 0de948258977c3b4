"""Waits until diagnostics have had each of the sentences given, or one of `key=at least` among their values.

With --calibration WIDTH HEIGHT FRAME it publishes camera infos for such images meanwhile.
"""

import argparse
import sys
import time

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from sensor_msgs.msg import CameraInfo

arguments = argparse.ArgumentParser()
arguments.add_argument("words", nargs="+")
arguments.add_argument("--calibration", nargs=3)
given = arguments.parse_args()
missing = set(given.words)
rclpy.init()
node = rclpy.create_node("diagnostics_peer")


def is_there(words, status):
    key, equals, least = words.rpartition("=")
    if equals:
        return any(pair.key == key and int(pair.value) >= int(least) for pair in status.values)
    return words in status.message


def take(array):
    for status in array.status:
        missing.difference_update([words for words in missing if is_there(words, status)])


node.create_subscription(DiagnosticArray, "/diagnostics", take, 10)
if given.calibration:
    width, height, frame = given.calibration
    camera_info = node.create_publisher(CameraInfo, "/another/camera_info", 10)
    info = CameraInfo(width=int(width), height=int(height), distortion_model="plumb_bob", d=[0.0] * 5)
    info.header.frame_id = frame
    info.k = [5.0, 0.0, 4.0, 0.0, 5.0, 3.0, 0.0, 0.0, 1.0]
    info.p = [5.0, 0.0, 4.0, 0.0, 0.0, 5.0, 3.0, 0.0, 0.0, 0.0, 1.0, 0.0]
    node.create_timer(0.05, lambda: camera_info.publish(info))
end = time.monotonic() + 60.0
while missing:
    if time.monotonic() > end:
        sys.exit(f"not in diagnostics: {missing}")
    rclpy.spin_once(node, timeout_sec=0.1)
