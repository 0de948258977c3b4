"""A client of our own services, on Cyclone DDS: looks objects up, edits them, asks for places before them, saves and loads the map.

Given the file that the node writes maps to, in the node's folder of maps.
"""

import json
import math
import os
import sys
import time

from cyclone_messages import (
    AddObjectRequest,
    AddObjectResponse,
    ApproachObjectRequest,
    ApproachObjectResponse,
    DeleteObjectRequest,
    DeleteObjectResponse,
    Header,
    LoadMapRequest,
    LoadMapResponse,
    LockObjectRequest,
    LockObjectResponse,
    Point,
    Pose,
    PoseStamped,
    PoseWithCovariance,
    PoseWithCovarianceStamped,
    Quaternion,
    QueryObjectsRequest,
    QueryObjectsResponse,
    RenameObjectRequest,
    RenameObjectResponse,
    SaveMapRequest,
    SaveMapResponse,
    TFMessage,
    Time,
    Vector3,
)
from cyclone_participant import LATCHED, client, reader, wait_for, writer

query = client("query_objects", QueryObjectsRequest, QueryObjectsResponse)
save = client("save_map", SaveMapRequest, SaveMapResponse)
load = client("load_map", LoadMapRequest, LoadMapResponse)

NAME = os.path.basename(sys.argv[1])
FOLDER = os.path.dirname(sys.argv[1])

saved = save(path=NAME)
assert saved.success and sys.argv[1] in saved.message, saved
with open(sys.argv[1]) as file:
    objects = json.load(file)["objects"]
assert len(objects) >= 5, objects
refused = save(path="")
assert not refused.success and "map.file" in refused.message, refused

# Names only, and nothing that is there and no map.
with open(f"{FOLDER}/other.json", "w") as file:
    file.write("mine")
os.symlink(f"{FOLDER}/other.json", f"{FOLDER}/link.json")
os.mkfifo(f"{FOLDER}/pipe.json")
before = sorted(os.listdir(FOLDER))
refusals = {
    sys.argv[1]: "is no name of a map",
    "../map.json": "is no name of a map",
    ".hidden.json": "is no name of a map",
    "notes.txt": "is no name of a map",
    "other.json": "no map of this version",
    "link.json": "no regular file",
    "pipe.json": "no regular file",
}
for name, why in refusals.items():
    refused = save(path=name)
    assert not refused.success and why in refused.message, (name, refused)
    asked = time.monotonic()
    refused = load(path=name)
    assert not refused.success and time.monotonic() - asked < 5, (name, refused)
assert sorted(os.listdir(FOLDER)) == before, os.listdir(FOLDER)
with open(f"{FOLDER}/other.json") as file:
    assert file.read() == "mine"

everything = query()
assert everything.success and everything.header.frame_id == "map", everything
assert list(everything.ids) == [o["id"] for o in objects], everything
label = objects[0]["label"]
assert list(query(labels=[label]).ids) == [o["id"] for o in objects if o["label"] == label]
assert not list(query(labels=["unicorn"]).ids)
there = objects[-1]["position"]
nearest = query(by_distance=True, nearest_to=Point(*there), max_count=1)
assert list(nearest.ids) == [objects[-1]["id"]], nearest
region = query(in_region=True, region_min=Point(*(v - 0.01 for v in there)), region_max=Point(*(v + 0.01 for v in there)))
assert objects[-1]["id"] in region.ids and len(region.ids) < len(objects), region
assert query(in_view=True).success

# Edits, and what they are answered where they cannot be made.
rename = client("rename_object", RenameObjectRequest, RenameObjectResponse)
lock = client("lock_object", LockObjectRequest, LockObjectResponse)
delete = client("delete_object", DeleteObjectRequest, DeleteObjectResponse)
add = client("add_object", AddObjectRequest, AddObjectResponse)
first, last = objects[0]["id"], objects[-1]["id"]


def pose_at(x, y, frame="map", w=1.0):
    return PoseStamped(Header(Time(0, 0), frame), Pose(Point(x, y, 0.4), Quaternion(0.0, 0.0, 0.0, w)))


