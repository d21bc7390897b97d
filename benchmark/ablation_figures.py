# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""What two evaluations of the same scenes differ by, and how sure that is."""
import math
import random
import statistics

RESAMPLES = 1000
LEVELS = (0.85, 0.5)  # visible fractions of the recall
SHARES = [f"recall {level}" for level in LEVELS] + ["right"]


def share_counts(scene):
    """Per share (hits, total) in one scene, counted as `bin_picking evaluate` does."""
    counts = []
    for level in LEVELS:
        visible = [instance for instance in scene["instances"] if instance["visible_fraction"] >= level]
        counts.append((sum(instance["found_by"] is not None for instance in visible), len(visible)))
    right = sum(estimate["verdict"] in ("right", "hidden") for estimate in scene["estimates"])
    counts.append((right, len(scene["estimates"])))
    return counts


def share(counts, index):
    total = sum(scene[index][1] for scene in counts)
    return sum(scene[index][0] for scene in counts) / total if total else math.nan


def interval(values):
    """In which 95 % of the values lie, those that are not numbers left out."""
    values = sorted(value for value in values if not math.isnan(value))
    if not values:
        return [math.nan, math.nan]
    return [values[int(0.025 * (len(values) - 1))], values[math.ceil(0.975 * (len(values) - 1))]]


class Figures:
    """Of one evaluation."""

    def __init__(self, report):
        self.counts = [share_counts(scene) for scene in report["scenes"]]
        self.shares = [share(self.counts, index) for index in range(len(SHARES))]
        figures = report["all"]
        self.average_precision = figures["average_precision"]
        self.false_in_empty = figures["false_in_empty"]
        self.wrong = figures["wrong"] + figures["duplicates"]
        self.votes = sum(scene["counts"].get("votes", 0) for scene in report["scenes"])
        self.times = scene_times(report)
        self.has_parts = [bool(scene["instances"]) for scene in report["scenes"]]


def scene_times(report):
    return [statistics.median(scene["total_ms"]) for scene in report["scenes"]]


def resamplings(num_scenes):
    """Draws of scenes with replacement: whole scenes, because what is found in one bin hangs together."""
    generator = random.Random(1)
    return [[generator.randrange(num_scenes) for _ in range(num_scenes)] for _ in range(RESAMPLES)]


def compare_shares(default, other, draws):
    """Per share: by how much the other one is higher, and the 95 % interval of that difference."""
    differences = []
    for index in range(len(SHARES)):
        drawn = [share([other.counts[i] for i in draw], index) - share([default.counts[i] for i in draw], index)
                 for draw in draws]
        differences.append((other.shares[index] - default.shares[index], interval(drawn)))
    return differences


def compare_times(before, after, other, draws):
    """How many times as long the other one takes: geometric mean over the scenes with parts. It ran between two runs of
    the default, whose mean it is held against, so that a machine that gets slower or faster does not matter."""
    default = [(a + b) / 2 for a, b in zip(before, after)]
    drawn = [mean_ratio(default, other.times, [i for i in draw if other.has_parts[i]]) for draw in draws]
    return mean_ratio(default, other.times, scenes_with_parts(other)), interval(drawn)


def unsteadiness(before, after, figures):
    """By which factor two runs of the same differ: what a single ratio can be off by, whatever its interval says."""
    ratio = mean_ratio(before, after, scenes_with_parts(figures))
    return max(ratio, 1 / ratio)


def scenes_with_parts(figures):
    return [i for i, has_parts in enumerate(figures.has_parts) if has_parts]


def mean_ratio(times, others, scenes):
    """Geometric mean; not a number without scenes."""
    if not scenes:
        return math.nan
    return math.exp(statistics.fmean(math.log(others[i] / times[i]) for i in scenes))
