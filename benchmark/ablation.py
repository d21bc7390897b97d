#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Runs what benchmark/ablation.txt lists, each between two runs of the default, and reports what each buys."""
import argparse
import json
import os
import pathlib
import re
import resource
import subprocess
import sys
import time

import yaml

import ablation_report
import ablation_table
import machine
from ablation_figures import Figures, compare_shares, compare_times, resamplings, scene_times, unsteadiness


class Runner:
    """Evaluates a data set with other values than the default's."""

    def __init__(self, arguments):
        self.arguments = arguments
        self.folder = pathlib.Path(arguments.output)
        parts = sorted(path.parent for path in pathlib.Path(arguments.dataset, "parts").glob("*/part.yaml"))
        self.parts = [part for part in parts if not arguments.parts or part.name in arguments.parts]
        self.leaves = {}
        self.others_busy = 0
        if not self.parts:
            raise ablation_table.TableError(f"{arguments.dataset} has no parts/NAME/part.yaml of the wanted parts; give"
                                            " a set that benchmark/regression.sh or `bin_picking simulate` has made.")

    def evaluate(self, variant=None):
        report = self.folder / "run.json"
        command = [self.arguments.program, "evaluate", "--dataset", self.arguments.dataset, "--json", str(report),
                   "--cache", self.arguments.models, "--preset", self.arguments.preset,
                   "--threads", str(self.arguments.threads), "--repeat", str(self.arguments.repeat)]
        if self.arguments.max_scenes:
            command += ["--max-scenes", str(self.arguments.max_scenes)]
        detector = [f"{key[len('detector/'):]}={value}" for key, value in (variant.values if variant else {}).items()
                    if key.startswith("detector/")]
        command += ["--set", *detector] if detector else []
        self.run(command + ["--parts", *self.part_folders(variant)])
        return json.loads(report.read_text(encoding="utf-8"))

    def run(self, command):
        """Also notes how busy others kept the machine."""
        begin, busy, own = time.monotonic(), machine.busy_seconds_now(), children_seconds()
        output = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        seconds = time.monotonic() - begin
        others = machine.busy_seconds_now() - busy - (children_seconds() - own)
        if seconds > 1:  # the clocks count in hundredths
            self.others_busy = max(self.others_busy, others / seconds)
        return output

    def part_folders(self, variant):
        """Copies of the parts that state the variant's training values; the parts themselves where it has none."""
        training = {key[len("training/"):]: value for key, value in (variant.values if variant else {}).items()
                    if key.startswith("training/")}
        if not training and (not variant or variant.leaf_factor == 1):
            return [str(part) for part in self.parts]
        return [str(self.copy_part(part, training, variant.leaf_factor)) for part in self.parts]

    def copy_part(self, part, training, leaf_factor):
        folder = self.folder / "parts" / part.name
        folder.mkdir(parents=True, exist_ok=True)
        description = yaml.safe_load((part / "part.yaml").read_text(encoding="utf-8"))
        description.setdefault("training", {}).update({key: yaml.safe_load(text) for key, text in training.items()})
        if leaf_factor != 1:
            description["training"]["leaf"] = round(leaf_factor * self.leaf(part), 7)
        (folder / "part.yaml").write_text(yaml.safe_dump(description), encoding="utf-8")
        for file in part.iterdir():
            if file.name != "part.yaml" and not (folder / file.name).exists():
                (folder / file.name).symlink_to(file.resolve())
        return folder

    def leaf(self, part):
        """Metres: what training derives from the part."""
        if part.name not in self.leaves:
            text = self.run([self.arguments.program, "train", str(part), "-o", str(self.folder / "leaf.model")])
            self.leaves[part.name] = float(re.search(r"^\s+leaf\s+([\d.]+) mm$", text, re.MULTILINE)[1]) / 1000
        return self.leaves[part.name]


def children_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def run_all(runner, variants):
    """The default's figures, a row for every variant, those that could not be run, and how unsteady the times were."""
    report = runner.evaluate()  # trains the models: its times count nevertheless, training is not in them
    default = Figures(report)
    draws = resamplings(len(report["scenes"]))
    before = default.times
    rows, failures, unsteady = [], [], 1
    for number, variant in enumerate(variants, 1):
        print(f"ablation: {number} of {len(variants)}: {variant.title()}", file=sys.stderr)
        try:
            figures = Figures(runner.evaluate(variant))
        except subprocess.CalledProcessError as problem:
            failures.append((variant, problem.stderr.strip().splitlines()[-1] if problem.stderr else str(problem)))
            continue
        after = scene_times(runner.evaluate())
        rows.append({"variant": variant, "figures": figures,
                     "differences": compare_shares(default, figures, draws),
                     "time": compare_times(before, after, figures, draws)})
        unsteady = max(unsteady, unsteadiness(before, after, default))
        before = after
    return default, rows, failures, unsteady


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dataset", nargs="?", metavar="SET_DIR", help="as benchmark/regression.sh makes it")
    parser.add_argument("--program", required=True, help="bin_picking")
    parser.add_argument("--models", default="", metavar="DIR", help="where trained models are kept")
    parser.add_argument("--output", default="", metavar="DIR", help="where the report goes")
    parser.add_argument("--version", default="", help="of the sources")
    parser.add_argument("--table", default=str(pathlib.Path(__file__).with_name("ablation.txt")), metavar="FILE")
    parser.add_argument("--preset", default="fast", help="that is the default (default: fast)")
    parser.add_argument("--only", default="", metavar="REGEX", help="only lines of the table that contain this")
    parser.add_argument("--parts", nargs="+", metavar="NAME", help="only these parts of the set")
    parser.add_argument("--max-scenes", type=int, default=0, metavar="N", help="only the first so many scenes")
    parser.add_argument("--threads", type=int, default=1, metavar="N", help="of the detector (default: 1)")
    parser.add_argument("--repeat", type=int, default=1, metavar="N", help="timed runs per scene (default: 1)")
    parser.add_argument("--check", action="store_true", help="only check the table against the parameters")
    return parser.parse_args()


def main():
    arguments = parse_arguments()
    defaults = ablation_table.read_defaults(arguments.program, arguments.preset)
    variants = ablation_table.read_table(arguments.table, defaults)
    if arguments.check:
        print(f"{len(variants)} lines of {arguments.table} differ from the default; every key exists")
        return
    variants = [variant for variant in variants if re.search(arguments.only, variant.title())]
    load = machine.load_average()
    runner = Runner(arguments)
    default, rows, failures, unsteady = run_all(runner, variants)
    about = {"set": arguments.dataset, "scenes": len(default.counts), "preset": arguments.preset,
             "threads": arguments.threads, "version": arguments.version, "processor": machine.processor_name(),
             "load_before": load, "others_busy": runner.others_busy, "unsteady": unsteady}
    ablation_report.print_report(default, rows, failures, about)
    with open(os.path.join(arguments.output, "report.json"), "w", encoding="utf-8") as file:
        json.dump(ablation_report.to_json(default, rows, failures, about), file, indent=1)


if __name__ == "__main__":
    try:
        main()
    except ablation_table.TableError as problem:
        sys.exit(f"ablation: {problem}")
    except subprocess.CalledProcessError as problem:
        sys.exit(f"ablation: {problem.stderr or problem}")
    except OSError as problem:
        sys.exit(f"ablation: {problem}")