size = Vector3(0.5, 0.5, 0.8)
for refused, words in [
    (rename(id=first, name=" "), "empty"),
    (rename(id=first, name="x" * 300), "300 bytes"),
    (rename(id=9999, name="x"), "no object 9999"),
    (delete(id=9999), "no object 9999"),
    (lock(id=9999, locked=True), "no object 9999"),
    (add(label="", pose=pose_at(0.0, 0.0), size=size, locked=False), "empty"),
    (add(label="chair", pose=pose_at(math.nan, 0.0), size=size, locked=False), "not finite"),
    (add(label="chair", pose=pose_at(0.0, 0.0, w=0.0), size=size, locked=False), "orientation"),
    (add(label="chair", pose=pose_at(0.0, 0.0, "odom"), size=size, locked=False), "has to be in `map`"),
    (add(label="chair", pose=pose_at(0.0, 0.0), size=Vector3(0.5, -1.0, 0.5), locked=False), "size"),
]:
    assert not refused.success and words in refused.message, refused
assert rename(id=first, name="my thing").message == f"object {first} is called `my thing`"
assert lock(id=first, locked=True).success
assert delete(id=last).success
added = add(label="bench", pose=pose_at(9.0, 0.0, ""), size=size, locked=True)
assert added.success, added
assert list(query(labels=["my thing"]).ids) == [first]
now = {o["id"] for o in objects} - {last} | {added.id}
assert set(query().ids) == now, query()

# A place before the bench that was added, on its latched topic, too; and the objects' frames in TF.
approach = client("approach_object", ApproachObjectRequest, ApproachObjectResponse)
place = approach(label="bench", distance=1.0)
assert place.success and place.id == added.id and place.pose.header.frame_id == "map", place
at, turn = place.pose.pose.position, place.pose.pose.orientation
heading = 2.0 * math.atan2(turn.z, turn.w)
wanted = math.atan2(-at.y, 9.0 - at.x)
assert math.cos(heading - wanted) > 0.999, place
beside = math.hypot(max(abs(9.0 - at.x) - 0.25, 0.0), max(abs(at.y) - 0.25, 0.0))
assert abs(beside - 1.0) < 1e-3 and at.x < 9.0, place
late = reader("/ellipsoid_slam/approach_pose", PoseStamped, LATCHED)
assert wait_for("the pose", lambda: late.take(N=1))[0].pose.position == at
for refused, words in [
    (approach(), "an id or a label"),
    (approach(label="unicorn"), "nothing is called `unicorn`"),
    (approach(id=last), f"no object {last}"),
    (approach(label="bench", distance=-1.0), "distance"),
]:
    assert not refused.success and words in refused.message, refused
frames = reader("/tf", TFMessage)
seen = set()


def all_frames():
    for message in frames.take(N=100):
        seen.update(t.child_frame_id for t in message.transforms if t.header.frame_id == "map")
    return {f"object_{id}" for id in now} | {"object_my_thing", "odom"} <= seen


wait_for("the objects' frames", all_frames)
assert f"object_{last}" not in seen, seen

# The file has the edits.
assert save(path=NAME).success
with open(sys.argv[1]) as file:
    objects = json.load(file)["objects"]
assert {o["id"] for o in objects} == now
kept = [o for o in objects if o["id"] == first][0]
assert (kept["name"], kept["locked"]) == ("my thing", True), kept

# A robot that knows where it is takes no initial pose; one whose map was loaded looks for its place there.
initial = writer("/initialpose", PoseWithCovarianceStamped)
wait_for("the node's ear", initial.get_matched_subscriptions)


def point_at(frame, x, y):
    pose = Pose(Point(x, y, 0.0), Quaternion(0.0, 0.0, 0.0, 1.0))
    initial.write(PoseWithCovarianceStamped(Header(Time(0, 0), frame), PoseWithCovariance(pose, [0.0] * 36)))
    # Nothing answers, and only the latest one is heard: the log says what came of it.
    time.sleep(0.3)


# The node may know of the writer a moment later than the writer of the node.
for _ in range(3):
    point_at("map", 7.0, 7.0)
point_at("odom", 8.0, 8.0)
missing = load(path="missing.json")
assert not missing.success and missing.objects == 0 and missing.message, missing
assert set(query().ids) == now
loaded = load(path=NAME)
assert loaded.success and loaded.objects == len(objects), loaded
# Until the place is recognised nothing is in the loaded map's frame.
assert not list(query().ids)
point_at("map", 1.25, -2.0)
