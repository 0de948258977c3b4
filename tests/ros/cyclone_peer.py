"""A robot on Cyclone DDS: sends a bag's topics with /tf, /tf_static and /clock, receives objects, /tf and diagnostics."""

import os
import sys
import time
from dataclasses import dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct, types
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from mcap_ros2.reader import read_ros2_messages

PATIENCE_S = 60.0


# Types as ROS 2 names them on DDS, with the fields of their .msg files; nested ones first.
@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: types.int32
    nanosec: types.uint32


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: types.float64
    y: types.float64
    z: types.float64


@dataclass
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    x: types.float64
    y: types.float64
    z: types.float64
    w: types.float64


@dataclass
class Transform(IdlStruct, typename="geometry_msgs::msg::dds_::Transform_"):
    translation: Vector3
    rotation: Quaternion


@dataclass
class TransformStamped(IdlStruct, typename="geometry_msgs::msg::dds_::TransformStamped_"):
    header: Header
    child_frame_id: str
    transform: Transform


@dataclass
class TFMessage(IdlStruct, typename="tf2_msgs::msg::dds_::TFMessage_"):
    transforms: types.sequence[TransformStamped]


@dataclass
class Clock(IdlStruct, typename="rosgraph_msgs::msg::dds_::Clock_"):
    clock: Time


@dataclass
class CompressedImage(IdlStruct, typename="sensor_msgs::msg::dds_::CompressedImage_"):
    header: Header
    format: str
    data: types.sequence[types.uint8]


@dataclass
class RegionOfInterest(IdlStruct, typename="sensor_msgs::msg::dds_::RegionOfInterest_"):
    x_offset: types.uint32
    y_offset: types.uint32
    height: types.uint32
    width: types.uint32
    do_rectify: bool


@dataclass
class CameraInfo(IdlStruct, typename="sensor_msgs::msg::dds_::CameraInfo_"):
    header: Header
    height: types.uint32
    width: types.uint32
    distortion_model: str
    d: types.sequence[types.float64]
    k: types.array[types.float64, 9]
    r: types.array[types.float64, 9]
    p: types.array[types.float64, 12]
    binning_x: types.uint32
    binning_y: types.uint32
    roi: RegionOfInterest


@dataclass
class Point(IdlStruct, typename="geometry_msgs::msg::dds_::Point_"):
    x: types.float64
    y: types.float64
    z: types.float64


@dataclass
class Pose(IdlStruct, typename="geometry_msgs::msg::dds_::Pose_"):
    position: Point
    orientation: Quaternion


@dataclass
class PoseWithCovariance(IdlStruct, typename="geometry_msgs::msg::dds_::PoseWithCovariance_"):
    pose: Pose
    covariance: types.array[types.float64, 36]


@dataclass
class ObjectHypothesis(IdlStruct, typename="vision_msgs::msg::dds_::ObjectHypothesis_"):
    class_id: str
    score: types.float64


@dataclass
class ObjectHypothesisWithPose(IdlStruct, typename="vision_msgs::msg::dds_::ObjectHypothesisWithPose_"):
    hypothesis: ObjectHypothesis
    pose: PoseWithCovariance


@dataclass
class Point2D(IdlStruct, typename="vision_msgs::msg::dds_::Point2D_"):
    x: types.float64
    y: types.float64


@dataclass
class Pose2D(IdlStruct, typename="vision_msgs::msg::dds_::Pose2D_"):
    position: Point2D
    theta: types.float64


@dataclass
class BoundingBox2D(IdlStruct, typename="vision_msgs::msg::dds_::BoundingBox2D_"):
    center: Pose2D
    size_x: types.float64
    size_y: types.float64


@dataclass
class Detection2D(IdlStruct, typename="vision_msgs::msg::dds_::Detection2D_"):
    header: Header
    results: types.sequence[ObjectHypothesisWithPose]
    bbox: BoundingBox2D
    id: str


@dataclass
class Detection2DArray(IdlStruct, typename="vision_msgs::msg::dds_::Detection2DArray_"):
    header: Header
    detections: types.sequence[Detection2D]


@dataclass
class BoundingBox3D(IdlStruct, typename="vision_msgs::msg::dds_::BoundingBox3D_"):
    center: Pose
    size: Vector3


@dataclass
class Detection3D(IdlStruct, typename="vision_msgs::msg::dds_::Detection3D_"):
    header: Header
    results: types.sequence[ObjectHypothesisWithPose]
    bbox: BoundingBox3D
    id: str


@dataclass
class Detection3DArray(IdlStruct, typename="vision_msgs::msg::dds_::Detection3DArray_"):
    header: Header
    detections: types.sequence[Detection3D]


