"""Sends a robot to the nearest object of a label: python3 examples/go_to.py chair

Asks ellipsoid_slam for a pose that faces the object with nothing in the way, and Nav2 to drive there. Ends with 0 when it has
arrived, or with a sentence that says why it has not.
"""

import sys

import rclpy
from action_msgs.msg import GoalStatus
from ellipsoid_slam.srv import ApproachObject
from nav2_msgs.action import NavigateToPose
from rclpy.action import ActionClient

PATIENCE_S = 10.0


def result_of(node, future):
    rclpy.spin_until_future_complete(node, future)
    return future.result()


def go_to(node, label):
    """Drives to the nearest object of the label; the object's id."""
    map_client = node.create_client(ApproachObject, "/ellipsoid_slam/approach_object")
    if not map_client.wait_for_service(timeout_sec=PATIENCE_S):
        sys.exit("nobody offers /ellipsoid_slam/approach_object: does the node run?")
    place = result_of(node, map_client.call_async(ApproachObject.Request(label=label)))
    if not place.success:
        sys.exit(place.message)
    at = place.pose.pose.position
    node.get_logger().info(f"{label} {place.id}: driving to ({at.x:.2f}, {at.y:.2f})")

    navigation = ActionClient(node, NavigateToPose, "/navigate_to_pose")
    if not navigation.wait_for_server(timeout_sec=PATIENCE_S):
        sys.exit("nobody offers /navigate_to_pose: does Nav2 run?")
    goal = result_of(node, navigation.send_goal_async(NavigateToPose.Goal(pose=place.pose)))
    if not goal.accepted:
        sys.exit("Nav2 does not take the goal")
    if result_of(node, goal.get_result_async()).status != GoalStatus.STATUS_SUCCEEDED:
        sys.exit("Nav2 has not arrived")
    return place.id


def main():
    if len(sys.argv) != 2:
        sys.exit("which object? for instance: go_to.py chair")
    rclpy.init()
    node = rclpy.create_node("go_to")
    number = go_to(node, sys.argv[1])
    node.get_logger().info(f"before {sys.argv[1]} {number}")


if __name__ == "__main__":
    main()
