"""What the compiled half returns."""

from __future__ import annotations

from typing import Literal, TypedDict

Vector3 = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
Outline = Literal["ellipsoid", "cuboid", "cylinder", "superquadric"]

PoseParts = tuple[Vector3, Quaternion]
"""Position (m) and quaternion x, y, z, w."""
StampedPose = tuple[int, PoseParts]
LatestPose = tuple[int, PoseParts, list[float] | None]


class ObjectRecord(TypedDict):
    """The fields of ``MapObject``, with the covariance row by row."""

    id: int
    label: str
    labels: dict[str, float]
    existence: float
    observations: int
    first_seen_ns: int
    last_seen_ns: int
    position: Vector3
    orientation: Quaternion
    semi_axes: Vector3
    outline: Outline
    exponents: tuple[float, float] | None
    support_height_m: float | None
    covariance: list[float]
    name: str | None
    locked: bool


class MapRecord(TypedDict):
    """The fields of ``ObjectMap``."""

    frame_id: str
    objects: list[ObjectRecord]


class BoxRecord(TypedDict):
    """The fields of ``BoxResult``; ``refused`` has the key and the sentence."""

    label: str
    corners: tuple[float, float, float, float]
    object_id: int | None
    refused: tuple[str, str] | None


class KeyframeRecord(TypedDict):
    """The fields of ``Keyframe``."""

    stamp_ns: int
    map_from_camera: PoseParts
    boxes: list[BoxRecord]


class RelocalisedRecord(TypedDict):
    """The fields of ``Relocalised``."""

    map_from_seen: PoseParts
    objects: int
    false_probability: float


class UpdateRecord(TypedDict):
    """The fields of ``Update``."""

    poses: list[StampedPose]
    keyframes: list[KeyframeRecord]
    changes: list[tuple[Literal["confirmed", "removed", "merged", "split"], int, int | None]]
    dropped: list[tuple[int, str, str]]
    relocalised: RelocalisedRecord | None


class ReplayRecord(TypedDict):
    """The fields of ``Replay`` besides the run."""

    messages: int
    frames: int
    keyframes: int
    dropped: dict[str, int]
    refused_boxes: dict[str, int]
    warnings: list[str]
