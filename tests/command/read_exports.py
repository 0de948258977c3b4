"""Reads a map's exports with other people's programs and compares them with the map: read_exports.py FOLDER."""

import csv
import json
import sys
import xml.etree.ElementTree as ElementTree
from math import pi
from pathlib import Path

import numpy as np
import trimesh

folder = Path(sys.argv[1])
objects = json.loads((folder / "map.json").read_text())["objects"]
positions = np.array([o["position"] for o in objects])
sizes = 2 * np.array([o["semi_axes"] for o in objects])

with open(folder / "map.csv", newline="") as file:
    rows = list(csv.DictReader(file))
numbers = lambda *names: np.array([[float(row[name]) for name in names] for row in rows])
assert np.allclose(numbers("x", "y", "z"), positions)
assert np.allclose(numbers("qx", "qy", "qz", "qw"), [o["orientation"] for o in objects])
assert np.allclose(numbers("size_x", "size_y", "size_z"), sizes)
assert [row["label"] for row in rows] == [o["label"] for o in objects]
assert [row["name"] for row in rows] == [o.get("name", "") for o in objects] != ["", "", "", ""]
assert [row["outline"] for row in rows] == ["cuboid", "cylinder", "ellipsoid", "superquadric"]
sigmas = numbers("sigma_x", "sigma_y", "sigma_z")
assert (0 < sigmas).all() and (sigmas < 0.2).all(), sigmas

mesh = trimesh.load(folder / "map.ply")
assert mesh.is_watertight and mesh.is_winding_consistent
bodies = sorted(mesh.split(), key=lambda body: body.centroid[0])
boxes = sizes.prod(axis=1)
filled = np.array([body.volume for body in bodies]) / boxes
assert np.allclose(filled[:3], [1, pi / 4, pi / 6], rtol=0.06), filled
assert filled[1] < filled[3] < 1, filled
assert np.allclose([body.centroid for body in bodies], positions, atol=1e-6)
assert len({tuple(color) for color in mesh.visual.vertex_colors}) == 2

features = json.loads((folder / "map.geojson").read_text())["features"]
for feature, body, o in zip(features, bodies, objects, strict=True):
    ring = np.array(feature["geometry"]["coordinates"][0])
    assert (ring[0] == ring[-1]).all() and feature["properties"]["label"] == o["label"]
    assert feature["properties"]["name"] == o.get("name")
    (x, y), (next_x, next_y) = ring[:-1].T, ring[1:].T
    area = 0.5 * (x * next_y - next_x * y).sum()
    sides = 2 * np.array(o["semi_axes"])
    share = area / (sides[0] * sides[1])
    assert 0.75 < share < 1.0001, share
    low, high = body.bounds
    assert np.allclose(ring.min(axis=0), low[:2], atol=0.02) and np.allclose(ring.max(axis=0), high[:2], atol=0.02)

world = ElementTree.parse(folder / "map.sdf").getroot().find("world")
models = world.findall("model")
assert len({model.get("name") for model in models}) == len(objects)
assert models[1].get("name") == 'the_"blue"_one_2'
for model, o in zip(models, objects, strict=True):
    pose = [float(number) for number in model.find("pose").text.split()]
    assert np.allclose(pose[:3], o["position"]) and model.find("static").text == "true"
shapes = [model.find("link/collision/geometry")[0] for model in models]
assert [shape.tag for shape in shapes] == ["box", "box", "ellipsoid", "box"], shapes
assert np.allclose([float(side) for side in shapes[0].find("size").text.split()], sizes[0])
