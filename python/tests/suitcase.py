"""A made-up camera: it looks at a suitcase of 0.4 x 0.3 x 0.5 m that stands on the floor, and moves to the right."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from ellipsoid_slam import Box, Camera, ObjectSlam, Pose

CAMERA = Camera(160, 120, 130.0, 130.0, 79.5, 59.5)
LOW, HIGH = np.array([-0.2, -0.15, 0.0]), np.array([0.2, 0.15, 0.5])
START_NS = 1_700_000_000_000_000_000


@dataclass(frozen=True)
class Look:
    """What one look gives."""

    stamp_ns: int
    odom_from_camera: Pose
    depth_m: npt.NDArray[np.float32]
    box: Box

    @property
    def depth_mm(self) -> npt.NDArray[np.uint16]:
        """The same depth as most cameras have it; 0 where there is none."""
        return np.where(np.isfinite(self.depth_m), 1000 * self.depth_m, 0).round().astype(np.uint16)


def looks() -> Iterator[Look]:
    """Looks of a fifth of a second, from 1.2 m above the floor."""
    for i in range(6):
        eye = np.array([-1.6, 0.4 - 0.16 * i, 1.2])
        forward = np.array([0.0, 0.0, 0.25]) - eye
        forward /= np.linalg.norm(forward)
        right = np.cross(forward, [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        matrix = np.eye(4)
        matrix[:3] = np.stack([right, np.cross(forward, right), forward, eye], axis=1)
        depth_m, corners = rendered(matrix)
        box = Box(corners, "suitcase", 0.9)
        yield Look(START_NS + 200_000_000 * i, Pose.from_matrix(matrix), depth_m, box)


def rendered(
    matrix: npt.NDArray[np.float64],
) -> tuple[npt.NDArray[np.float32], tuple[float, float, float, float]]:
    """Depth along the optical axis, and the box round the suitcase."""
    u, v = np.meshgrid(np.arange(CAMERA.width), np.arange(CAMERA.height))
    x, y = (u - CAMERA.cx) / CAMERA.fx, (v - CAMERA.cy) / CAMERA.fy
    rays = np.stack([x, y, np.ones_like(x)], axis=-1) @ matrix[:3, :3].T
    origin = matrix[:3, 3]
    with np.errstate(divide="ignore"):
        floor = np.where(rays[..., 2] < 0, -origin[2] / rays[..., 2], np.inf)
        a, b = (LOW - origin) / rays, (HIGH - origin) / rays
    near, far = np.minimum(a, b).max(axis=-1), np.maximum(a, b).min(axis=-1)
    suitcase = np.where(near < far, near, np.inf)
    rows, columns = np.nonzero(suitcase < floor)
    corners = (columns.min(), rows.min(), columns.max(), rows.max())
    x_min, y_min, x_max, y_max = map(float, corners)
    return np.minimum(suitcase, floor).astype(np.float32), (x_min, y_min, x_max, y_max)


def seen() -> ObjectSlam:
    """A run that saw all looks."""
    slam = ObjectSlam()
    for look in looks():
        slam.see(look.stamp_ns, CAMERA, look.odom_from_camera, look.depth_m, [look.box])
    slam.finish()
    return slam
