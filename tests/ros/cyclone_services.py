"""A client of our own services, on Cyclone DDS: looks objects up, saves and loads the map.

Types are declared as ROS 2 names them on DDS; a service is a topic for requests and one for replies.
"""

import json
import os
import sys
import time
from dataclasses import dataclass, field

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct, types
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

PATIENCE_S = 60.0
SERVICES = "ellipsoid_slam::srv::dds_::"


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: types.int32
    nanosec: types.uint32


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclass
class Point(IdlStruct, typename="geometry_msgs::msg::dds_::Point_"):
    x: types.float64 = 0.0
    y: types.float64 = 0.0
    z: types.float64 = 0.0


@dataclass
class QueryObjectsRequest(IdlStruct, typename=f"{SERVICES}QueryObjects_Request_"):
    labels: types.sequence[str] = field(default_factory=list)
    min_existence: types.float64 = 0.0
    in_region: bool = False
    region_min: Point = field(default_factory=Point)
    region_max: Point = field(default_factory=Point)
    in_view: bool = False
    max_range: types.float64 = 0.0
    by_distance: bool = False
    nearest_to: Point = field(default_factory=Point)
    max_count: types.uint32 = 0


@dataclass
class QueryObjectsResponse(IdlStruct, typename=f"{SERVICES}QueryObjects_Response_"):
    success: bool
    message: str
    header: Header
    ids: types.sequence[types.uint64]


@dataclass
class SaveMapRequest(IdlStruct, typename=f"{SERVICES}SaveMap_Request_"):
    path: str


@dataclass
class SaveMapResponse(IdlStruct, typename=f"{SERVICES}SaveMap_Response_"):
    success: bool
    message: str


@dataclass
class LoadMapRequest(IdlStruct, typename=f"{SERVICES}LoadMap_Request_"):
    path: str


@dataclass
class LoadMapResponse(IdlStruct, typename=f"{SERVICES}LoadMap_Response_"):
    success: bool
    message: str
    objects: types.uint32


participant = DomainParticipant(int(os.environ["ROS_DOMAIN_ID"]))
qos = Qos(Policy.Reliability.Reliable(duration(seconds=10)), Policy.History.KeepLast(10))


def wait_for(what, condition):
    end = time.monotonic() + PATIENCE_S
    while not (found := condition()):
        if time.monotonic() > end:
            sys.exit(f"{what} did not come")
        time.sleep(0.02)
    return found


def client(name, request, response):
    writer = DataWriter(participant, Topic(participant, f"rq/ellipsoid_slam/{name}Request", request), qos=qos)
    reader = DataReader(participant, Topic(participant, f"rr/ellipsoid_slam/{name}Reply", response), qos=qos)
    wait_for(f"the service {name}", lambda: writer.get_matched_subscriptions() and reader.get_matched_publications())

    def call(**given):
        writer.write(request(**given))
        return wait_for(f"the answer of {name}", lambda: reader.take(N=1))[0]

    return call


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
