#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Makes the report of benchmark/bins.sh: Markdown to the standard output, every figure to a JSON file.

A RUN is the path WIDTHxHEIGHT_THREADS of four files: .json (written by `bin_picking evaluate`), .time (real, user and
system seconds), .before and .after (the first line of /proc/stat).
"""
import argparse
import json
import os
import statistics
import sys

import machine

ALL = "all"


def percentile(values, share):
    """With linear interpolation, as `bin_picking evaluate` does it."""
    values = sorted(values)
    position = share * (len(values) - 1)
    low = int(position)
    high = min(low + 1, len(values) - 1)
    return values[low] + (position - low) * (values[high] - values[low])


def spread(values):
    return {"median_ms": statistics.median(values), "p95_ms": percentile(values, 0.95), "runs": len(values)}


def stage_times(scenes):
    """Median and 95th percentile over all runs in these scenes, in the order of the pipeline; the total last."""
    times = {}
    for scene in scenes:
        for stage in scene["stages"]:
            times.setdefault(stage["stage"], []).extend(stage["ms"])
    times["total"] = [ms for scene in scenes for ms in scene["total_ms"]]
    return {stage: spread(values) for stage, values in times.items()}


def quality(figures):
    found = {f"found{100 * recall['visible_fraction']:.0f}": recall["value"] for recall in figures["recall"]}
    return {**found, "right": figures["precision"]["value"], "average_precision": figures["average_precision"]}


def read_line(path):
    with open(path, encoding="utf-8") as file:
        return file.readline()


def read_run(path):
    with open(path + ".json", encoding="utf-8") as file:
        report = json.load(file)
    size, threads = os.path.basename(path).split("_")
    width, height = (int(number) for number in size.split("x"))
    real, user, system = (float(number) for number in read_line(path + ".time").split())
    busy = machine.busy_seconds(read_line(path + ".after")) - machine.busy_seconds(read_line(path + ".before"))
    run = {"width": width, "height": height, "threads": int(threads), "preset": report["preset"],
           "others_busy": max(0, busy - user - system) / real, "parts": {}}
    for part, figures in report["parts"].items():
        scenes = [scene for scene in report["scenes"] if part in scene["parts"]]
        run["parts"][part] = {"quality": quality(figures), "stages": stage_times(scenes)}
    run["parts"][ALL] = {"quality": quality(report["all"]), "stages": stage_times(report["scenes"])}
    return run


def megapixels(run):
    return run["width"] * run["height"] / 1e6


def total(run, part):
    return run["parts"][part]["stages"]["total"]["median_ms"]


def growth(runs, threads):
    """(title, run, run of the next smaller picture) of every size but the smallest."""
    of_threads = sorted((run for run in runs if run["threads"] == threads), key=megapixels)
    return [(f"{megapixels(larger):.1f} : {megapixels(smaller):.1f} Mpx", larger, smaller)
            for smaller, larger in zip(of_threads, of_threads[1:])]


def print_table(titles, rows):
    print("| " + " | ".join(titles) + " |\n|---|" + "---:|" * (len(titles) - 1))
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print()


def print_totals(runs, parts):
    print("## Total: median (95th percentile), ms\n")
    titles = ["part"] + [f"{megapixels(run):.1f} Mpx, {run['threads']} thread{'s' * (run['threads'] > 1)}"
                         for run in runs]
    print_table(titles, [[part] + [cell(run, part, "total") for run in runs] for part in parts])


def print_growth(runs, parts):
    pairs = [(threads, pair) for threads in sorted({run["threads"] for run in runs}) for pair in growth(runs, threads)]
    if not pairs:
        return
    print("## Growth of the median total with the picture\n")
    titles = ["part"] + [f"{pair[0]}, {threads} thread{'s' * (threads > 1)}" for threads, pair in pairs]
    print_table(titles, [[part] + [f"{total(larger, part) / total(smaller, part):.2f}"
                                   for _, (_, larger, smaller) in pairs] for part in parts])


def print_quality(runs, parts):
    print("## What was found in that time\n")
    of_sizes = list({megapixels(run): run for run in reversed(runs)}.values())[::-1]  # the first of each size
    keys = list(of_sizes[0]["parts"][ALL]["quality"])
    words = {"right": "right", "average_precision": "AP"}
    titles = ["part"] + [f"{megapixels(run):.1f} Mpx: {words.get(key, key.replace('found', 'found, vis. ') + ' %')}"
                         for run in of_sizes for key in keys]
    print_table(titles, [[part] + [percent(run["parts"][part]["quality"][key]) for run in of_sizes for key in keys]
                         for part in parts])
    for run in runs:
        same = next(other for other in of_sizes if megapixels(other) == megapixels(run))
        if any(run["parts"][part]["quality"] != same["parts"][part]["quality"] for part in parts):
            print(f"**{megapixels(run):.1f} Mpx: {run['threads']} and {same['threads']} threads found different"
                  " things; the result must not depend on them.**\n")


def percent(value):
    return "-" if value is None else f"{100 * value:.1f} %"


def cell(run, part, stage):
    times = run["parts"][part]["stages"].get(stage)
    return f"{times['median_ms']:.2f} ({times['p95_ms']:.2f})" if times else "-"


def print_stages(run, parts):
    print(f"## Stages at {run['width']}x{run['height']}, {run['threads']} thread{'s' * (run['threads'] > 1)}:"
          " median (95th percentile), ms\n")
    stages = run["parts"][ALL]["stages"]
    print_table(["stage"] + parts, [[stage] + [cell(run, part, stage) for part in parts] for stage in stages])


def print_report(report):
    runs = report["runs"]
    parts = list(runs[0]["parts"])
    print("# Detection in full bins: cloud in memory to ranked, verified detections\n")
    warning = machine.busy_warning(report["load_before"], max(run["others_busy"] for run in runs))
    if warning:
        print(warning)
    timed = runs[0]["parts"][parts[0]]["stages"]["total"]["runs"]
    print(f"{report['processor']}, {report['processors']} processors; load average before the first run"
          f" {report['load_before']:.2f}; others kept {max(run['others_busy'] for run in runs):.2f} processors busy"
          f" during the busiest run. Version {report['version']}, preset {runs[0]['preset']}"
          f"{', options ' + report['options'] if report['options'] else ''}; {timed} timed runs a part and column.\n")
    print_totals(runs, parts)
    print_growth(runs, parts)
    print_quality(runs, parts)
    for run in runs:
        print_stages(run, parts)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("runs", nargs="+", metavar="RUN", help="path of the run's files without their endings")
    parser.add_argument("--version", required=True, help="of the sources")
    parser.add_argument("--options", default="", help="that bin_picking evaluate was given")
    parser.add_argument("--load", required=True, metavar="FILE", help="/proc/loadavg before the first run")
    parser.add_argument("--json", required=True, metavar="FILE", help="where every figure is written to")
    arguments = parser.parse_args()
    report = {"format": 1, "processor": machine.processor_name(), "processors": os.cpu_count(),
              "load_before": float(read_line(arguments.load).split()[0]), "version": arguments.version,
              "options": arguments.options, "runs": [read_run(path) for path in arguments.runs]}
    with open(arguments.json, "w", encoding="utf-8") as file:
        json.dump(report, file, indent=1)
    print_report(report)


if __name__ == "__main__":
    try:
        main()
    except (OSError, ValueError, KeyError) as problem:
        sys.exit(f"bins_report: {problem!r}")
