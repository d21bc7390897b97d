#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""benchmark/paper.sh: its arithmetic on known outcomes, and a small run on a bin of its own.
Usage: paper_test.py BIN_PICKING BENCHMARK_PAPER"""
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import types
import unittest

PACKAGE = pathlib.Path(__file__).resolve().parents[2]
BENCHMARK = PACKAGE / "benchmark"
sys.path[:0] = [str(BENCHMARK), str(BENCHMARK / "paper"), str(PACKAGE / "test" / "benchmark")]

import bop_folder  # noqa: E402
import cells  # noqa: E402
import figures  # noqa: E402
import gains  # noqa: E402
import picking  # noqa: E402
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

    def test_equal_rates_are_no_gain_and_no_loss(self):
        self.assertEqual([summary.raises(90.0, after) for after in (95.0, 90.5, 85.0, math.nan)],
                         [True, "no difference seen", False, None])

    def test_a_share_is_told_as_a_factor_in_its_direction(self):
        self.assertEqual([gains.factor(share) for share in (0.5, 2.0, math.nan)], ["2.0x less", "2.0x more", "-"])

    def test_more_is_right_only_if_the_intervals_do_not_meet(self):
        self.assertEqual(gains.compared(figures.Share(100, 100), figures.Share(50, 100)), "more")
        self.assertEqual(gains.compared(figures.Share(2, 2), figures.Share(1, 2)), "no difference seen")
        self.assertIsNone(summary.better(figures.Share(0, 0), figures.Share(1, 2)))

    def test_nothing_run_is_no_claim(self):
        plan = types.SimpleNamespace(cells=[])
        results = figures.Results(plan, pathlib.Path("nowhere"))
        self.assertEqual({claim.held for claim in summary.claims(results)}, {None})
        self.assertEqual(gains.headline(results), [])
        self.assertEqual(gains.table(results).rows, [])


def attempt(outcome, cause, called_free=False):
    """As benchmark/picking/json_report.cpp writes it; no number where nothing was meant."""
    return {"cloud": 1, "part": "three_way_tube", "grasp": "wall", "tilt": 0.1, "clearance": 0.004,
            "matching_rate": 0.97, "score": 0.9, "center_error": None, "rotation_error": None, "outcome": outcome,
            "cause": cause, "id": 3, "final_opening": 0.03, "offset": 0.001, "body": "",
            "obstacle": "", "depth": 0.0, "called_free": called_free, "what": "the part is held"}


def emptied(seed, attempts, shakes=1, left=0):
    return {"seed": seed, "filled": sum(a["outcome"] == "taken" for a in attempts) + left, "shakes": shakes,
            "left": {"not_detected": left} if left else {}, "attempts": attempts,
            "seconds": {"detection": [0.1], "grasps": [0.02], "judge": [0.01]}}


def picking_report(bins, part="three_way_tube", seeds="1..2", options=(), truth=False, version="v1"):
    return {"version": version,
            "command": ["benchmark_picking", f"config/parts/{part}", "--gripper", "config/grippers/ag95.yaml",
                        "--seeds", seeds, "--json", "picks.json", *options],
            "sensor": "structured_light", "gripper": "ag95", "truth": truth, "parts": [{"name": part, "bins": bins}]}


TAKEN = attempt("taken", "taken")
HIT = attempt("collision", "approach: gripper against part", True)
MISSED = attempt("missed", "missed")


class Picking(unittest.TestCase):
    """Table 8."""

    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)

    def file(self, report, name="picks.json"):
        path = pathlib.Path(self.temporary.name) / name
        path.write_text(report if isinstance(report, str) else json.dumps(report), encoding="utf-8")
        return str(path)

    def table(self, *files):
        return picking.table(picking.read(files), files, str(PACKAGE))

    def assert_wrong(self, words, *reports):
        files = [self.file(report, f"{k}.json") for k, report in enumerate(reports)]
        with self.assertRaises(ValueError) as caught:
            picking.read(files)
        self.assertIn(words, str(caught.exception))
        return str(caught.exception)

    def test_picks_failures_by_cause_shakes_and_collisions_called_free_are_counted(self):
        table = self.table(self.file(picking_report([emptied(1, [TAKEN, HIT, TAKEN], shakes=2),
                                                     emptied(2, [MISSED, HIT, TAKEN], shakes=3, left=4)],
                                                    options=["--models", "/some/where"])))
        paper, ours = (dict(zip(table.columns, row)) for row in table.rows)
        self.assertEqual((paper["picks"], paper["successes"]), ("100", "95"))
        self.assertEqual((ours["bins"], ours["picks"], ours["successes"], ours["failures"]), ("2", "6", "3", "3"))
        self.assertEqual(ours["success, % (95 % interval)"], figures.Share(3, 6).text())
        self.assertEqual(ours["failures by cause"], "2 x approach: gripper against part; 1 x missed")
        self.assertEqual((ours["collisions called free"], ours["shakes"], ours["parts left"]), ("2", "5", "4"))
        self.assertTrue(any(note.startswith("`benchmark_picking config/parts/three_way_tube") for note in table.notes))
        self.assertNotIn("/some/where", " ".join(table.notes))

    def test_files_of_other_seeds_are_one_row_and_other_parts_or_settings_are_not(self):
        files = [self.file(picking_report([emptied(1, [TAKEN])], seeds="1"), "a.json"),
                 self.file(picking_report([emptied(2, [TAKEN])], seeds="2"), "b.json"),
                 self.file(picking_report([emptied(1, [MISSED])], "hex_bolt"), "c.json"),
                 self.file(picking_report([emptied(1, [HIT])], options=["--preset", "paper"]), "d.json"),
                 self.file(picking_report([emptied(1, [HIT])], options=["--truth"], truth=True), "e.json"),
                 self.file(picking_report([emptied(1, [HIT])], version="v2"), "f.json")]
        rows = picking.read(files)
        self.assertEqual([(row.part, len(row.attempts())) for row in rows],
                         [("three_way_tube", 2), ("three_way_tube", 1), ("three_way_tube", 1), ("three_way_tube", 1),
                          ("hex_bolt", 1)])
        self.assertEqual(picking.of_the_paper(rows)[0].total, 4)

    def test_a_bin_given_twice_is_refused(self):
        report = picking_report([emptied(1, [TAKEN])])
        self.assert_wrong("would count twice", report, report)

    def test_a_wrong_file_is_told_with_what_is_missing_and_the_cure(self):
        cure = "--gripper FILE.yaml --json FILE"
        self.assertIn(cure, self.assert_wrong("no 'command'", {"attempts": 100, "successes": 95}))
        self.assertIn(cure, self.assert_wrong("is not JSON", "# Picking in the virtual cell"))
        without = picking_report([emptied(1, [TAKEN])])
        del without["parts"][0]["bins"][0]["shakes"]
        self.assertIn(cure, self.assert_wrong("no 'shakes' in parts[0].bins[0]", without))
        self.assert_wrong("parts[0].bins[0].attempts[0] of", picking_report([emptied(1, [attempt("dropped", "?")])]))
        with self.assertRaisesRegex(ValueError, "cannot be read"):
            picking.read(["/nowhere/picks.json"])

    def test_the_keys_are_those_that_the_benchmark_writes(self):
        writer = (BENCHMARK / "picking/json_report.cpp").read_text(encoding="utf-8")
        written = set(re.findall(r'\{"(\w+)",', writer))
        report = picking_report([emptied(1, [TAKEN])])
        part = report["parts"][0]
        for node in (report, part, part["bins"][0], part["bins"][0]["attempts"][0], part["bins"][0]["seconds"]):
            self.assertEqual(set(node) - written, set())
        self.assertEqual(written - set(report) - set(part) - set(part["bins"][0]) - set(TAKEN) -
                         set(part["bins"][0]["seconds"]), set())
        words = (PACKAGE / "src/simulation/grip_trial_parameters.cpp").read_text(encoding="utf-8")
        text = words[words.index("toString(GripVerdict::Outcome"):words.index("toString(GripStage")]
        outcomes = set(re.findall(r'return "(\w+)"', text)) - {"unknown"} | set(re.findall(r'\? "(\w+)"', writer))
        self.assertEqual(outcomes, set(picking.OUTCOMES))

    def test_the_claim_is_held_against_the_interval(self):
        plan = types.SimpleNamespace(cells=[])

        def verdict(hits, misses):
            rows = picking.read([self.file(picking_report([emptied(1, [TAKEN] * hits + [MISSED] * misses)]))])
            return summary.picking_claims(figures.Results(plan, pathlib.Path("nowhere"), rows))[0].held
        self.assertEqual(verdict(400, 0), True)
        self.assertEqual(verdict(10, 0), "cannot be told")
        self.assertEqual(verdict(50, 50), False)


STUB = """#!/usr/bin/env python3
import json, pathlib, sys
specification = json.loads(pathlib.Path(sys.argv[1]).read_text())
pose = {"rate": 0.97, "verdict": "right", "translation": 0.001, "rotation": 0.01}
runs = [{"method": m, "scene": "one", "ms": 10.0, "votes": 100.0, "pairs": 10, "detections": [pose], "instances": []}
        for m in range(len(specification["methods"]))]
