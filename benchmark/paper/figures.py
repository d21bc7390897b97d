# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""From the results of cells to figures."""
import json
import math
import statistics

import stamps

MAX_ADD = 0.1        # of the diameter: a pose is a success below it
GRASPABLE = 0.85     # matching rate above which the paper grasps (Section 3.2.2)
NAN = math.nan


class Results:
    """What has been run so far, by the name of the cell."""

    def __init__(self, plan, out, picking=(), code=""):
        self.picking = list(picking)  # rows of Table 8
        self.by_name = {}
        self.stamps = {}    # of the same names
        self.left_out = []  # names of results of other code, data or options
        self.absent = []    # names of cells that have not been run
        for cell in plan.cells:
            file = out / "cells" / f"{cell.name}.json"
            stamp = stamps.read(out, cell.name)
            if not file.exists():
                self.absent.append(cell.name)
            elif stamp.get("specification") != stamps.digest(cell) or stamp.get("code") != code:
                self.left_out.append(cell.name)
            else:
                self.by_name[cell.name] = json.loads(file.read_text(encoding="utf-8"))
                self.stamps[cell.name] = stamp

    def stamps_of(self, starts):
        return [stamp for name, stamp in self.stamps.items() if name.startswith(tuple(starts))]

    def named(self, start):
        return [self.by_name[name] for name in self.by_name if name.startswith(start)]

    def get(self, name):
        return self.by_name.get(name)


def methods_of(result):
    return [method["name"] for method in result["specification"]["methods"]]


def runs_of(results, method, **equal):
    """Runs of one method in these results, in order."""
    chosen = []
    for result in results:
        names = methods_of(result)
        if method in names:
            index = names.index(method)
            chosen += [run for run in result["runs"] if run["method"] == index
                       and all(run.get(key) == value for key, value in equal.items())]
    return chosen


def mean(values):
    values = [value for value in values if value is not None and not math.isnan(value)]
    return statistics.fmean(values) if values else NAN


def median(values):
    values = [value for value in values if value is not None]
    return statistics.median(values) if values else NAN


def geometric_mean(values):
    values = [value for value in values if value > 0]
    return math.exp(statistics.fmean(map(math.log, values))) if values else NAN


def wilson(hits, total):
    """The 95 % interval of a share (Wilson 1927)."""
    if total == 0:
        return 0.0, 1.0
    z = 1.96
    share = hits / total
    middle = (share + z * z / (2 * total)) / (1 + z * z / total)
    half = z * math.sqrt(share * (1 - share) / total + z * z / (4 * total * total)) / (1 + z * z / total)
    return max(0.0, middle - half), min(1.0, middle + half)


class Share:
    def __init__(self, hits, total):
        self.hits, self.total = hits, total

    def text(self):
        if self.total == 0:
            return "-"
        low, high = wilson(self.hits, self.total)
        return f"{100 * self.hits / self.total:.1f} ({self.hits}/{self.total}; {100 * low:.0f}-{100 * high:.0f})"

    def value(self):
        return self.hits / self.total if self.total else NAN


def rate(runs):
    """Mean matching rate in per cent; a scene in which nothing was found counts as 0."""
    return 100 * mean([run.get("rate", 0.0) for run in runs])


def successes(runs):
    return Share(sum(run.get("add", 1.0) < MAX_ADD for run in runs), len(runs))


def ratios(runs, base, key):
    """Per scene how many times the base's value, as the geometric mean: both ran in turn on the same scenes."""
    return geometric_mean([run[key] / other[key] for run, other in zip(runs, base) if run[key] > 0 and other[key] > 0])


def kept(run, top):
    return run["detections"][:top]


def scene_rates(runs, top):
    """As in Tables 6 and 7: the mean of the best ones' rates in each scene; nothing found counts as 0."""
    return [100 * mean([d["rate"] for d in kept(run, top)]) if run["detections"] else 0.0 for run in runs]


def is_right(detection):
    return detection["verdict"] in ("right", "hidden")


def right_share(runs, top):
    poses = [d for run in runs for d in kept(run, top)]
    return Share(sum(map(is_right, poses)), len(poses))


def first_right(runs):
    return Share(sum(bool(run["detections"]) and is_right(run["detections"][0]) for run in runs), len(runs))


def graspable_but_wrong(runs, top):
    """Of the poses with a rate that the paper would grasp at, those that are wrong."""
    poses = [d for run in runs for d in kept(run, top) if d["rate"] >= GRASPABLE]
    return Share(sum(not is_right(d) for d in poses), len(poses))


def found_of_listed(runs):
    instances = [instance for run in runs for instance in run["instances"]]
    return Share(sum(instance["found"] for instance in instances), len(instances))


def pose_error(runs, top):
    """Median position (mm) and rotation (degrees) of the right ones."""
    right = [d for run in runs for d in kept(run, top) if is_right(d)]
    return (1e3 * median([d["translation"] for d in right]), math.degrees(median([d["rotation"] for d in right])))
