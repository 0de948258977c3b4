"""Manages a node that waits in `unconfigured` while a bag is played: activates it, pauses and resets it, deactivates it, cleans it up and shuts it down.

While it pauses or is not active nothing is worked on. When it is reset or cleaned up each marker is deleted. Before that, a debug image has to come.
"""

import sys
import time

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from lifecycle_msgs.msg import State, Transition, TransitionEvent
from lifecycle_msgs.srv import ChangeState, GetAvailableStates, GetAvailableTransitions, GetState
from nav_msgs.msg import Odometry
from rclpy.lifecycle import LifecycleNode
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import Image
from std_srvs.srv import SetBool, Trigger
from visualization_msgs.msg import Marker, MarkerArray

NODE = "/ellipsoid_slam"
rclpy.init()
node = rclpy.create_node("manager")
shown, colors, values, images, moves, poses = set(), set(), {}, [], [], []


def take_markers(array):
    for m in array.markers:
        (shown.add if m.action == Marker.ADD else shown.discard)((m.ns, m.id))
        if m.ns == "objects" and m.action == Marker.ADD:
            colors.add(tuple(round(255 * part) for part in (m.color.r, m.color.g, m.color.b)))


def take_diagnostics(array):
    for status in array.status:
        values.update({pair.key: pair.value for pair in status.values})


latched = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
node.create_subscription(MarkerArray, f"{NODE}/markers", take_markers, latched)
node.create_subscription(Image, f"{NODE}/debug_image", images.append, 10)
node.create_subscription(DiagnosticArray, "/diagnostics", take_diagnostics, 10)
node.create_subscription(TransitionEvent, f"{NODE}/transition_event", moves.append, 10)
node.create_subscription(Odometry, f"{NODE}/odometry", poses.append, 10)


def wait_for(what, condition):
    end = time.monotonic() + 60.0
    while not condition():
        if time.monotonic() > end:
            sys.exit(f"{what} did not come: {shown} {values}")
        rclpy.spin_once(node, timeout_sec=0.1)


# Made at once: it takes time until each is found.
clients = {
    name: node.create_client(kind, f"{NODE}/{name}")
    for name, kind in {
        "change_state": ChangeState,
        "get_state": GetState,
        "get_available_states": GetAvailableStates,
        "get_available_transitions": GetAvailableTransitions,
        "get_transition_graph": GetAvailableTransitions,
        "pause": SetBool,
        "reset": Trigger,
    }.items()
}


def ask(name, **request):
    client = clients[name]
    wait_for(f"the service {name}", client.service_is_ready)
    future = client.call_async(client.srv_type.Request(**request))
    wait_for(f"the answer of {name}", future.done)
    return future.result()


def call(name, **request):
    answer = ask(name, **request)
    assert answer.success, answer


def change(state, **transition):
    """Asks for a transition: whether it was made. The node is in this state then."""
    made = ask("change_state", transition=Transition(**transition)).success
    assert ask("get_state").current_state == state, state
    return made


def transitions(service):
    """As ROS 2's own state machine tells of them."""
    ways = [(w.transition, w.start_state, w.goal_state) for w in ask(service).available_transitions]
    return [tuple(part for one in way for part in (one.id, one.label)) for way in ways]


def rest(seconds):
    end = time.monotonic() + seconds
    wait_for("the end of the rest", lambda: time.monotonic() > end)


UNCONFIGURED, INACTIVE = State(id=1, label="unconfigured"), State(id=2, label="inactive")
ACTIVE, FINALIZED = State(id=3, label="active"), State(id=4, label="finalized")

# It waits, and says what can be done, as any such node does.
other = LifecycleNode("other")._state_machine
assert transitions("get_available_transitions") == other.available_transitions
graph = transitions("get_transition_graph")
assert len(graph) == 12 and set(graph) < set(other.transition_graph), graph
states = ask("get_available_states").available_states
assert {(state.id, state.label) for state in states} < set(other.available_states), states
assert not change(UNCONFIGURED, id=Transition.TRANSITION_ACTIVATE)
assert change(INACTIVE, id=Transition.TRANSITION_CONFIGURE)
assert [way[0] for way in transitions("get_available_transitions")] == [2, 3, 6]
depth_comes = lambda: any("depth" in key and value.endswith("ago") for key, value in values.items())
wait_for("images", lambda: values.get("state") == "inactive" and depth_comes())
assert values["frames"] == "0" and not shown and not poses, (values, shown, poses)
assert change(ACTIVE, label="activate")
assert not change(ACTIVE, id=Transition.TRANSITION_CONFIGURE)

wait_for("markers", lambda: len(colors) >= 5)
images.clear()
wait_for("a debug image", lambda: images)
image = images[0]
assert (image.encoding, len(image.data)) == ("rgb8", 3 * image.width * image.height), image.encoding
# Boxes and outlines are drawn in the colours of the markers, to the last bit of the conversion from floats.
pixels = set(zip(image.data[0::3], image.data[1::3], image.data[2::3]))
drawn = [c for c in colors if any(max(abs(a - b) for a, b in zip(c, p)) <= 1 for p in pixels)]
assert len(drawn) >= 5, (colors, len(pixels))
call("pause", data=True)
wait_for("paused", lambda: values.get("paused") == "true")
before = values["frames"]
rest(2.0)
assert values["frames"] == before, values
call("reset")
wait_for("no markers", lambda: not shown)
wait_for("no objects", lambda: values["objects"] == "0")
call("pause", data=False)
wait_for("going on", lambda: values["paused"] == "false" and int(values["frames"]) > int(before))
wait_for("markers again", lambda: any(ns == "objects" for ns, _ in shown))

# Inactive: the map stays, and nothing comes. What was on its way may still arrive.
objects = lambda: len([1 for ns, _ in shown if ns == "objects"])
wait_for("several objects", lambda: objects() >= 3)
assert change(INACTIVE, id=Transition.TRANSITION_DEACTIVATE)
rest(0.2)
before, known = len(poses), set(shown)
rest(1.0)
assert len(poses) == before and shown == known and objects() >= 3, (len(poses) - before, shown ^ known)
assert change(ACTIVE, id=Transition.TRANSITION_ACTIVATE)
wait_for("going on", lambda: len(poses) > before)
assert objects() >= 3, shown

# Cleaned up, and ended.
assert change(INACTIVE, label="deactivate")
assert change(UNCONFIGURED, label="cleanup")
wait_for("no markers", lambda: not shown)
assert ask("change_state", transition=Transition(id=Transition.TRANSITION_UNCONFIGURED_SHUTDOWN)).success
wait_for("all events", lambda: moves and moves[-1].goal_state == FINALIZED)
events = [(move.start_state.label, move.goal_state.label) for move in moves]
assert events[-4:-2] == [("inactive", "cleaningup"), ("cleaningup", "unconfigured")], events
assert ("activating", "active") in events and all(move.timestamp > 0 for move in moves), events
