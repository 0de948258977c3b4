"""The method: frames in, a map of objects out."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from . import _native, _records
from .errors import SettingsError
from .frames import Box, Camera, DepthBytes, Pose, as_pose, numbers
from .objects import MapObject, ObjectMap, objects_array

__all__ = [
    "BoxResult", "Dropped", "Keyframe", "LatestPose", "ObjectChange", "ObjectSlam", "Relocalised", "StampedPose",
    "Update", "effective_settings",
]

Settings = Mapping[str, Any]


@dataclass(frozen=True)
class StampedPose:
    """Where the base was at a depth image."""

    stamp_ns: int
    map_from_base: Pose


@dataclass(frozen=True)
class LatestPose:
    """Where the base was at the latest depth image, after all that is known now."""

    stamp_ns: int
    map_from_base: Pose
    covariance: npt.NDArray[np.float64] | None
    """6 x 6, of [rotation (rad), position (m)], a right perturbation; nothing before the first keyframe."""


@dataclass(frozen=True)
class BoxResult:
    """What came of a box."""

    label: str
    corners: tuple[float, float, float, float]
    """x_min, y_min, x_max, y_max (px)."""
    object_id: int | None
    """The object that it was joined to, which may not count yet."""
    refused: str | None
    """Why it gave no ellipsoid, as a short key: ``too_few_points``, ``no_cluster``, ..."""
    why: str | None
    """The same as a sentence."""


@dataclass(frozen=True)
class Keyframe:
    """An image whose boxes were worked on."""

    stamp_ns: int
    map_from_camera: Pose
    boxes: tuple[BoxResult, ...]
    """In the order in which they were given."""


@dataclass(frozen=True)
class ObjectChange:
    """What happened to an object of the map."""

    kind: Literal["confirmed", "removed", "merged", "split"]
    """From now on it counts; it is no longer there; another one was the same; another one was in its measurements."""
    object_id: int
    other_id: int | None
    """Of ``merged``, the identity that is no more; of ``split``, the object that has the measurements now."""


@dataclass(frozen=True)
class Dropped:
    """A message or a part of one that could not be used."""

    stamp_ns: int
    reason: str
    """A short key for counting."""
    why: str
    """What happened, as a sentence."""


@dataclass(frozen=True)
class Relocalised:
    """The place in the saved map was recognised: from now on poses and objects are in its frame."""

    map_from_seen: Pose
    """Where the frame that the run had until now is in the map."""
    objects: int
    """How many objects were recognised."""
    false_probability: float


@dataclass(frozen=True)
class Update:
    """What came of one input."""

    poses: tuple[StampedPose, ...]
    """Of each depth image that was settled, as it is known at this time."""
    keyframes: tuple[Keyframe, ...]
    changes: tuple[ObjectChange, ...]
    dropped: tuple[Dropped, ...]
    relocalised: Relocalised | None


class ObjectSlam:
    """Object-level SLAM.

    There are two ways to feed it, and a run uses one of them. Either :meth:`see` takes frames that are complete: depth, the
    camera's pose, and boxes. Or the methods ``add_...`` take messages as they come, as the robot has them: calibration,
    odometry of the base and transforms to the camera, depth, and boxes whenever the detector has them. Either way,
    stamps grow, and the frame of poses has **z up**, against gravity: drift along and about z is corrected, a tilt of that
    frame is not. The camera frame is the optical one: x right, y down, z forward.

    The interpreter's lock is released while it computes. Calls from several threads come one after the other.
    """

    def __init__(
        self,
        settings: Settings | None = None,
        *,
        config: str | PathLike[str] | None = None,
        map: ObjectMap | None = None,
        start: tuple[float, float, float] | None = None,
    ) -> None:
        """An empty map, or one that is continued.

        Args:
            settings: what differs from the defaults and from ``config``, by name: ``{"sync.slop_s": 0.03}``.
            config: a parameter file, as ``ellipsoid_slam config`` prints one.
            map: a saved map. Until its place is recognised, poses and objects are in a frame of their own.
            start: about where the base starts in that map: x and y (m), yaw (deg).

        Raises:
            SettingsError: if a setting does not exist or cannot have its value.
            MapError: if the map cannot be.
        """
        self._run = _native.Slam(settings_argument(settings, config), map, start)

    @classmethod
    def _of(cls, run: _native.Slam) -> ObjectSlam:
        slam = cls.__new__(cls)
        slam._run = run
        return slam

    def see(
        self,
        stamp_ns: int,
        camera: Camera,
        odom_from_camera: Pose | npt.ArrayLike,
        depth: npt.NDArray[Any],
        boxes: Iterable[Box] = (),
    ) -> Update:
        """Takes a frame. What comes of it may be in the update of the next one.

        Args:
            stamp_ns: when it was taken (ns); stamps grow.
            camera: of the image that the boxes are in, to which depth is aligned.
            odom_from_camera: pose of the optical frame in a fixed frame with z up, or its matrix of 4 x 4.
            depth: along the optical axis, of the shape (height, width): ``float32`` in metres or ``uint16`` in
                millimetres; 0 or NaN where there is none. It may lie in memory in any order.
            boxes: what the detector found; none says that it found nothing.

        Raises:
            FrameError: if one of these cannot be; then nothing has changed.
        """
        view = (camera, as_pose(odom_from_camera))
        return update_of(self._run.see(stamp_ns, view, DepthBytes.of(depth), list(boxes)))

    def add_camera(
        self, stamp_ns: int, camera: Camera, frame_id: str = "camera", *, of_depth: bool = False
    ) -> Update:
        """Takes a calibration: of the camera whose image the boxes are in, or of a depth camera that is another one."""
        return update_of(self._run.add_camera(stamp_ns, camera, frame_id, of_depth))

    def add_odometry(
        self,
        stamp_ns: int,
        odom_from_base: Pose | npt.ArrayLike,
        covariance: npt.ArrayLike | None = None,
        *,
        frame_id: str = "odom",
        child_frame_id: str = "base_link",
    ) -> Update:
        """Takes a reading of odometry.

        Args:
            stamp_ns: when it holds (ns).
            odom_from_base: pose of the base in a fixed frame with z up.
            covariance: 6 x 6, of the pose as ``nav_msgs/Odometry`` has it: position (m), then rotation (rad).
            frame_id: name of the fixed frame.
            child_frame_id: name of the base's frame; where it is ``frame_id`` of the camera, no transform is needed.
        """
        own = None if covariance is None else numbers(covariance, "covariance", (6, 6)).ravel().tolist()
        names = (frame_id, child_frame_id)
        return update_of(self._run.add_odometry(stamp_ns, as_pose(odom_from_base), names, own))

    def add_transform(
        self,
        stamp_ns: int,
        parent_from_child: Pose | npt.ArrayLike,
        frame_id: str = "base_link",
        child_frame_id: str = "camera",
        *,
        static: bool = True,
    ) -> Update:
        """Takes a transform: where the camera is on the base. One that is not static holds for its stamp."""
        names = (frame_id, child_frame_id)
        return update_of(self._run.add_transform(stamp_ns, as_pose(parent_from_child), names, static))

    def add_depth(self, stamp_ns: int, depth: npt.NDArray[Any], frame_id: str = "camera") -> Update:
        """Takes a depth image, as :meth:`see` does."""
        return update_of(self._run.add_depth(stamp_ns, DepthBytes.of(depth), frame_id))

    def add_boxes(self, stamp_ns: int, boxes: Iterable[Box], frame_id: str = "camera") -> Update:
        """Takes the boxes of one image, with its stamp."""
        return update_of(self._run.add_boxes(stamp_ns, list(boxes), frame_id))

    def finish(self) -> Update:
        """Works off what still waits for something that will not come."""
        return update_of(self._run.finish())

    @property
    def objects(self) -> tuple[MapObject, ...]:
        """Objects that count, in the order in which they were first seen."""
        return tuple(map(MapObject._of, self._run.objects()))

    def objects_array(self) -> npt.NDArray[np.void]:
        """The same as a structured array."""
        return objects_array(self.objects)

    @property
    def map(self) -> ObjectMap:
        """What ``map.json`` would be now: without what moves by itself; the saved map as long as its place is not recognised."""
        return ObjectMap._of(self._run.map())

    def save(self, path: str | PathLike[str]) -> Path | None:
        """Saves the map, as the command ``replay`` does.

        Returns:
            The file beside it where there is one: what was seen while the place in the saved map was not recognised, or a
            saved map that was set aside.

        Raises:
            MapError: if what is there is no map, or it cannot be written; the old one is still there then.
        """
        return self._run.save(fspath(path))

    @property
    def waits_because(self) -> str | None:
        """Why the place in the saved map is not recognised yet, as a sentence; nothing where it is, or there is none."""
        return self._run.waits_because()

    @property
    def trajectory(self) -> tuple[StampedPose, ...]:
        """Where the base was at each depth image, after all that is known now."""
        return tuple(StampedPose(stamp, Pose(*parts)) for stamp, parts in self._run.trajectory())

    @property
    def pose(self) -> LatestPose | None:
        """Where the base was at the latest depth image."""
        latest = self._run.latest_pose()
        if latest is None:
            return None
        stamp, parts, covariance = latest
        square = None if covariance is None else np.array(covariance).reshape(6, 6)
        return LatestPose(stamp, Pose(*parts), square)


def effective_settings(
    settings: Settings | None = None, *, config: str | PathLike[str] | None = None
) -> dict[str, Any]:
    """All settings as they would be: the defaults, under a parameter file, under ``settings``.

    Raises:
        SettingsError: if a setting does not exist or cannot have its value.
    """
    tree: dict[str, Any] = json.loads(_native.settings_json(settings_argument(settings, config)))
    return tree


def settings_argument(
    settings: Settings | None, config: str | PathLike[str] | None
) -> tuple[str | None, str]:
    """Both as the compiled half takes them."""
    def plain(value: Any) -> Any:
        if isinstance(value, (np.generic, np.ndarray)):
            return value.tolist()
        raise TypeError(f"{value!r} is of the type {type(value).__name__}, which no setting has")

    try:
        text = json.dumps(dict(settings or {}), default=plain, allow_nan=False)
    except (TypeError, ValueError) as why:
        raise SettingsError(f"the settings are not plain values: {why}") from None
    return (None if config is None else fspath(config), text)


def update_of(record: _records.UpdateRecord) -> Update:
    """An update with its parts named."""
    relocalised = record["relocalised"]
    return Update(
        poses=tuple(StampedPose(stamp, Pose(*parts)) for stamp, parts in record["poses"]),
        keyframes=tuple(map(_keyframe, record["keyframes"])),
        changes=tuple(ObjectChange(*change) for change in record["changes"]),
        dropped=tuple(Dropped(*dropped) for dropped in record["dropped"]),
        relocalised=relocalised
        and Relocalised(
            Pose(*relocalised["map_from_seen"]),
            relocalised["objects"],
            relocalised["false_probability"],
        ),
    )


def _keyframe(record: _records.KeyframeRecord) -> Keyframe:
    def result(box: _records.BoxRecord) -> BoxResult:
        refused, why = box["refused"] or (None, None)
        return BoxResult(box["label"], box["corners"], box["object_id"], refused, why)

    return Keyframe(
        record["stamp_ns"],
        Pose(*record["map_from_camera"]),
        tuple(map(result, record["boxes"])),
    )
