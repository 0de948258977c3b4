"""Runs on bags of ROS 2."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike, fspath

from . import _native
from .objects import ObjectMap
from .slam import ObjectSlam, Settings, settings_argument

__all__ = ["Replay", "replay"]


@dataclass(frozen=True)
class Replay:
    """What came of a bag."""

    slam: ObjectSlam
    """The run at its end: objects, map, trajectory."""
    messages: int
    """Messages read."""
    frames: int
    """RGB-D frames with a pose."""
    keyframes: int
    """Of these, with boxes."""
    dropped: Mapping[str, int]
    """Messages and frames that were not used, by reason."""
    refused_boxes: Mapping[str, int]
    """Boxes that gave no ellipsoid, by reason."""
    warnings: tuple[str, ...]
    """A sentence each."""

    @property
    def map(self) -> ObjectMap:
        """What the command ``replay`` writes into ``map.json``."""
        return self.slam.map


def replay(
    bag: str | PathLike[str],
    settings: Settings | None = None,
    *,
    config: str | PathLike[str] | None = None,
    topics: Mapping[str, str] | None = None,
    map: ObjectMap | None = None,
    start: tuple[float, float, float] | None = None,
) -> Replay:
    """Runs on a bag as fast as it can: the same bag and settings give the same bytes.

    Args:
        bag: a file (MCAP or SQLite) or a folder of rosbag2 with depth, camera info, boxes and odometry.
        settings: what differs from the defaults and from ``config``, by name.
        config: a parameter file.
        topics: the topic of a role where it is not the one that is found: ``{"depth": "/my/depth"}``.
        map: a saved map that is continued.
        start: about where the base starts in that map: x and y (m), yaw (deg).

    Raises:
        BagError: if the bag cannot be read, or lacks something.
        SettingsError: if a setting does not exist or cannot have its value, or a role does not exist.
        MapError: if the map cannot be.
    """
    given = [f"{role}:={topic}" for role, topic in (topics or {}).items()]
    run, record = _native.replay(fspath(bag), settings_argument(settings, config), given, map, start)
    return Replay(
        slam=ObjectSlam._of(run),
        messages=record["messages"],
        frames=record["frames"],
        keyframes=record["keyframes"],
        dropped=record["dropped"],
        refused_boxes=record["refused_boxes"],
        warnings=tuple(record["warnings"]),
    )
