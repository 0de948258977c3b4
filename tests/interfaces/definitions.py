"""The definitions of others in msg/ros against the ones that ROS 2 ships, and against published hashes of types."""

import hashlib
import json
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2] / "msg" / "ros"
SHARE = Path(sys.prefix) / "share"
# The hash (REP 2016) that the generators of ROS 2 give the released yolo_msgs.
YOLO_DETECTION = "303e881e77fbe95c37cef2bdc8c047eee9051f22e4f7189f64bd029bfaedfca8"

PRIMITIVES = {
    "int32": 6, "uint32": 7, "float32": 10, "float64": 11, "bool": 15, "byte": 16, "string": 17, "uint8": 3,
}  # fmt: skip


def fields(text):
    """Type and name of each field or constant, without comments and superfluous white space."""
    lines = (" ".join(line.split("#")[0].split()) for line in text.splitlines())
    return [line.replace(" = ", "=") for line in lines if line]


def parts(package, name):
    found = []
    for line in fields((ROOT / package / f"{name}.msg").read_text()):
        kind, field, *_ = line.split(" ")
        if "=" not in field:
            base = kind.split("[")[0]
            full = base if base in PRIMITIVES or "/" in base else f"{package}/{base}"
            found.append((field, full, kind.endswith("[]")))
    return found


def described(full):
    def field(name, kind, is_sequence):
        nested = kind not in PRIMITIVES
        number = (1 if nested else PRIMITIVES[kind]) + (144 if is_sequence else 0)
        nested_name = kind.replace("/", "/msg/") if nested else ""
        kind = {"type_id": number, "capacity": 0, "string_capacity": 0, "nested_type_name": nested_name}
        return {"name": name, "type": kind}

    return {"type_name": full.replace("/", "/msg/"), "fields": [field(*part) for part in parts(*full.split("/"))]}


def type_hash(full):
    todo, needed = [full], set()
    while todo:
        for _, kind, _ in parts(*todo.pop().split("/")):
            if kind not in PRIMITIVES and kind not in needed:
                needed.add(kind)
                todo.append(kind)
    names = sorted(needed, key=lambda name: name.replace("/", "/msg/"))
    text = json.dumps({"type_description": described(full), "referenced_type_descriptions": [described(n) for n in names]})
    return hashlib.sha256(text.encode()).hexdigest()


compared = 0
for path in sorted(ROOT.glob("*/*.msg")):
    shipped = SHARE / path.parent.name / "msg" / path.name
    if shipped.exists():
        ours, theirs = fields(path.read_text()), fields(shipped.read_text())
        # Later distributions add constants.
        assert set(ours) <= set(theirs), (path, set(ours) - set(theirs))
        assert [f for f in ours if "=" not in f] == [f for f in theirs if "=" not in f], path
        compared += 1
assert compared > 25, compared
assert type_hash("yolo_msgs/Detection") == YOLO_DETECTION, type_hash("yolo_msgs/Detection")
print(f"{compared} definitions are those of ROS 2; yolo_msgs/Detection has the published hash")
