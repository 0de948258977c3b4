"""Object-level SLAM for indoor robots: RGB-D frames and 2D boxes in, a map of ellipsoids out."""

from .bags import Replay, replay
from .errors import BagError, Error, FrameError, MapError, SettingsError
from .frames import Box, Camera, Pose, boxes_from_arrays
from .objects import MapObject, ObjectMap, objects_array
from .slam import (
    BoxResult,
    Dropped,
    Keyframe,
    LatestPose,
    ObjectChange,
    ObjectSlam,
    Relocalised,
    StampedPose,
    Update,
    effective_settings,
)

__all__ = [
    "BagError",
    "Box",
    "BoxResult",
    "Camera",
    "Dropped",
    "Error",
    "FrameError",
    "Keyframe",
    "LatestPose",
    "MapError",
    "MapObject",
    "ObjectChange",
    "ObjectMap",
    "ObjectSlam",
    "Pose",
    "Relocalised",
    "Replay",
    "SettingsError",
    "StampedPose",
    "Update",
    "boxes_from_arrays",
    "effective_settings",
    "objects_array",
    "replay",
]
