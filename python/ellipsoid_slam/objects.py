"""Objects and maps of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields
from os import PathLike, fspath
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _native, _records
from ._records import Outline, Quaternion, Vector3
from .frames import Pose, tuple_of

__all__ = ["MapObject", "ObjectMap", "objects_array"]


@dataclass(frozen=True, eq=False)
class MapObject:
    """An object: where it is, how large, and how sure that is.

    Its frame is upright (z up), with the longer horizontal axis first.
    """

    id: int
    """Its identity, never used twice in a map."""
    label: str
    """The most probable label."""
    labels: Mapping[str, float]
    """Probability of each label."""
    existence: float
    """Probability that it exists."""
    observations: int
    """Measurements that were joined to it."""
    first_seen_ns: int
    """Stamp of the first measurement."""
    last_seen_ns: int
    """Stamp of the latest measurement."""
    position: Vector3
    """Its centre in the map (m)."""
    orientation: Quaternion
    """Of its frame in the map: x, y, z, w."""
    semi_axes: Vector3
    """Half its extents along its own axes (m)."""
    outline: Outline
    """What fills its extents."""
    exponents: tuple[float, float] | None
    """Of a superquadric's profile and footprint."""
    support_height_m: float | None
    """Height of the plane it stands on, if one was seen."""
    covariance: npt.NDArray[np.float64]
    """9 x 9, of [rotation (rad), position (m), logarithms of the semi-axes], a right perturbation in its own frame."""
    name: str | None = None
    """What people call it, if they have named it."""
    locked: bool = False
    """Whether it stays in the map and in its place whatever images say."""

    def __post_init__(self) -> None:
        for name, count in [("position", 3), ("orientation", 4), ("semi_axes", 3)]:
            object.__setattr__(self, name, tuple_of(getattr(self, name), name, count))
        covariance = np.array(self.covariance, dtype=np.float64).reshape(9, 9)
        covariance.flags.writeable = False
        object.__setattr__(self, "covariance", covariance)

    @property
    def pose(self) -> Pose:
        """``map_from_object``."""
        return Pose(self.position, self.orientation)

    @property
    def size(self) -> Vector3:
        """Its full extents along its own axes (m)."""
        length, width, height = self.semi_axes
        return (2 * length, 2 * width, 2 * height)

    @property
    def yaw(self) -> float:
        """Heading of its longer horizontal axis (rad), counter-clockwise seen from above."""
        x_axis = self.pose.rotation[:, 0]
        return float(np.arctan2(x_axis[1], x_axis[0]))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, MapObject):
            return NotImplemented
        names = (f.name for f in fields(self))
        return all(np.array_equal(getattr(self, name), getattr(other, name)) for name in names)

    @staticmethod
    def _of(record: _records.ObjectRecord) -> MapObject:
        return MapObject(**record)  # type: ignore[arg-type]  # its covariance is a list until it is made


@dataclass(frozen=True)
class ObjectMap:
    """A map as ``map.json`` has it: what a later run continues."""

    frame_id: str
    """The frame that poses are in; its z axis is up."""
    objects: tuple[MapObject, ...]
    """No identity twice."""

    @staticmethod
    def load(path: str | PathLike[str]) -> ObjectMap:
        """Reads a map file.

        Raises:
            MapError: if it cannot be read or is no map.
        """
        return ObjectMap._of(_native.read_map(fspath(path)))

    @staticmethod
    def from_json(text: str) -> ObjectMap:
        """A map from the text of a map file.

        Raises:
            MapError: if it is no map.
        """
        return ObjectMap._of(_native.parse_map(text))

    def save(self, path: str | PathLike[str]) -> None:
        """Writes a map file; the one that is there stays until the new one is whole.

        Raises:
            MapError: if the map cannot be, what is there is no map, or it cannot be written.
        """
        _native.write_map(fspath(path), self)

    def to_json(self) -> str:
        """The text of the map file: the same that the command ``replay`` writes.

        Raises:
            MapError: if the map cannot be.
        """
        return _native.map_json(self)

    def array(self) -> npt.NDArray[np.void]:
        """The objects as a structured array: see :func:`objects_array`."""
        return objects_array(self.objects)

    def __iter__(self) -> Iterator[MapObject]:
        return iter(self.objects)

    def __len__(self) -> int:
        return len(self.objects)

    def __getitem__(self, identity: int) -> MapObject:
        """The object with this identity."""
        for found in self.objects:
            if found.id == identity:
                return found
        raise KeyError(identity)

    @staticmethod
    def _of(record: _records.MapRecord) -> ObjectMap:
        return ObjectMap(record["frame_id"], tuple(map(MapObject._of, record["objects"])))


def objects_array(objects: Iterable[MapObject]) -> npt.NDArray[np.void]:
    """Objects as a structured array with a row an object.

    Its fields are those of :class:`MapObject` but for ``labels``, ``exponents`` and ``name``; a support height that is not known
    is NaN.
    """
    rows = list(objects)
    names = [f.name for f in fields(MapObject) if f.name not in ("labels", "exponents", "name")]
    longest = max((len(found.label) for found in rows), default=0)
    types: dict[str, Any] = {
        "id": "u8",
        "label": f"U{max(longest, 1)}",
        "existence": "f8",
        "observations": "u4",
        "first_seen_ns": "i8",
        "last_seen_ns": "i8",
        "position": ("f8", 3),
        "orientation": ("f8", 4),
        "semi_axes": ("f8", 3),
        "outline": "U12",
        "support_height_m": "f8",
        "covariance": ("f8", (9, 9)),
        "locked": "?",
    }
    array = np.zeros(len(rows), dtype=[(name, *_listed(types[name])) for name in names])
    for row, found in zip(array, rows):
        for name in names:
            value = getattr(found, name)
            row[name] = np.nan if value is None else value
    return array


def _listed(kind: Any) -> tuple[Any, ...]:
    return kind if isinstance(kind, tuple) else (kind,)
