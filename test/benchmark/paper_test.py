#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""benchmark/paper.sh: its arithmetic on known outcomes, and a small run on a bin of its own.
Usage: paper_test.py BIN_PICKING BENCHMARK_PAPER"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import types
import unittest

PACKAGE = pathlib.Path(__file__).resolve().parents[2]
BENCHMARK = PACKAGE / "benchmark"
sys.path[:0] = [str(BENCHMARK), str(BENCHMARK / "paper")]

import cells  # noqa: E402
import figures  # noqa: E402
import summary  # noqa: E402
import tables  # noqa: E402

PROGRAM, EXPERIMENT = sys.argv[1:3]


def detection(rate, verdict):
    return {"rate": rate, "verdict": verdict, "translation": 0.001, "rotation": math.pi / 180}


class Published(unittest.TestCase):
    def test_the_averages_follow_from_the_columns(self):
        """Typing errors of ours would show. The averages that the paper prints itself must be off by rounding only."""
        for number, table in tables.PUBLISHED.items():
            if table["columns"][-1] != "Average":
                continue
            for name, row in table["rows"].items():
                self.assertEqual(len(row), len(table["columns"]), f"table {number}, {name}")
                self.assertAlmostEqual(sum(row[:-1]) / (len(row) - 1), row[-1], delta=0.0101, msg=f"{number}, {name}")

    def test_what_stands_in_two_tables_is_the_same(self):
        for a, b in (("1", "3"), ("2", "4")):
            self.assertEqual(tables.published(a, "Cur-PPF (unweighted)"), tables.published(b, "Cur-PPF (unweighted)"))


class Arithmetic(unittest.TestCase):
    def test_the_rate_of_a_bin_is_that_of_its_best_poses_and_an_empty_answer_is_zero(self):
        runs = [{"detections": [detection(1.0, "right"), detection(0.5, "wrong"), detection(0.1, "wrong")]},
                {"detections": []}]
        self.assertEqual(figures.scene_rates(runs, 2), [75.0, 0.0])
        self.assertEqual(figures.right_share(runs, 2).value(), 0.5)
        self.assertEqual(figures.first_right(runs).value(), 0.5)
        self.assertEqual(figures.graspable_but_wrong(runs, 3).total, 1)

    def test_ratios_are_taken_scene_by_scene(self):
        runs, base = [{"ms": 1.0}, {"ms": 200.0}], [{"ms": 2.0}, {"ms": 100.0}]
        self.assertAlmostEqual(figures.ratios(runs, base, "ms"), 1.0)

    def test_intervals_are_those_of_wilson(self):
        low, high = figures.wilson(20, 20)  # docs/evaluation.md: 84 to 100 %
        self.assertAlmostEqual(low, 0.839, places=3)
        self.assertAlmostEqual(high, 1.0)

    def test_nothing_run_is_no_claim(self):
        plan = types.SimpleNamespace(cells=[])
        results = figures.Results(plan, pathlib.Path("nowhere"))
        self.assertEqual({claim.held for claim in summary.claims(results)}, {None})
        self.assertEqual(summary.headline(results), [])


class SmallRun(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        subprocess.run([PROGRAM, "simulate", str(PACKAGE / "config/parts/three_way_tube"), "--count", "2", "--size",
                        "480x384", "-o", str(cls.folder / "set")], check=True, capture_output=True)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def run_paper(self, *arguments):
        return subprocess.run([str(BENCHMARK / "paper" / "run.py"), "--program", PROGRAM, "--experiment", EXPERIMENT,
                               "--package", str(PACKAGE), "-o", str(self.folder / "out"), "--quick", *arguments],
                              check=False, capture_output=True, text=True)

    def test_own_bins_are_reported_and_finished_work_is_kept(self):
        command = ["--dataset", str(self.folder / "set"), "--only", "bins", "-j", "1"]
        first = self.run_paper(*command)
        self.assertEqual(first.returncode, 0, first.stderr)
        result = self.folder / "out" / "cells" / "own_set.json"
        written = result.stat().st_mtime_ns
        outcome = json.loads(result.read_text(encoding="utf-8"))
        names = figures.methods_of(outcome)
        self.assertEqual(len(outcome["runs"]), len(names))
        ppf, cur = (figures.runs_of([outcome], name)[0] for name in ("PPF on the candidates", "Cur-PPF"))
        self.assertEqual(ppf["references"], cur["references"])
        if ppf["votes"] > 0:  # the feature with curvature can only sort out pairs of model and scene
            self.assertLess(cur["votes"], ppf["votes"])
        fast = figures.runs_of([outcome], "our preset fast")[0]
        self.assertTrue(fast["detections"])
        self.assertTrue(all(map(figures.is_right, fast["detections"])))
        page = (self.folder / "out" / "report.html").read_text(encoding="utf-8")
        self.assertIn("Cur-PPF + ICP", page)
        self.assertNotIn("http-equiv", page)
        second = self.run_paper(*command)
        self.assertEqual(second.returncode, 0, second.stderr)
        self.assertIn("kept", second.stderr)
        self.assertEqual(result.stat().st_mtime_ns, written)

    def test_what_is_missing_is_named(self):
        outcome = self.run_paper("--data", str(self.folder), "--only", "laser")
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        self.assertIn("uwa/parasaurolophus_low_normals2.ply", outcome.stderr)
        report = (self.folder / "out" / "report.md").read_text(encoding="utf-8")
        self.assertIn("uwa/parasaurolophus_low_normals2.ply", report)


class Cells(unittest.TestCase):
    def test_the_other_reading_of_the_curvature_has_the_same_numbers(self):
        values = cells.in_inverse_millimetres(PACKAGE / "config/paper/bunny.yaml")
        self.assertEqual(values["d_cur"], "0.07/mm")
        self.assertEqual(values["curvature_measure"], "mean_curvature")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
