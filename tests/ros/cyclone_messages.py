"""ROS 2's types as it names them on DDS, with the fields of their .msg and .srv files; nested ones first."""

from dataclasses import dataclass, field

from cyclonedds.idl import IdlStruct, types

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
    x: types.float64 = 0.0
    y: types.float64 = 0.0
    z: types.float64 = 0.0


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


@dataclass
class PoseStamped(IdlStruct, typename="geometry_msgs::msg::dds_::PoseStamped_"):
    header: Header
    pose: Pose


@dataclass
class PoseWithCovarianceStamped(IdlStruct, typename="geometry_msgs::msg::dds_::PoseWithCovarianceStamped_"):
    header: Header
    pose: PoseWithCovariance


@dataclass
class ApproachObjectRequest(IdlStruct, typename=f"{SERVICES}ApproachObject_Request_"):
    id: types.uint64 = 0
    label: str = ""
    distance: types.float64 = 0.0


@dataclass
class ApproachObjectResponse(IdlStruct, typename=f"{SERVICES}ApproachObject_Response_"):
    success: bool
    message: str
    id: types.uint64
    pose: PoseStamped


@dataclass
class RenameObjectRequest(IdlStruct, typename=f"{SERVICES}RenameObject_Request_"):
    id: types.uint64
    name: str


@dataclass
class RenameObjectResponse(IdlStruct, typename=f"{SERVICES}RenameObject_Response_"):
    success: bool
    message: str


@dataclass
class DeleteObjectRequest(IdlStruct, typename=f"{SERVICES}DeleteObject_Request_"):
    id: types.uint64


@dataclass
class DeleteObjectResponse(IdlStruct, typename=f"{SERVICES}DeleteObject_Response_"):
    success: bool
    message: str


@dataclass
class LockObjectRequest(IdlStruct, typename=f"{SERVICES}LockObject_Request_"):
    id: types.uint64
    locked: bool


@dataclass
class LockObjectResponse(IdlStruct, typename=f"{SERVICES}LockObject_Response_"):
    success: bool
    message: str


@dataclass
class AddObjectRequest(IdlStruct, typename=f"{SERVICES}AddObject_Request_"):
    label: str
    pose: PoseStamped
    size: Vector3
    locked: bool


@dataclass
class AddObjectResponse(IdlStruct, typename=f"{SERVICES}AddObject_Response_"):
    success: bool
    message: str
    id: types.uint64
