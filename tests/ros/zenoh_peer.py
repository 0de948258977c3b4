"""A ROS 2 user on Zenoh after a bag was played: hashes of types and CDR are ROS 2's own, keys are those of `rmw_zenoh`.

Writes the markers to the file given, and asks the node to save its map. Fails with a sentence when something does not
come in time.
"""

import json
import os
import struct
import sys
import time

import zenoh
from diagnostic_msgs.msg import DiagnosticArray
from marker_summary import summary
from rcl_interfaces.srv import ListParameters
from rclpy.serialization import deserialize_message, serialize_message
from std_srvs.srv import SetBool
from visualization_msgs.msg import MarkerArray

PATIENCE_S = 60.0
NODE = "ellipsoid_slam"
DOMAIN = os.environ["ROS_DOMAIN_ID"]
markers_file, map_file = sys.argv[1:]

config = zenoh.Config()
config.insert_json5("mode", '"client"')
config.insert_json5("connect/endpoints", f'["tcp/127.0.0.1:{os.environ["ZENOH_PORT"]}"]')
config.insert_json5("timestamping/enabled", "true")
session = zenoh.open(config)


def wait_for(what, condition):
    end = time.monotonic() + PATIENCE_S
    while not (found := condition()):
        if time.monotonic() > end:
            sys.exit(f"{what} did not come")
        time.sleep(0.02)
    return found


def key(name, kind, hashed=True):
    package, folder, type_name = kind
    hash_string = "*"
    if hashed:
        with open(f"{sys.prefix}/share/{package}/{folder}/{type_name}.json") as file:
            hashes = {h["type_name"]: h["hash_string"] for h in json.load(file)["type_hashes"]}
        hash_string = hashes["/".join(kind)]
    return f"{DOMAIN}/{name}/{package}::{folder}::dds_::{type_name}_/{hash_string}"


class Latest:
    def __init__(self, cls, topic, latched=False):
        package, folder = cls.__module__.split(".")[:2]
        where = key(topic, (package, folder, cls.__name__))
        self.message, self.name, self.cls = None, topic, cls
        if latched:
            history = zenoh.ext.HistoryConfig(detect_late_publishers=True, max_samples=1)
            self.subscriber = zenoh.ext.declare_advanced_subscriber(
                session, where, self.take, history=history, subscriber_detection=True
            )
        else:
            self.subscriber = session.declare_subscriber(where, self.take)

    def take(self, sample):
        number, sent_ns, length = struct.unpack("<qqB", sample.attachment.to_bytes()[:17])
        assert number > 0 and length == 16 and abs(time.time_ns() - sent_ns) < 3600e9
        self.message = deserialize_message(sample.payload.to_bytes(), self.cls)

    def wait(self, condition=lambda message: True):
        wait_for(self.name, lambda: self.message is not None and condition(self.message))
        return self.message


def ask(where, request, target=zenoh.QueryTarget.ALL_COMPLETE):
    """The bytes of an answer, and that it is the answer to this request."""
    asked = struct.pack("<qqB", 7, time.time_ns(), 16) + bytes(range(16))
    options = {"payload": request, "attachment": asked, "target": target, "timeout": PATIENCE_S}
    for reply in session.get(where, consolidation=zenoh.ConsolidationMode.NONE, **options):
        answered = reply.ok.attachment.to_bytes()
        assert answered[:8] == asked[:8] and answered[16:] == asked[16:], answered
        return reply.ok.payload.to_bytes()
    sys.exit(f"{where} does not answer")


def call(cls, service, **request):
    where = key(f"{NODE}/{service}", (cls.__module__.split(".")[0], "srv", cls.__name__))
    return deserialize_message(ask(where, serialize_message(cls.Request(**request))), cls.Response)


def values(status):
    return {pair.key: pair.value for pair in status.values}


# Who is there.
said = [str(reply.ok.key_expr) for reply in session.liveliness().get(f"@ros2_lv/{DOMAIN}/**")]
assert any(token.endswith(f"/NN/%/%/{NODE}") for token in said), said
topics = [token.split("/") for token in said if "/MP/" in token]
assert any(parts[8:10] == [NODE, f"%{NODE}%markers"] for parts in topics), topics

diagnostics = Latest(DiagnosticArray, "diagnostics")
# The worker has done all it can when the number of frames no longer grows.
array = diagnostics.wait(lambda a: any(int(values(s).get("frames", 0)) >= 29 for s in a.status))
mapping = [s for s in array.status if s.name.endswith("mapping")][0]
assert int(values(mapping)["objects"]) > 0, values(mapping)
assert values(mapping)["dropped: overflow"] == "0", values(mapping)

# This subscriber comes late: all images are through.
markers = Latest(MarkerArray, f"{NODE}/markers", latched=True)
with open(markers_file, "w") as file:
    json.dump(summary(markers.wait()), file)

# Services: an answer may be long here.
names = call(ListParameters, "list_parameters").result.names
assert "publish_tf" in names and len(",".join(names)) > 1100, names
assert call(SetBool, "pause", data=True).success
diagnostics.wait(lambda a: any(values(s).get("paused") == "true" for s in a.status))
assert call(SetBool, "pause", data=False).success

# No package here knows the hash of our own types.
text = os.path.basename(map_file).encode() + b"\0"
where = key(f"{NODE}/save_map", (NODE, "srv", "SaveMap"), hashed=False)
request = struct.pack("<4xI", len(text)) + text
saved = ask(where, b"\0\1" + request[2:], zenoh.QueryTarget.ALL)
assert saved[4] == 1, saved
session.close()
