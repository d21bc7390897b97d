#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Fits the weights of confidence() to the tested poses in a report of `bin_picking evaluate --json`, and says how good the
probabilities are: of the poses it was fitted to, of scenes and of parts that it was not fitted to."""
import argparse
import collections
import json
import pathlib
import sys

from logistic_regression import Sample, brier_score, expected_error, fit, log_loss

FOLDS = 5
FIGURES = (("log loss", log_loss), ("Brier score", brier_score), ("calibration error", expected_error))


class Pose:
    """A tested pose: which scene and part it is of, and what its score is fitted to."""

    def __init__(self, scene, tested):
        self.scene = scene
        self.part = tested["part"]
        self.score = tested["score"]
        self.sample = Sample(list(tested["terms"].values()), int(tested["right"]))


def read_poses(path):
    """All tested poses, parts weighted alike whatever the number of their poses, and the names of the terms."""
    with open(path, encoding="utf-8") as file:
        report = json.load(file)
    names, poses = [], []
    for number, scene in enumerate(report["scenes"]):
        for tested in scene.get("tested", []):
            names = list(tested["terms"])
            # Sets that are linked into one folder may have scenes of the same name.
            poses.append(Pose((scene["name"], number), tested))
    if len({pose.sample.outcome for pose in poses}) < 2:
        sys.exit(f"fit_confidence: {path} must list right and wrong poses that were tested, but has {len(poses)} of one"
                 " kind; evaluate more scenes, with verification on and --set max_rejected=1000")
    count = collections.Counter(pose.part for pose in poses)
    for pose in poses:
        pose.sample.weight = len(poses) / len(count) / count[pose.part]
    return names, poses


def held_out(poses, group_of):
    """The probability of each pose by a fit to the poses of all other groups."""
    probabilities = [0.0] * len(poses)
    for group in sorted({group_of(pose) for pose in poses}):
        model = fit([pose.sample for pose in poses if group_of(pose) != group])
        for k, pose in enumerate(poses):
            if group_of(pose) == group:
                probabilities[k] = model.probability(pose.sample.features)
    return probabilities


def scene_folds(poses):
    """Each fold has every so-many-th scene in order of their names, so that the scenes of a part are spread over all."""
    scenes = {scene: k % FOLDS for k, scene in enumerate(sorted({pose.scene for pose in poses}))}
    return lambda pose: scenes[pose.scene]


def print_figures(title, poses, probabilities):
    samples = [pose.sample for pose in poses]
    print(f"{title:<44}" + "".join(f"{measure(samples, probabilities):18.4f}" for _, measure in FIGURES))


def print_report(names, poses, model):
    samples = [pose.sample for pose in poses]
    parts = sorted({pose.part for pose in poses})
    scenes = {pose.scene for pose in poses}
    right = sum(sample.outcome for sample in samples)
    print(f"{len(poses)} tested poses of {len(parts)} part(s) in {len(scenes)} scenes, {right} right;"
          " parts count alike\n")
    print(" " * 44 + "".join(f"{name:>18}" for name, _ in FIGURES))
    print_figures("the scores in the report", poses, [pose.score for pose in poses])
    print_figures("fitted, the same poses", poses, [model.probability(sample.features) for sample in samples])
    print_figures(f"fitted to the other scenes, {FOLDS} folds", poses, held_out(poses, scene_folds(poses)))
    if len(parts) > 1:
        probabilities = held_out(poses, lambda pose: pose.part)
        print_figures("fitted to the other parts", poses, probabilities)
        for part in parts:
            chosen = [k for k, pose in enumerate(poses) if pose.part == part]
            print_figures(f"  {part}", [poses[k] for k in chosen], [probabilities[k] for k in chosen])
    unused = [name for name, weight in zip(names, model.weights) if weight == 0]
    if unused:
        print(f"\nweight 0, because more of it would speak against a pose, or it is always the same: {', '.join(unused)}")


def weights_text(names, poses, model, dataset):
    """src/core/refinement/confidence_weights.hpp"""
    right = sum(pose.sample.outcome for pose in poses)
    lines = ["// SPDX-License-Identifier: BSD-3-Clause",
             "// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors",
             "#pragma once", "",
             "// Written by benchmark/fit_confidence.sh --write, fitted to",
             f"// {len(poses)} poses, {right} of them right, of {len({pose.part for pose in poses})} part(s)"
             f" in {len({pose.scene for pose in poses})} scenes of",
             f"// {dataset}.",
             "namespace bin_picking::confidence_weights", "{",
             f"constexpr double CONSTANT = {model.constant:.5g};"]
    lines += [f"constexpr double {name.upper()} = {weight:.5g};" for name, weight in zip(names, model.weights)]
    return "\n".join(lines + ["}  // namespace bin_picking::confidence_weights", ""])


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("report", help="of `bin_picking evaluate --json`, with --set max_rejected=1000")
    parser.add_argument("--origin", metavar="TEXT", default="a data set", help="what the scenes are, for the header")
    parser.add_argument("--write", metavar="FILE", help="write the weights here")
    return parser.parse_args()


def main():
    arguments = parse_arguments()
    names, poses = read_poses(arguments.report)
    model = fit([pose.sample for pose in poses])
    print_report(names, poses, model)
    text = weights_text(names, poses, model, arguments.origin)
    print("\n" + text, end="")
    if arguments.write:
        pathlib.Path(arguments.write).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
