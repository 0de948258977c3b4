"""Maps: the file, the array, and what a later run makes of them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from ellipsoid_slam import MapError, ObjectMap, ObjectSlam, SettingsError
from suitcase import CAMERA, looks, seen


def test_a_map_that_is_read_and_written_has_the_same_bytes(desk_map: ObjectMap, tmp_path: Path) -> None:
    text = desk_map.to_json()
    assert ObjectMap.from_json(text).to_json() == text
    desk_map.save(tmp_path / "map.json")
    assert (tmp_path / "map.json").read_text() == text
    again = ObjectMap.load(tmp_path / "map.json")
    assert again == ObjectMap.from_json(text)
    assert len(again) == len(desk_map) > 5
    assert [found.id for found in again] == [found.id for found in desk_map]


def test_objects_are_equal_when_all_their_fields_are(desk_map: ObjectMap) -> None:
    first = desk_map.objects[0]
    assert replace(first) == first != replace(first, existence=0.5)
    other = first.covariance.copy()
    other[0, 0] *= 2
    assert replace(first, covariance=other) != first
    with pytest.raises(ValueError, match="read-only"):
        first.covariance[0, 0] = 1.0


def test_a_structured_array_has_what_the_objects_have(desk_map: ObjectMap) -> None:
    array = desk_map.array()
    assert len(array) == len(desk_map)
    for row, found in zip(array, desk_map):
        assert (row["id"], row["label"], row["outline"]) == (found.id, found.label, found.outline)
        assert tuple(row["position"]) == found.position
        assert tuple(row["semi_axes"]) == found.semi_axes
        assert np.array_equal(row["covariance"], found.covariance)
        height = found.support_height_m
        assert np.isnan(row["support_height_m"]) if height is None else row["support_height_m"] == height
    heights = array["position"][array["label"] == "cup"][:, 2]
    assert len(heights) and (heights > 0.5).all(), "cups stand on the desk"
    assert len(ObjectMap("map", ()).array()) == 0


def test_a_map_can_be_edited(desk_map: ObjectMap, tmp_path: Path) -> None:
    first, *rest = desk_map.objects
    renamed = replace(first, label="workbench", labels={"workbench": 1.0})
    edited = ObjectMap(desk_map.frame_id, (renamed, *rest[1:]))
    edited.save(tmp_path / "edited.json")
    again = ObjectMap.load(tmp_path / "edited.json")
    assert again[first.id].label == "workbench" and len(again) == len(desk_map) - 1
    with pytest.raises(KeyError):
        again[rest[0].id]


def test_a_map_that_cannot_be_is_refused_in_a_sentence(desk_map: ObjectMap, tmp_path: Path) -> None:
    first = desk_map.objects[0]
    wrong = [
        (replace(first, label=""), "label"),
        (replace(first, semi_axes=(1.0, -1.0, 1.0)), "semi_axes have to be positive"),
        (replace(first, covariance=np.zeros((9, 9))), "covariance has to be"),
        (replace(first, covariance=np.full((9, 9), np.nan)), "covariance has to be"),
        (replace(first, orientation=(0.0, 0.0, 0.0, 2.0)), "quaternion of unit length"),
        (replace(first, outline="superquadric"), "superquadric with exponents"),
    ]
    for bad, words in wrong:
        with pytest.raises(MapError, match=f"object {first.id}: .*{words}"):
            ObjectMap("map", (bad,)).save(tmp_path / "map.json")
    with pytest.raises(MapError, match="two objects have the id"):
        ObjectMap("map", (first, first)).to_json()
    assert not (tmp_path / "map.json").exists()


def test_a_file_that_is_no_map_is_neither_read_nor_lost(desk_map: ObjectMap, tmp_path: Path) -> None:
    with pytest.raises(MapError, match="nothing.json: the map cannot be read"):
        ObjectMap.load(tmp_path / "nothing.json")
    letter = tmp_path / "letter.json"
    letter.write_text('{"dear": "reader"}')
    with pytest.raises(MapError, match="letter.json: not a map file"):
        ObjectMap.load(letter)
    with pytest.raises(MapError, match="not overwritten"):
        desk_map.save(letter)
    assert letter.read_text() == '{"dear": "reader"}'
    with pytest.raises(MapError, match="not a map file"):
        ObjectMap.from_json("[]")


def test_a_map_is_continued_where_the_robot_is_said_to_start(tmp_path: Path) -> None:
    monday = seen().map
    assert len(monday) == 1
    # The camera is the base, and it looks along its z axis: its heading is that of its x axis, to the right.
    start = next(looks()).odom_from_camera
    tuesday = ObjectSlam(map=monday, start=(start.position[0], start.position[1], 0.0))
    assert tuesday.waits_because
    for look in looks():
        tuesday.see(look.stamp_ns, CAMERA, look.odom_from_camera, look.depth_m, [look.box])
    tuesday.finish()
    assert tuesday.map[monday.objects[0].id].label == "suitcase"


def test_a_small_map_whose_place_is_not_recognised_is_kept_beside(tmp_path: Path) -> None:
    monday = seen().map
    elsewhere = replace(monday.objects[0], position=(50.0, 0.0, 0.25), label="bed", labels={"bed": 1.0})
    slam = ObjectSlam(map=ObjectMap("map", (elsewhere,)))
    for look in looks():
        slam.see(look.stamp_ns, CAMERA, look.odom_from_camera, look.depth_m, [look.box])
    slam.finish()
    assert slam.waits_because
    beside = slam.save(tmp_path / "map.json")
    assert beside == tmp_path / "local_map.json"
    assert [found.label for found in ObjectMap.load(tmp_path / "map.json")] == ["bed"]
    assert [found.label for found in ObjectMap.load(beside)] == ["suitcase"]


def test_a_start_needs_a_map() -> None:
    with pytest.raises(SettingsError, match="start is of a map"):
        ObjectSlam(start=(0.0, 0.0, 0.0))
    with pytest.raises(SettingsError, match="expected three numbers"):
        ObjectSlam(map=ObjectMap("map", ()), start=(0.0, float("nan"), 0.0))
