"""Says when the node is in the graph, and when it no longer is."""

import time

import rclpy

rclpy.init()
node = rclpy.create_node("graph_peer")


def wait_until(is_there):
    end = time.monotonic() + 60.0
    while ("ellipsoid_slam" in node.get_node_names()) != is_there:
        assert time.monotonic() < end
        time.sleep(0.02)


wait_until(True)
print("it is there", flush=True)
wait_until(False)
print("it is gone", flush=True)