result = {"models": [], "runs": runs, "scenes": 1, "specification": specification}
pathlib.Path(sys.argv[2]).write_text(json.dumps(result))
"""


class Mixing(unittest.TestCase):
    """Results of other code, data or options are made anew or left out, with a stand-in for the program."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.out = self.folder / "out"
        self.experiment = self.folder / "experiment"
        self.experiment.write_text(STUB, encoding="utf-8")
        self.experiment.chmod(0o755)
        for scene in ("one", "two"):
            (self.folder / "set" / scene).mkdir(parents=True)
            (self.folder / "set" / scene / "scene.pcd").write_text(scene, encoding="utf-8")
        self.config = self.folder / "constants.yaml"
        shutil.copy(PACKAGE / "config/paper/three_way_tube.yaml", self.config)

    def run_paper(self, *arguments, code="first"):
        outcome = subprocess.run(
            [sys.executable, str(BENCHMARK / "paper" / "run.py"), "--program", "none", "--experiment",
             str(self.experiment), "--package", str(PACKAGE), "-o", str(self.out), "--dataset",
             str(self.folder / "set"), "--config", str(self.config), "-j", "1", "--code", code, "--version",
             f"version-{code}", *arguments],
            check=False, capture_output=True, text=True)
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        return outcome.stderr, (self.out / "report.md").read_text(encoding="utf-8")

    def test_what_is_finished_is_kept(self):
        self.run_paper()
        said, _ = self.run_paper()
        self.assertEqual(said.count(": kept"), 2)

    def test_every_table_names_command_version_machine_and_load(self):
        _, page = self.run_paper()
        for line in ("benchmark/paper.sh --dataset DIR", "version version-first", "load before it"):
            self.assertEqual(page.count(line) >= 3, True, line)

    def test_other_code_runs_all_again(self):
        self.run_paper()
        said, page = self.run_paper(code="second")
        self.assertNotIn(": kept", said)
        self.assertNotIn("version-first", page)

    def test_other_constants_or_clouds_run_again_what_they_concern(self):
        self.run_paper()
        (self.folder / "set/one/scene.pcd").write_text("another cloud", encoding="utf-8")
        said, _ = self.run_paper()
        self.assertEqual(said.count(": kept"), 1)
        with self.config.open("a", encoding="utf-8") as file:
            file.write("# another file\n")
        said, _ = self.run_paper()
        self.assertEqual(said.count(": kept"), 0)

    def test_a_report_of_what_is_there_leaves_out_other_code_and_says_so(self):
        self.run_paper()
        self.run_paper("--cells", "own_one", code="second")
        _, page = self.run_paper("--report-only", code="second")
        self.assertIn("1 results in this folder are left out", page)
        self.assertIn("own_two", page)
        self.assertNotIn("version-first", page)

    def test_a_report_only_of_unknown_code_shows_one_code(self):
        self.run_paper()
        _, page = self.run_paper("--report-only", code="third")
        self.assertIn("version-first", page)
        self.assertNotIn("left out", page)

    def test_a_result_without_its_stamp_is_not_finished(self):
        self.run_paper()
        (self.out / "cells/own_one.done").unlink()
        _, page = self.run_paper("--report-only")
        self.assertIn("own_one", page[page.index("left out"):])
        said, _ = self.run_paper()
        self.assertEqual(said.count(": kept"), 1)


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

    def test_a_data_set_of_the_bop_benchmark_takes_the_place_of_ours(self):
        half_turn = [-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
        bop = bop_folder.write(self.folder / "set", "three_way_tube", self.folder / "bop", half_turn)
        done = self.run_paper("--dataset", str(bop), "--split", "val", "--only", "bins", "-j", "1")
        self.assertEqual(done.returncode, 0, done.stderr)
        outcome = json.loads((self.folder / "out" / "cells" / "own_bop.json").read_text(encoding="utf-8"))
        fast = figures.runs_of([outcome], "our preset fast")[0]
        self.assertTrue(fast["detections"])
        self.assertTrue(all(map(figures.is_right, fast["detections"])))
        self.assertEqual({detection["part"] for detection in fast["detections"]}, {"obj_000001"})
        self.assertIn("bop", (self.folder / "out" / "report.md").read_text(encoding="utf-8"))

    def test_what_is_missing_is_named(self):
        outcome = self.run_paper("--data", str(self.folder), "--only", "laser")
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        self.assertIn("uwa/parasaurolophus_low_normals2.ply", outcome.stderr)
        report = (self.folder / "out" / "report.md").read_text(encoding="utf-8")
        self.assertIn("uwa/parasaurolophus_low_normals2.ply", report)
        self.assertIn("bins was not asked for (--only laser)", report)


class Cells(unittest.TestCase):
    def test_the_other_reading_of_the_curvature_has_the_same_numbers(self):
        values = cells.in_inverse_millimetres(PACKAGE / "config/paper/bunny.yaml")
        self.assertEqual(values["d_cur"], "0.07/mm")
        self.assertEqual(values["curvature_measure"], "mean_curvature")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
