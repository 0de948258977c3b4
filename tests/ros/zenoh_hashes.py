"""Hashes of our types and of those that no package here has, made by ROS 2's own generators; prints them as JSON in its last line."""

import json
import sys
import tempfile
from pathlib import Path

from rosidl_adapter.msg import convert_msg_to_idl
from rosidl_adapter.srv import convert_srv_to_idl
from rosidl_generator_type_description import generate_type_hash

PACKAGES = {
    "tf2_msgs": ["msg/ros/tf2_msgs"],
    "vision_msgs": ["msg/ros/vision_msgs"],
    "yolo_msgs": ["msg/ros/yolo_msgs"],
    "rtabmap_msgs": ["msg/ros/rtabmap_msgs"],
    "ellipsoid_slam": ["msg", "srv"],
}

share = Path(sys.prefix, "share")
include_paths = [f"{p.name}:{p}" for p in share.iterdir() if (p / "msg").is_dir()]
hashes = {}
for package, folders in PACKAGES.items():
    source, out = (Path(tempfile.mkdtemp()) for _ in range(2))
    tuples = []
    for folder in map(Path, folders):
        for file in sorted(folder.glob("*.msg")) + sorted(folder.glob("*.srv")):
            kind = file.suffix[1:]
            (source / kind).mkdir(exist_ok=True)
            (source / kind / file.name).write_text(file.read_text())
            convert = convert_msg_to_idl if kind == "msg" else convert_srv_to_idl
            convert(source, package, Path(kind, file.name), source / kind)
            tuples.append(f"{source}:{kind}/{file.stem}.idl")
    arguments = {"package_name": package, "output_dir": str(out), "idl_tuples": tuples, "include_paths": include_paths}
    (source / "arguments.json").write_text(json.dumps(arguments))
    generate_type_hash(str(source / "arguments.json"))
    for file in out.rglob("*.json"):
        for known in json.loads(file.read_text())["type_hashes"]:
            hashes[known["type_name"]] = known["hash_string"]
print(json.dumps(hashes))
