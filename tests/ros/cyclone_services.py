"""A client of our own services, on Cyclone DDS: looks objects up, saves and loads the map.

Given the file that the node writes maps to, in the node's folder of maps.
"""

import json
import os
import sys
import time

from cyclone_messages import (
    LoadMapRequest,
    LoadMapResponse,
    Point,
    QueryObjectsRequest,
    QueryObjectsResponse,
    SaveMapRequest,
    SaveMapResponse,
)
from cyclone_participant import client

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

missing = load(path="missing.json")
assert not missing.success and missing.objects == 0 and missing.message, missing
assert list(query().ids) == list(everything.ids)
loaded = load(path=NAME)
assert loaded.success and loaded.objects == len(objects), loaded
# Until the place is recognised nothing is in the loaded map's frame.
assert not list(query().ids)
