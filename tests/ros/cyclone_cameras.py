"""A robot whose topics nobody named: announces the given names, `i:` images, `c:` calibrations, `o:` odometry, `b:` boxes, and
waits until the node listens to those that are marked by `=`, and to no others. Nothing is sent."""

import sys
from dataclasses import dataclass

from cyclone_messages import CameraInfo, Detection2DArray, Header
from cyclone_participant import wait_for, writer
from cyclonedds.idl import IdlStruct


@dataclass
class Image(IdlStruct, typename="sensor_msgs::msg::dds_::Image_"):
    header: Header


@dataclass
class Odometry(IdlStruct, typename="nav_msgs::msg::dds_::Odometry_"):
    header: Header


KINDS = {"i": Image, "c": CameraInfo, "o": Odometry, "b": Detection2DArray}
writers, wanted = {}, []
for word in sys.argv[1:]:
    kind, name = word.lstrip("=").split(":")
    writers[name] = writer(name, KINDS[kind])
    wanted += [name] if word.startswith("=") else []
for name in wanted:
    wait_for(f"a subscription to {name}", writers[name].get_matched_subscriptions)
heard = [name for name, writer in writers.items() if writer.get_matched_subscriptions()]
assert sorted(heard) == sorted(wanted), heard
