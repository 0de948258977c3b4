"""A client of our own services, on Cyclone DDS: looks objects up, saves and loads the map."""

import json
import sys

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

saved = save(path=sys.argv[1])
assert saved.success and sys.argv[1] in saved.message, saved
with open(sys.argv[1]) as file:
    objects = json.load(file)["objects"]
assert len(objects) >= 5, objects
refused = save(path="")
assert not refused.success and "map.file" in refused.message, refused
assert not save(path="/no/such/folder/map.json").success

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

missing = load(path=f"{sys.argv[1]}.no")
assert not missing.success and missing.objects == 0 and missing.message, missing
assert list(query().ids) == list(everything.ids)
loaded = load(path=sys.argv[1])
assert loaded.success and loaded.objects == len(objects), loaded
# Until the place is recognised nothing is in the loaded map's frame.
assert not list(query().ids)
