"""What several tests need."""

import os
from pathlib import Path

import pytest
from ellipsoid_slam import ObjectMap, replay

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def desk() -> Path:
    """The demo bag: once round a desk."""
    return ROOT / "bags/desk.mcap"


@pytest.fixture(scope="session")
def desk_map(desk: Path) -> ObjectMap:
    """What becomes of it."""
    return replay(desk).map


@pytest.fixture(scope="session")
def program() -> Path:
    """The program on the same build."""
    return Path(os.environ.get("ELLIPSOID_SLAM", ROOT / "target/debug/ellipsoid_slam"))
