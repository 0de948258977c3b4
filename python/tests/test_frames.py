"""Frames of arrays: what comes of them, and what is refused."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from ellipsoid_slam import Box, Camera, FrameError, ObjectSlam, Pose, boxes_from_arrays
from suitcase import CAMERA, looks, seen

LOOK = next(looks())


def test_a_suitcase_is_found_where_it_stands() -> None:
    slam = ObjectSlam()
    updates = [
        slam.see(look.stamp_ns, CAMERA, look.odom_from_camera, look.depth_m, [look.box])
        for look in looks()
    ]
    updates.append(slam.finish())
    (found,) = slam.objects
    assert found.label == "suitcase" and found.outline == "cuboid"
    assert found.position == pytest.approx([0.0, 0.0, 0.25], abs=0.03)
    assert found.size == pytest.approx([0.4, 0.3, 0.5], abs=0.05)
    assert np.cos(2 * found.yaw) > 0.99, "a quarter turn is another suitcase"
    assert sum(found.labels.values()) == pytest.approx(1.0)

    results = [box for update in updates for keyframe in update.keyframes for box in keyframe.boxes]
    assert [box.object_id for box in results] == [found.id] * 6
    assert not any(box.refused for box in results)
    assert [c.kind for update in updates for c in update.changes] == ["confirmed"]
    assert sum(len(update.poses) for update in updates) == 6


def test_the_way_of_the_camera_is_known() -> None:
    slam = seen()
    for look, pose in zip(looks(), slam.trajectory):
        assert pose.stamp_ns == look.stamp_ns
        assert pose.map_from_base.position == pytest.approx(look.odom_from_camera.position, abs=0.02)
    latest = slam.pose
    assert latest is not None and latest.covariance is not None
    assert latest.map_from_base == slam.trajectory[-1].map_from_base
    assert np.allclose(latest.covariance, latest.covariance.T)
    assert np.linalg.eigvalsh(latest.covariance).min() > 0
    assert ObjectSlam().pose is None


def as_it_is(depth: np.ndarray) -> np.ndarray:
    return depth


def in_columns(depth: np.ndarray) -> np.ndarray:
    return np.asfortranarray(depth)


def strided(depth: np.ndarray) -> np.ndarray:
    wide = np.full((2 * depth.shape[0], 3 * depth.shape[1]), 7, depth.dtype)
    wide[::2, ::3] = depth
    return wide[::2, ::3]


def backwards(depth: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(depth[::-1, ::-1])[::-1, ::-1]


def big_endian(depth: np.ndarray) -> np.ndarray:
    return depth.astype(depth.dtype.newbyteorder(">"))


@pytest.mark.parametrize("order", [as_it_is, in_columns, strided, backwards, big_endian])
@pytest.mark.parametrize("kind", ["depth_m", "depth_mm"])
def test_the_order_in_memory_does_not_matter(
    order: Callable[[np.ndarray], np.ndarray], kind: str
) -> None:
    def made(order: Callable[[np.ndarray], np.ndarray]) -> str:
        slam = ObjectSlam()
        for look in looks():
            depth = order(getattr(look, kind))
            slam.see(look.stamp_ns, CAMERA, look.odom_from_camera, depth, [look.box])
        slam.finish()
        assert len(slam.objects) == 1
        return slam.map.to_json()

    assert made(order) == made(as_it_is)


def test_matrices_are_poses() -> None:
    pose = LOOK.odom_from_camera
    again = Pose.from_matrix(pose.matrix)
    assert np.allclose(again.matrix, pose.matrix, atol=1e-15)
    update = ObjectSlam().see(0, CAMERA, pose.matrix, LOOK.depth_m, [LOOK.box])
    assert not update.dropped


BAD_FRAMES: list[tuple[dict[str, Any], str]] = [
    ({"depth": LOOK.depth_m.astype(np.float64)}, "depth has the type float64"),
    ({"depth": LOOK.depth_mm.astype(np.int32)}, "depth has the type int32"),
    ({"depth": [["far", "near"]]}, "depth has the type"),
    ({"depth": LOOK.depth_m[np.newaxis]}, "shape (height, width), not (1, 120, 160)"),
    ({"depth": LOOK.depth_m.T}, "depth is 120x160, but the camera 160x120"),
    ({"depth": LOOK.depth_m[:0]}, "depth is 160x0"),
    ({"pose": np.eye(3)}, "the pose has to have the shape (4, 4), not (3, 3)"),
    ({"pose": 2 * np.eye(4)}, "the matrix is no pose"),
    ({"pose": np.diag([1.0, 1.0, -1.0, 1.0])}, "the matrix is no pose"),
    ({"pose": np.full((4, 4), np.nan)}, "the matrix is no pose"),
    ({"pose": "here"}, "the pose has to be an array of numbers"),
    ({"pose": Pose((0.0, np.inf, 0.0))}, "a pose needs a finite position"),
    ({"pose": Pose((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0))}, "a quaternion x, y, z, w of unit"),
    ({"camera": Camera(160, 120, 0.0, 130.0, 80.0, 60.0)}, "the camera is not calibrated"),
    ({"camera": Camera(160, 120, 1.0, 1.0, np.nan, 60.0)}, "is not a finite number"),
    ({"camera": Camera(160, 120, 1.0, 1.0, 8.0, 6.0, (0.1, 0.2))}, "2 coefficients of distortion"),
    ({"boxes": [LOOK.box, Box((9.0, 9.0, 5.0, 5.0), "cup", 0.5)]}, "box 1: the box is inverted"),
    ({"boxes": [Box((np.nan, 0.0, 5.0, 5.0), "cup", 0.5)]}, "box 0: the box is inverted"),
    ({"boxes": [Box((0.0, 0.0, 5.0, 5.0), "cup", 1.5)]}, "box 0: the detection names no class"),
    ({"boxes": [Box((0.0, 0.0, 5.0, 5.0), "", 0.5)]}, "box 0: the detection names no class"),
]


@pytest.mark.parametrize("wrong, words", BAD_FRAMES, ids=[words for _, words in BAD_FRAMES])
def test_what_cannot_be_is_refused_in_a_sentence(wrong: dict[str, Any], words: str) -> None:
    slam = ObjectSlam()
    good: dict[str, Any] = {"camera": CAMERA, "pose": LOOK.odom_from_camera, "depth": LOOK.depth_m, "boxes": [LOOK.box]}
    with pytest.raises(FrameError) as raised:
        given = good | wrong
        slam.see(0, given["camera"], given["pose"], given["depth"], given["boxes"])
    assert words in str(raised.value)
    assert isinstance(raised.value, ValueError)
    # Nothing has changed: the same frame is taken when it is right.
    assert not slam.see(0, CAMERA, LOOK.odom_from_camera, LOOK.depth_m, [LOOK.box]).dropped


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda: Pose((0.0, 0.0)), "position has to have the shape (3,), not (2,)"),  # type: ignore[arg-type]
        (lambda: Box((1.0, 2.0, 3.0), "cup", 0.5), "corners has to have the shape (4,)"),  # type: ignore[arg-type]
        (lambda: boxes_from_arrays(np.zeros((2, 4)), ["cup"], [0.5]), "corners has to have the shape (1, 4)"),
        (lambda: boxes_from_arrays(np.zeros((1, 4)), ["cup"], [0.5, 0.5]), "scores has to have the shape (1,)"),
    ],
)
def test_parts_of_frames_have_their_shapes(make: Callable[[], object], words: str) -> None:
    with pytest.raises(FrameError) as raised:
        make()
    assert words in str(raised.value)


def test_boxes_come_as_detectors_have_them() -> None:
    corners = np.array([[1, 2, 30, 40], [5, 6, 70, 80]], dtype=np.float32)
    boxes = boxes_from_arrays(corners, ["cup", "book"], np.array([0.5, 0.75], dtype=np.float32))
    assert boxes == [Box((1, 2, 30, 40), "cup", 0.5), Box((5, 6, 70, 80), "book", 0.75)]
    assert boxes_from_arrays([], [], []) == []


def test_a_stamp_that_does_not_grow_is_told() -> None:
    slam = ObjectSlam()
    told = []
    for look in [*looks()][:3] + [LOOK]:
        update = slam.see(look.stamp_ns, CAMERA, look.odom_from_camera, look.depth_m, [look.box])
        told += [dropped.why for dropped in update.dropped]
    assert told and all(isinstance(why, str) for why in told)


