"""Waits until diagnostics speak of objects in the map."""

import sys
import time

import rclpy
from diagnostic_msgs.msg import DiagnosticArray

rclpy.init()
node = rclpy.create_node("peer")
counts = []


def take(array):
    for status in array.status:
        counts.extend(int(pair.value) for pair in status.values if pair.key == "objects")


node.create_subscription(DiagnosticArray, "/diagnostics", take, 10)
end = time.monotonic() + 60.0
while not any(counts):
    if time.monotonic() > end:
        sys.exit(f"no objects: {counts}")
    rclpy.spin_once(node, timeout_sec=0.1)
