"""Sends what calls itself a sensor_msgs/Image and is none, until it is stopped."""

import os
import time
from dataclasses import dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct, types
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
from cyclonedds.util import duration


@dataclass
class NoImage(IdlStruct, typename="sensor_msgs::msg::dds_::Image_"):
    sec: types.int32
    nanosec: types.uint32
    length_of_frame_id: types.uint32


participant = DomainParticipant(int(os.environ["ROS_DOMAIN_ID"]))
qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(1))
writer = DataWriter(participant, Topic(participant, "rt/depth/image", NoImage), qos=qos)
while True:
    writer.write(NoImage(1, 2, 4_000_000_000))
    time.sleep(0.2)
