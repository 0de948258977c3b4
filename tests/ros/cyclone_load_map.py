"""Loads a map into a node that has begun without one, and waits until what the robot sees is in it.

Says "loaded" when the robot may drive. Then each object of the file has to come with its identity, where it was.
"""

import json
import math
import os
import sys

from cyclone_messages import Detection3DArray, LoadMapRequest, LoadMapResponse
from cyclone_participant import LATCHED, client, reader, wait_for

with open(sys.argv[1]) as file:
    saved = {str(o["id"]): o for o in json.load(file)["objects"]}
objects = reader("/ellipsoid_slam/objects", Detection3DArray, LATCHED)
loaded = client("load_map", LoadMapRequest, LoadMapResponse)(path=os.path.basename(sys.argv[1]))
assert loaded.success and loaded.objects == len(saved) >= 5, loaded
print("loaded", flush=True)

drive = []


def are_there():
    drive.extend(array for array in objects.take(N=100) if array.detections)
    drove_s = drive[-1].header.stamp.sec - drive[0].header.stamp.sec if drive else 0
    return drove_s >= 6 and saved.keys() <= {d.id for d in drive[-1].detections}


wait_for(f"all of {sorted(saved)}, and not only what was seen since,", are_there)
for found in drive[-1].detections:
    if object := saved.get(found.id):
        assert found.results[0].hypothesis.class_id == object["label"], (found, object)
        # The robot starts metres away from where the map begins. Both visits place things to some centimetres.
        center = found.bbox.center.position
        off_m = math.dist((center.x, center.y, center.z), object["position"])
        assert off_m < 0.1, f"object {found.id} is {off_m:.3f} m from where it was"
