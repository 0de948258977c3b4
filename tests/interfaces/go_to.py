"""The example that sends a robot to the nearest chair, with the node on the demo bag and a stand-in for Nav2.

Given the program.
"""

import math
import os
import subprocess
import sys
import threading
from pathlib import Path

import rclpy
from nav2_msgs.action import NavigateToPose
from rclpy.action import ActionServer
from rclpy.executors import SingleThreadedExecutor

ROOT = Path(__file__).parents[2]
os.environ.update(ROS_DOMAIN_ID="77", ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST")
ARGS = """-r depth:=/camera/aligned_depth_to_color/image_raw -p topics.depth_transport:=compressedDepth
  -r camera_info:=/camera/color/camera_info -p topics.depth_camera_info:='' -r detections:=/detections -r odometry:=/odom"""
goals = []


def drive(goal):
    goals.append(goal.request.pose)
    goal.succeed()
    return NavigateToPose.Result()


rclpy.init()
node = rclpy.create_node("stand_in")
server = ActionServer(node, NavigateToPose, "/navigate_to_pose", drive)
executor = SingleThreadedExecutor()
executor.add_node(node)
spinning = threading.Thread(target=executor.spin)
spinning.start()
program = sys.argv[1]
slam = subprocess.Popen([program, "node", "--ros-args", *ARGS.split()])
try:
    play = [program, "play", str(ROOT / "bags/desk.mcap"), "--rate", "6", "--wait", "60"]
    subprocess.run(play, check=True, timeout=120)
    go_to = [sys.executable, str(ROOT / "examples/go_to.py")]
    subprocess.run([*go_to, "chair"], check=True, timeout=60)
    nothing = subprocess.run([*go_to, "unicorn"], timeout=60, capture_output=True, text=True)
finally:
    slam.terminate()
    slam.wait(20)
    executor.shutdown()
    spinning.join()
    server.destroy()
    node.destroy_node()
    rclpy.shutdown()
assert nothing.returncode == 1 and "nothing is called `unicorn`" in nothing.stderr, nothing
[goal] = goals
assert goal.header.frame_id == "map", goal
q = goal.pose.orientation
assert abs(math.hypot(q.z, q.w) - 1.0) < 1e-6 and abs(goal.pose.position.z) < 0.1, goal
print(f"the nearest chair: Nav2 was sent to ({goal.pose.position.x:.2f}, {goal.pose.position.y:.2f})")
