#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""benchmark/fit_confidence.py on outcomes that are drawn from a known logistic model."""
import json
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import unittest

BENCHMARK = pathlib.Path(__file__).resolve().parents[2] / "benchmark"
sys.path.insert(0, str(BENCHMARK))

from logistic_regression import Model, Sample, expected_error, fit, log_loss, solve  # noqa: E402

TRUTH = Model(-4.0, [6.0, 1.5, 20.0])
NAMES = ["inlier_share", "turn_margin", "violation_share"]
SURE = 4  # standard deviations: a chance of 1 in 16000 for each weight, if the seed were drawn


def draw(generator, count, model=TRUTH):
    samples = []
    for _ in range(count):
        features = [generator.random(), generator.gauss(1, 1), -0.2 * generator.random()]
        samples.append(Sample(features, int(generator.random() < model.probability(features))))
    return samples


def standard_errors(samples):
    """By Fisher's information at the truth."""
    size = 1 + len(TRUTH.weights)
    information = [[0.0] * size for _ in range(size)]
    for sample in samples:
        x = [1.0] + sample.features
        p = TRUTH.probability(sample.features)
        for k in range(size):
            for i in range(size):
                information[k][i] += p * (1 - p) * x[k] * x[i]
    unit = [[float(i == k) for i in range(size)] for k in range(size)]
    return [math.sqrt(solve(information, unit[k])[k]) for k in range(size)]


class LogisticRegression(unittest.TestCase):
    def setUp(self):
        self.generator = random.Random(1)

    def expect_truth(self, constant, weights, samples):
        for found, true, error in zip([constant] + weights, [TRUTH.constant] + TRUTH.weights, standard_errors(samples)):
            self.assertLess(abs(found - true), SURE * error)

    def test_recovers_the_model_that_the_outcomes_were_drawn_from(self):
        samples = draw(self.generator, 4000)
        model = fit(samples)
        self.expect_truth(model.constant, model.weights, samples)

    def test_a_sample_of_weight_two_counts_like_two(self):
        samples = draw(self.generator, 300)
        doubled = fit([Sample(s.features, s.outcome, 1 + k % 2) for k, s in enumerate(samples)])
        repeated = fit(samples + samples[1::2])
        for a, b in zip([doubled.constant] + doubled.weights, [repeated.constant] + repeated.weights):
            self.assertAlmostEqual(a, b, places=6)

    def test_no_weight_is_negative_and_what_says_nothing_has_none(self):
        samples = [Sample([x, -x + 0.5 * self.generator.random(), 7.0], int(x > self.generator.random()))
                   for x in (self.generator.random() for _ in range(500))]
        model = fit(samples)
        self.assertGreater(model.weights[0], 0)
        self.assertEqual(model.weights[1:], [0.0, 0.0])

    def test_separable_outcomes_have_finite_weights(self):
        model = fit([Sample([x / 50], int(x > 25)) for x in range(51)])
        self.assertTrue(1 < model.weights[0] < 1e4)

    def test_measures_of_a_hand_made_list(self):
        samples = [Sample([], 1), Sample([], 0, 3)]
        self.assertAlmostEqual(log_loss(samples, [0.5, 0.5]), math.log(2))
        self.assertAlmostEqual(expected_error(samples, [0.85, 0.25]), (0.15 + 3 * 0.25) / 4)


class FitConfidence(unittest.TestCase):
    """The program, on reports as `bin_picking evaluate` writes them."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_on(self, scenes):
        report = self.folder / "report.json"
        report.write_text(json.dumps({"scenes": scenes}), encoding="utf-8")
        return subprocess.run([str(BENCHMARK / "fit_confidence.py"), str(report), "--origin", "drawn poses", "--write",
                               str(self.folder / "weights.hpp")], capture_output=True, text=True, check=False)

    def test_writes_the_weights_and_tells_how_good_they_are_elsewhere(self):
        generator = random.Random(2)
        scenes, samples = [], []
        for k in range(20):
            drawn = draw(generator, 100)
            samples += drawn
            scenes.append({"name": f"scene_{k}", "tested": [
                {"part": "tube" if k % 2 else "bolt", "score": 0.5, "right": bool(sample.outcome),
                 "terms": dict(zip(NAMES, sample.features))} for sample in drawn]})
        outcome = self.run_on(scenes)
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        text = (self.folder / "weights.hpp").read_text(encoding="utf-8")
        self.assertIn("2000 poses", text)
        self.assertIn("drawn poses", text)
        found = {name: float(value) for name, value in re.findall(r"constexpr double (\w+) = (\S+);", text)}
        self.assertEqual(list(found), ["CONSTANT"] + [name.upper() for name in NAMES])
        for value, true, error in zip(found.values(), [TRUTH.constant] + TRUTH.weights, standard_errors(samples)):
            self.assertLess(abs(value - true), SURE * error)
        losses = {line[:44].strip(): float(line[44:62]) for line in outcome.stdout.splitlines()
                  if re.search(r"(\s+\d\.\d{4}){3}$", line)}
        self.assertAlmostEqual(losses["the scores in the report"], math.log(2), places=4)
        best = log_loss(samples, [TRUTH.probability(sample.features) for sample in samples])
        self.assertLess(losses["fitted, the same poses"], best)
        for elsewhere in ("fitted to the other scenes, 5 folds", "fitted to the other parts"):
            self.assertGreater(losses[elsewhere], losses["fitted, the same poses"])
            self.assertLess(losses[elsewhere], best + 0.01)  # four parameters cost about 4 / (2 * 2000)

    def test_refuses_what_cannot_be_fitted(self):
        outcome = self.run_on([{"name": "one", "tested": [{"part": "tube", "score": 1, "right": True, "terms": {"a": 1}}]}])
        self.assertNotEqual(outcome.returncode, 0)
        self.assertIn("right and wrong", outcome.stderr)
        self.assertFalse((self.folder / "weights.hpp").exists())


if __name__ == "__main__":
    unittest.main()
