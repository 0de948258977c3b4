"""Solves a graph with GTSAM: gtsam_optimum.py GRAPH.json prints the optimum.

An ellipsoid is a Pose3 and a Vector3 of the logarithms of its semi-axes. Its observation is written down here once
more, from its definition alone, with derivatives by differences.
"""

import itertools
import json
import sys

import gtsam
import numpy as np
from gtsam.symbol_shorthand import L, S, X

# The names of a body's axes: quarter turns about its z axis, and the same turned over. Odd ones exchange x and y.
QUARTERS = [gtsam.Rot3.Rz(i * np.pi / 2) for i in range(4)]
NAMES = [
    (turn * quarter, i % 2 == 1)
    for turn, (i, quarter) in itertools.product(
        [gtsam.Rot3(), gtsam.Rot3.Rx(np.pi)], enumerate(QUARTERS)
    )
]


def pose(numbers):
    x, y, z, qx, qy, qz, qw = numbers
    return gtsam.Pose3(gtsam.Rot3.Quaternion(qw, qx, qy, qz), np.array([x, y, z]))


def numbers(pose):
    q = pose.rotation().toQuaternion()
    return [*pose.translation(), q.x(), q.y(), q.z(), q.w()]


class Observation:
    """Rotation vector, translation and semi-axes of an object, along the axes of its measurement."""

    def __init__(self, factor):
        self.measured, self.semi_axes = pose(factor["pose"]), np.array(factor["semi_axes"])
        self.sigmas = np.array(factor["sigmas"])
        self.sigmas[6:] *= self.semi_axes
        if factor["outline"] == "ellipsoid":
            a, b, _ = self.semi_axes**2
            self.sigmas[2] /= abs(a - b) / (a + b)

    def error(self, camera, body, log_semi_axes):
        found = self.measured.between(camera.between(body))
        residuals = []
        for turn, is_swapped in NAMES:
            sizes = np.exp(log_semi_axes)
            sizes = sizes[[1, 0, 2]] if is_swapped else sizes
            rotation = gtsam.Rot3.Logmap(found.rotation() * turn)
            residuals.append(np.hstack([rotation, found.translation(), sizes - self.semi_axes]))
        return min(residuals, key=lambda r: np.sum((r / self.sigmas) ** 2))

    def __call__(self, factor, values, jacobians):
        x, l, s = factor.keys()
        at = [values.atPose3(x), values.atPose3(l), values.atVector(s)]
        if jacobians is not None:
            for i in range(3):
                jacobians[i] = self.derivative(at, i)
        return self.error(*at)

    def derivative(self, at, i, step=1e-6):
        def moved(delta):
            changed = at[i] + delta if i == 2 else at[i].retract(delta)
            return self.error(*at[:i], changed, *at[i + 1 :])

        directions = step * np.eye(3 if i == 2 else 6)
        return np.column_stack([(moved(d) - moved(-d)) / (2 * step) for d in directions])


def make(factor):
    if factor["kind"] == "observation":
        observation = Observation(factor)
        noise = gtsam.noiseModel.Robust.Create(
            gtsam.noiseModel.mEstimator.Huber.Create(factor["huber"]),
            gtsam.noiseModel.Diagonal.Sigmas(observation.sigmas),
        )
        keys = [X(factor["from"]), L(factor["to"]), S(factor["to"])]
        return gtsam.CustomFactor(noise, keys, observation)
    noise = gtsam.noiseModel.Diagonal.Sigmas(np.array(factor["sigmas"]))
    if factor["kind"] == "prior":
        return gtsam.PriorFactorPose3(X(factor["to"]), pose(factor["pose"]), noise)
    return gtsam.BetweenFactorPose3(X(factor["from"]), X(factor["to"]), pose(factor["pose"]), noise)


def main(path):
    with open(path) as file:
        problem = json.load(file)
    graph, initial = gtsam.NonlinearFactorGraph(), gtsam.Values()
    for i, at in enumerate(problem["poses"]):
        initial.insert(X(i), pose(at))
    for i, body in enumerate(problem["ellipsoids"]):
        initial.insert(L(i), pose(body["pose"]))
        initial.insert(S(i), np.log(body["semi_axes"]))
    for factor in problem["factors"]:
        graph.push_back(make(factor))
    parameters = gtsam.LevenbergMarquardtParams()
    parameters.setRelativeErrorTol(1e-13)
    parameters.setAbsoluteErrorTol(0)
    parameters.setMaxIterations(200)
    optimum = gtsam.LevenbergMarquardtOptimizer(graph, initial, parameters).optimize()
    bodies = [
        {"pose": numbers(optimum.atPose3(L(i))), "semi_axes": list(np.exp(optimum.atVector(S(i))))}
        for i in range(len(problem["ellipsoids"]))
    ]
    poses = [numbers(optimum.atPose3(X(i))) for i in range(len(problem["poses"]))]
    answer = {"initial_cost": graph.error(initial), "cost": graph.error(optimum)}
    print(json.dumps({**answer, "poses": poses, "ellipsoids": bodies}))


main(sys.argv[1])
