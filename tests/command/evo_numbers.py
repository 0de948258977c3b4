"""What evo says of pairs of trajectories: evo_numbers.py FOLDER..., each with true.tum and estimate.tum.

Prints a list of {"poses", "ate", "aligned_ate", "rpe_m", "rpe_deg"}, where errors are [rmse, mean, median, max].
"""

import copy
import json
import sys
from pathlib import Path

from evo.core import metrics, sync
from evo.core.metrics import PoseRelation, StatisticsType, Unit
from evo.tools import file_interface

STATISTICS = [StatisticsType.rmse, StatisticsType.mean, StatisticsType.median, StatisticsType.max]


def statistics(metric, truth, estimate):
    metric.process_data((truth, estimate))
    return [float(metric.get_statistic(statistic)) for statistic in STATISTICS]


def numbers(folder):
    read = lambda name: file_interface.read_tum_trajectory_file(str(folder / name))
    truth, estimate = sync.associate_trajectories(read("true.tum"), read("estimate.tum"), max_diff=0.02)
    aligned = copy.deepcopy(estimate)
    aligned.align(truth)
    step = lambda relation: metrics.RPE(relation, delta=1, delta_unit=Unit.frames, all_pairs=False)
    position = PoseRelation.translation_part
    return {
        "poses": estimate.num_poses,
        "ate": statistics(metrics.APE(position), truth, estimate),
        "aligned_ate": statistics(metrics.APE(position), truth, aligned),
        "rpe_m": statistics(step(position), truth, estimate),
        "rpe_deg": statistics(step(PoseRelation.rotation_angle_deg), truth, estimate),
    }


print(json.dumps([numbers(Path(folder)) for folder in sys.argv[1:]]))