@dataclass
class KeyValue(IdlStruct, typename="diagnostic_msgs::msg::dds_::KeyValue_"):
    key: str
    value: str


@dataclass
class DiagnosticStatus(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticStatus_"):
    level: types.uint8
    name: str
    message: str
    hardware_id: str
    values: types.sequence[KeyValue]


@dataclass
class DiagnosticArray(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticArray_"):
    header: Header
    status: types.sequence[DiagnosticStatus]


def filled(kind, value):
    """A message of the bag's reader as one of the types above."""
    if isinstance(kind, type) and issubclass(kind, IdlStruct):
        fields = kind.__dataclass_fields__
        return kind(**{name: filled(field.type, getattr(value, name)) for name, field in fields.items()})
    inner = getattr(kind, "__metadata__", [None])[0]
    element = getattr(inner, "subtype", None)
    if isinstance(value, (bytes, bytearray, memoryview)):
        return list(bytes(value))
    if isinstance(value, (list, tuple)) or hasattr(value, "tolist"):
        items = value.tolist() if hasattr(value, "tolist") else value
        return [filled(element, item) for item in items] if element is not None else list(items)
    return value


participant = DomainParticipant(int(os.environ["ROS_DOMAIN_ID"]))
reliable = Policy.Reliability.Reliable(duration(seconds=10))
latched = Qos(reliable, Policy.Durability.TransientLocal, Policy.History.KeepLast(100))
plain = Qos(reliable, Policy.Durability.Volatile, Policy.History.KeepLast(500))


def writer(topic, kind):
    qos = latched if topic == "/tf_static" else plain
    return DataWriter(participant, Topic(participant, f"rt{topic}", kind), qos=qos)


def reader(topic, kind, qos):
    return DataReader(participant, Topic(participant, f"rt{topic}", kind), qos=qos)


KINDS = {
    "/camera/aligned_depth_to_color/image_raw/compressedDepth": CompressedImage,
    "/camera/color/camera_info": CameraInfo,
    "/detections": Detection2DArray,
    "/tf": TFMessage,
    "/tf_static": TFMessage,
}
writers = {topic: writer(topic, kind) for topic, kind in KINDS.items()}
clock = writer("/clock", Clock)
objects = reader("/ellipsoid_slam/objects", Detection3DArray, latched)
transforms = reader("/tf", TFMessage, plain)
diagnostics = reader("/diagnostics", DiagnosticArray, plain)


def wait_for(what, condition):
    end = time.monotonic() + PATIENCE_S
    while True:
        found = condition()
        if found:
            return found
        if time.monotonic() > end:
            sys.exit(f"{what} did not come")
        time.sleep(0.05)


for topic, w in [*writers.items(), ("/clock", clock)]:
    if topic != "/tf":  # Our own reader hears it too.
        wait_for(f"a subscription of {topic}", lambda: w.get_matched_subscriptions())
wait_for("a subscription of /tf", lambda: len(writers["/tf"].get_matched_subscriptions()) > 1)

last = None
for m in read_ros2_messages(sys.argv[1], topics=list(KINDS)):
    kind = KINDS[m.channel.topic]
    stamp = m.log_time_ns
    if last is not None:
        time.sleep(min(max(stamp - last, 0) * 0.4e-9, 0.2))
    last = stamp
    clock.write(Clock(Time(stamp // 10**9, stamp % 10**9)))
    writers[m.channel.topic].write(filled(kind, m.ros_msg))

found, correction, sim_time = [], [], []


def heard():
    for array in objects.take(N=100):
        found[:] = [(d.id, d.results[0].hypothesis.class_id, d.bbox) for d in array.detections]
    for array in transforms.take(N=1000):
        correction.extend(t for t in array.transforms if (t.header.frame_id, t.child_frame_id) == ("map", "odom"))
    for array in diagnostics.take(N=100):
        sim_time.append(array.header.stamp.sec)
    return len(found) >= 5 and correction and sim_time and sim_time[-1] == last // 10**9


wait_for("objects, map -> odom and diagnostics in the bag's time", heard)
assert len({id for id, _, _ in found}) == len(found), found
assert {"chair", "keyboard"} & {label for _, label, _ in found}, found
for _, _, box in found:
    q = box.center.orientation
    assert abs(q.x**2 + q.y**2 + q.z**2 + q.w**2 - 1.0) < 1e-9 and 0.0 < box.size.x < 5.0, box
q = correction[-1].transform.rotation
assert abs(q.x**2 + q.y**2 + q.z**2 + q.w**2 - 1.0) < 1e-9, correction[-1]
