"""Settings: the same names, ranges and sentences as in parameter files."""

from pathlib import Path

import numpy as np
import pytest
from ellipsoid_slam import ObjectSlam, SettingsError, effective_settings, replay


def test_a_dictionary_counts_more_than_a_file(tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text("/**:\n  ros__parameters:\n    sync: {slop_s: 0.1, max_delay_s: 2.0}\n")
    settings = effective_settings({"sync.slop_s": np.float32(0.25)}, config=file)
    assert settings["sync"]["slop_s"] == 0.25 and settings["sync"]["max_delay_s"] == 2.0
    nested = effective_settings({"sync": {"slop_s": 0.5}, "slam.walls": False})
    assert nested["sync"]["slop_s"] == 0.5 and nested["slam"]["walls"] is False
    assert effective_settings() == effective_settings({})


@pytest.mark.parametrize(
    "settings, words",
    [
        ({"sync.slopp_s": 0.1}, "unknown key `sync.slopp_s`; did you mean `sync.slop_s`?"),
        ({"sync.slop_s": -1.0}, "`sync.slop_s` is -1, which is not between 0 and 1"),
        ({"sync.slop_s": "wide"}, "`sync.slop_s` must be a number"),
        ({"sync.slop_s": float("nan")}, "the settings are not plain values"),
        ({"sync.slop_s": object()}, "of the type object, which no setting has"),
        ({"perception.fit": "spline"}, "spline"),
        ({"mapping.labels.wrong": 0.2}, "mapping.labels.confused"),
        ({3: 4}, "unknown key `3`"),
    ],
)
def test_mistakes_are_named(settings: dict[str, object], words: str) -> None:
    for use in (ObjectSlam, effective_settings, lambda given: replay("no.mcap", given)):
        with pytest.raises(SettingsError) as raised:
            use(settings)
        assert words in str(raised.value)


def test_the_file_with_the_mistake_is_named(tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    with pytest.raises(SettingsError, match="mine.yaml: No such file"):
        ObjectSlam(config=file)
    file.write_text("ellipsoid_slam:\n  ros__parameters:\n    snyc: {}\n")
    with pytest.raises(SettingsError, match="mine.yaml: unknown key `snyc`"):
        ObjectSlam(config=file)
