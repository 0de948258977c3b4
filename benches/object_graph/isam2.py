"""Drives through a world with GTSAM's iSAM2: isam2.py WORLD.json REPEATS prints times, cost and the batch optimum's cost.

All factors are GTSAM's own. An object is a Pose3, seen through a BetweenFactorPose3, and a Vector3 of the logarithms of
its semi-axes, of which every sight is a prior: a smaller problem than ours, whose factors have nine dimensions. A
keyframe's processor time is that of ISAM2.update and of reading the newest pose; factors are made before. Parameters are
GTSAM's defaults.
"""

import json
import sys
import time

import gtsam
import numpy as np
from gtsam.symbol_shorthand import L, S, X


def pose(numbers):
    x, y, z, qx, qy, qz, qw = numbers
    return gtsam.Pose3(gtsam.Rot3.Quaternion(qw, qx, qy, qz), np.array([x, y, z]))


def noises(world):
    def gaussian(key, part=slice(None)):
        return gtsam.noiseModel.Diagonal.Sigmas(np.array(world[key][part]))

    def robust(part):
        huber = gtsam.noiseModel.mEstimator.Huber.Create(world["huber"])
        return gtsam.noiseModel.Robust.Create(huber, gaussian("seen_sigmas", part))

    steps = gaussian("prior_sigmas"), gaussian("step_sigmas")
    return *steps, robust(slice(0, 6)), robust(slice(6, 9))


def drive(world):
    """One run: the times (ms), all factors and the estimate at the end."""
    prior_noise, step_noise, pose_noise, size_noise = noises(world)
    isam, everything = gtsam.ISAM2(gtsam.ISAM2Params()), gtsam.NonlinearFactorGraph()
    newest, known, times = gtsam.Pose3(), set(), []
    for at, keyframe in enumerate(world["keyframes"]):
        graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        step = pose(keyframe["step"])
        initial = newest.compose(step)
        values.insert(X(at), initial)
        if at == 0:
            graph.push_back(gtsam.PriorFactorPose3(X(0), initial, prior_noise))
        else:
            graph.push_back(gtsam.BetweenFactorPose3(X(at - 1), X(at), step, step_noise))
        for seen in keyframe["seen"]:
            i, measured = seen["object"], pose(seen["pose"])
            sizes = np.array(seen["log_semi_axes"])
            if i not in known:
                known.add(i)
                values.insert(L(i), initial.compose(measured))
                values.insert(S(i), sizes)
            graph.push_back(gtsam.BetweenFactorPose3(X(at), L(i), measured, pose_noise))
            graph.push_back(gtsam.PriorFactorVector(S(i), sizes, size_noise))
        everything.push_back(graph)
        start = time.process_time()
        isam.update(graph, values)
        newest = isam.calculateEstimatePose3(X(at))
        times.append(1e3 * (time.process_time() - start))
    return times, everything, isam.calculateEstimate()


def main(path, repeats):
    with open(path) as file:
        world = json.load(file)
    runs = [drive(world) for _ in range(repeats)]
    times = [min(of_keyframe) for of_keyframe in zip(*(run[0] for run in runs))]
    _, everything, estimate = runs[-1]
    parameters = gtsam.LevenbergMarquardtParams()
    parameters.setRelativeErrorTol(1e-9)
    batch = gtsam.LevenbergMarquardtOptimizer(everything, estimate, parameters).optimize()
    cost, batch_cost = everything.error(estimate), everything.error(batch)
    print(json.dumps({"times": times, "cost": cost, "batch_cost": batch_cost}))


main(sys.argv[1], int(sys.argv[2]))
