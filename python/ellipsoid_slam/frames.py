"""What one RGB-D image consists of: camera, pose, depth, and a detector's boxes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _native
from ._records import Quaternion, Vector3
from .errors import FrameError

__all__ = ["Box", "Camera", "Pose", "boxes_from_arrays"]


@dataclass(frozen=True)
class Camera:
    """A pinhole camera. Lengths are in pixels; the centre of the upper left pixel is at (0, 0)."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    distortion: tuple[float, ...] = ()
    """k1, k2, p1, p2[, k3[, k4, k5, k6]] as OpenCV and ROS have them; none for a rectified image."""

    def __post_init__(self) -> None:
        count = len(self.distortion)
        object.__setattr__(self, "distortion", tuple_of(self.distortion, "distortion", count))


@dataclass(frozen=True)
class Pose:
    """A rigid transform ``a_from_b``: it takes points of the frame b into the frame a."""

    position: Vector3
    """Origin of b in a (m)."""
    orientation: Quaternion = (0.0, 0.0, 0.0, 1.0)
    """Unit quaternion x, y, z, w."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", tuple_of(self.position, "position", 3))
        object.__setattr__(self, "orientation", tuple_of(self.orientation, "orientation", 4))

    @staticmethod
    def from_matrix(matrix: npt.ArrayLike) -> Pose:
        """A pose from a homogeneous matrix of 4 x 4.

        Raises:
            FrameError: if the matrix is none of a rigid transform.
        """
        rows = numbers(matrix, "the pose", (4, 4))
        position, orientation = _native.pose_from_matrix(rows.tolist())
        return Pose(position, orientation)

    @property
    def rotation(self) -> npt.NDArray[np.float64]:
        """The rotation as a matrix of 3 x 3."""
        x, y, z, w = self.orientation
        return np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
        )

    @property
    def matrix(self) -> npt.NDArray[np.float64]:
        """The homogeneous matrix of 4 x 4."""
        matrix = np.eye(4)
        matrix[:3, :3] = self.rotation
        matrix[:3, 3] = self.position
        return matrix


@dataclass(frozen=True)
class Box:
    """A detector's box in the image that the camera is of."""

    corners: tuple[float, float, float, float]
    """x_min, y_min, x_max, y_max (px)."""
    label: str
    """Name of the class; COCO's names have a usual size and symmetry."""
    score: float
    """The detector's score, from 0 to 1."""
    others: Mapping[str, float] = field(default_factory=dict)
    """Other classes that it may be, with their scores."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "corners", tuple_of(self.corners, "corners", 4))

    @property
    def hypotheses(self) -> list[tuple[str, float]]:
        """All classes with their scores."""
        return [(self.label, self.score), *self.others.items()]


def boxes_from_arrays(
    corners: npt.ArrayLike, labels: Sequence[str], scores: npt.ArrayLike
) -> list[Box]:
    """Boxes as most detectors have them: an array of N x 4 corners (x_min, y_min, x_max, y_max in px), N labels, N scores.

    Raises:
        FrameError: if the lengths differ.
    """
    count = len(labels)
    rows = numbers(corners, "corners", (count, 4)).tolist()
    each = numbers(scores, "scores", (count,)).tolist()
    return [Box(tuple(row), label, score) for row, label, score in zip(rows, labels, each)]


def numbers(array: npt.ArrayLike, name: str, shape: tuple[int, ...]) -> npt.NDArray[np.float64]:
    """An array of this shape."""
    try:
        found = np.asarray(array, dtype=np.float64)
    except (TypeError, ValueError):
        raise FrameError(f"{name} has to be an array of numbers") from None
    if found.shape == (0,) and 0 in shape:
        found = found.reshape(shape)
    if found.shape != shape:
        raise FrameError(f"{name} has to have the shape {shape}, not {found.shape}")
    return found


def tuple_of(array: npt.ArrayLike, name: str, count: int) -> tuple[float, ...]:
    """So many numbers."""
    return tuple(numbers(array, name, (count,)).tolist())


def as_pose(pose: Pose | npt.ArrayLike) -> Pose:
    """A pose, or a matrix that is one."""
    return pose if isinstance(pose, Pose) else Pose.from_matrix(pose)


@dataclass(frozen=True)
class DepthBytes:
    """Depth as the compiled half takes it, row by row."""

    width: int
    height: int
    data: bytes
    is_millimetres: bool

    @staticmethod
    def of(depth: npt.NDArray[Any]) -> DepthBytes:
        """Of an array of ``float32`` (m) or ``uint16`` (mm), in any order in memory."""
        array = np.asarray(depth)
        if array.dtype.name not in ("float32", "uint16"):
            raise FrameError(
                f"depth has the type {array.dtype}; it has to be float32 (metres) or uint16 (millimetres)"
            )
        if array.ndim != 2:
            raise FrameError(f"depth has to have the shape (height, width), not {array.shape}")
        native = array.astype(array.dtype.newbyteorder("="), copy=False)
        height, width = native.shape
        return DepthBytes(width, height, native.tobytes(), native.dtype == np.uint16)
