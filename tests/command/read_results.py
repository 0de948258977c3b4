"""Reads a replay's results with other people's programs: read_results.py FOLDER FRAMES."""

import json
import sys
from pathlib import Path

import numpy as np
from evo.tools import file_interface
from mcap_ros2.reader import read_ros2_messages

folder, frames = Path(sys.argv[1]), int(sys.argv[2])
map_file = json.loads((folder / "map.json").read_text())
(expected,) = map_file["objects"]

messages = list(read_ros2_messages(str(folder / "result.mcap")))
by_topic = {}
for message in messages:
    by_topic.setdefault(message.channel.topic, []).append(message.ros_msg)

markers = by_topic["/ellipsoid_slam/markers"][-1].markers
body = next(m for m in markers if m.ns == "objects")
text = next(m for m in markers if m.ns == "labels")
assert body.type == 1 and body.id == expected["id"], body
assert body.header.frame_id == "map", body.header
position = [body.pose.position.x, body.pose.position.y, body.pose.position.z]
assert np.allclose(position, expected["position"]), (position, expected)
scale = [body.scale.x, body.scale.y, body.scale.z]
assert np.allclose(scale, 2 * np.array(expected["semi_axes"])), (scale, expected)
assert text.type == 9 and "suitcase" in text.text, text

boxes = by_topic["/ellipsoid_slam/objects"][-1].detections
assert [b.id for b in boxes] == [str(expected["id"])], boxes
assert boxes[0].results[0].hypothesis.class_id == "suitcase", boxes

assert 1 < len(by_topic["/ellipsoid_slam/path"][-1].poses) <= frames
assert len(by_topic["/ellipsoid_slam/odometry"]) == frames
covariance = np.array(by_topic["/ellipsoid_slam/odometry"][-1].pose.covariance).reshape(6, 6)
assert np.allclose(covariance, covariance.T) and np.linalg.eigvalsh(covariance).min() > 0, covariance

(whole,) = by_topic["/ellipsoid_slam/object_map"][-1].objects
assert (whole.id, whole.label, whole.outline) == (expected["id"], "suitcase", 1), whole
assert np.allclose(whole.covariance, expected["covariance"])
assert whole.first_seen.sec + 1e-9 * whole.first_seen.nanosec == expected["first_seen"], whole
pairs = {(t.header.frame_id, t.child_frame_id) for m in by_topic["/tf"] for t in m.transforms}
assert ("map", "odom") in pairs and ("odom", "camera_optical") in pairs, pairs

# After all optimisation, and as it was published at the time.
live = by_topic["/ellipsoid_slam/odometry"]
final = by_topic["/ellipsoid_slam/path"][-1].poses
for name, poses in [("trajectory.tum", final), ("trajectory_live.tum", live)]:
    trajectory = file_interface.read_tum_trajectory_file(str(folder / name))
    assert trajectory.num_poses == frames and trajectory.check()[0], trajectory
    stamps = np.array([p.header.stamp.sec + 1e-9 * p.header.stamp.nanosec for p in poses])
    rows = np.abs(trajectory.timestamps[:, None] - stamps).argmin(axis=0)
    assert np.allclose(trajectory.timestamps[rows], stamps, atol=1e-6, rtol=0)
    places = [p.pose.pose.position if name.endswith("live.tum") else p.pose.position for p in poses]
    xyz = [[p.x, p.y, p.z] for p in places]
    assert np.allclose(trajectory.positions_xyz[rows], xyz, atol=1e-8)
