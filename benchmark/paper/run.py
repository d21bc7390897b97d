#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Runs the experiments of Cui et al. 2022 again and reports each beside the paper's own figures. benchmark/paper.sh
calls this; what is finished stays in OUT/cells and is not run again."""
import argparse
import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))

import cells  # noqa: E402
import machine  # noqa: E402
import picking  # noqa: E402
import report  # noqa: E402
import stamps  # noqa: E402

TABLES = ("retrieval", "laser", "bins", "real", "ablations")


class Runner:
    """Runs cells, some at once; what is said on the terminal is said here."""

    def __init__(self, options, out):
        self.options = options
        self.out = out
        self.lock = threading.Lock()
        self.simulating = {}  # folder: lock
        self.finished = 0
        self.begin = time.monotonic()
        self.about = {"code": options.code, "version": options.version, "processor": machine.processor_name(),
                      "processors": os.cpu_count(), "jobs": options.jobs, "load": machine.load_average(),
                      "others_busy": None}
        self.made = {}  # name of a cell that this run has finished: its stamp

    def simulated(self, simulate):
        """A virtual bin, made once for this code; cells that need the same one wait for it."""
        part, count, seed, values = simulate
        key = "_".join([pathlib.Path(part).name, str(count), str(seed), *values]).replace("/", "-")
        folder = self.out / "bins" / key
        stamp = folder.with_name(f"{key}.done")
        origin = f"{stamps.content(part)} {self.options.code}"
        with self.lock:
            lock = self.simulating.setdefault(key, threading.Lock())
        with lock:
            if not (stamp.exists() and stamp.read_text(encoding="utf-8") == origin):
                if stamp.exists():
                    stamp.unlink()
                shutil.rmtree(folder, ignore_errors=True)
                folder.parent.mkdir(parents=True, exist_ok=True)
                command = [self.options.program, "simulate", part, "--count", str(count), "--seed", str(seed),
                           "--threads", "1", "-o", str(folder)]
                execute(command + (["--set", *values] if values else []))
                stamp.write_text(origin, encoding="utf-8")
        return str(folder)

    def run(self, cell, total):
        result = self.out / "cells" / f"{cell.name}.json"
        begin = time.monotonic()
        note = "kept"
        digest = stamps.digest(cell)
        stamp = stamps.read(self.out, cell.name)
        if not result.exists() or stamp.get("specification") != digest or stamp.get("code") != self.options.code:
            if stamp:  # or the old stamp would stand beside a new result, were this run broken off
                stamps.file_of(self.out, cell.name).unlink()
            specification = dict(cell.specification)
            if "simulate" in specification:
                specification["dataset"] = self.simulated(specification.pop("simulate"))
            file = result.with_suffix(".specification")
            file.write_text(json.dumps(specification, indent=1), encoding="utf-8")
            execute([self.options.experiment, str(file), str(result)])
            stamp = {**self.about, "specification": digest, "finished": time.time()}
            stamps.write(self.out, cell.name, stamp)
            note = f"{time.monotonic() - begin:.0f} s"
            with self.lock:
                self.made[cell.name] = stamp
        with self.lock:
            self.finished += 1
            print(f"paper: {self.finished} of {total}: {cell.title}: {note}"
                  f" ({(time.monotonic() - self.begin) / 60:.1f} min)", file=sys.stderr, flush=True)

    def note_others(self, seconds):
        """How many processors others kept busy is known only at the end."""
        for name, stamp in self.made.items():
            stamps.write(self.out, name, {**stamp, "others_busy": seconds})

    def run_all(self, plan):
        """Names of the cells that failed, with the reason."""
        failures = {}
        with concurrent.futures.ThreadPoolExecutor(self.options.jobs) as pool:
            chosen = [cell for cell in plan.cells if re.search(self.options.cells, cell.name)]
            futures = {pool.submit(self.run, cell, len(chosen)): cell for cell in chosen}
            for future in concurrent.futures.as_completed(futures):
                if problem := future.exception():
                    failures[futures[future].name] = str(problem)
                    print(f"paper: {futures[future].title}: {problem}", file=sys.stderr, flush=True)
        return failures


def execute(command):
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        words = (done.stderr or done.stdout).strip().splitlines()
        raise OSError(words[-1] if words else f"{command[0]} ended with {done.returncode}")


def parse():
    parser = argparse.ArgumentParser(prog="benchmark/paper.sh", description=__doc__)
    parser.add_argument("--data", default="", metavar="DIR", help="holds stanford/, uwa/ and pipes/; tables whose data"
                        " are not there are left out, and the report says what is missing")
    parser.add_argument("-o", dest="out", default="", metavar="OUT", help="where cells and report go (BUILD_DIR/paper)")
    parser.add_argument("--only", nargs="+", choices=TABLES, help="retrieval: Tables 1-4; laser: Table 5; bins: Tables"
                        " 6-7; real: elbows of a real sensor; ablations")
    parser.add_argument("--cells", default="", metavar="REGEX", help="run only experiments of such names (OUT/cells)")
    parser.add_argument("--quick", action="store_true", help="few scenes, to see that it works")
    parser.add_argument("--trials", type=int, default=0, metavar="N", help="motions per model and noise (default 2)")
    parser.add_argument("--bins", type=int, default=0, metavar="N", help="bins per part (default 20)")
    parser.add_argument("--ablation-bins", type=int, default=0, metavar="N", help="bins of the ablations (default 4)")
    parser.add_argument("--dataset", default="", metavar="DIR", help="own parts and clouds in place of ours, as"
                        " docs/evaluation.md describes them, or of the BOP benchmark")
    parser.add_argument("--split", default="", help="of a BOP data set")
    parser.add_argument("--parts", nargs="+", default=[], help="only these of the data set")
    parser.add_argument("--config", default="", metavar="FILE", help="constants for the own parts (default:"
                        " config/paper/three_way_tube.yaml)")
    parser.add_argument("--picking", nargs="+", action="extend", default=[], metavar="FILE", help="for Table 8: what"
                        " benchmark_picking --json has written, one file or several")
    parser.add_argument("-j", dest="jobs", type=int, default=max(1, (os.cpu_count() or 2)), metavar="N",
                        help="experiments at once, each on one thread (default: all processors)")
    parser.add_argument("--write", metavar="FILE", default="", help="also write the Markdown report there")
    parser.add_argument("--report-only", action="store_true", help="run nothing, report what is there")
    parser.add_argument("--program", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--experiment", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--package", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--version", default="", help=argparse.SUPPRESS)
    parser.add_argument("--code", default="", help=argparse.SUPPRESS)
    return parser.parse_args()


def main():
    options = parse()
    options.config = options.config and str(pathlib.Path(options.config).resolve())
    picking.read(options.picking)  # a wrong file is told before anything has run
    out = pathlib.Path(options.out)
    for folder in ("cells", "pictures", "models"):
        (out / folder).mkdir(parents=True, exist_ok=True)
    plan = cells.make_plan(options, options.package, out)
    for missing in plan.missing:
        print(f"paper: {missing.group} cannot be run: {missing.reason}", file=sys.stderr)
    failures = {}
    if not options.report_only:
        begin, busy, own = time.monotonic(), machine.busy_seconds_now(), sum(os.times()[:4])
        runner = Runner(options, out)
        failures = runner.run_all(plan)
        if not failures and not options.cells:
            shutil.rmtree(out / "models")  # gigabytes, of use only while experiments share them
        seconds = max(1e-3, time.monotonic() - begin)
        others = (machine.busy_seconds_now() - busy - (sum(os.times()[:4]) - own)) / seconds
        runner.note_others(max(0.0, others) if seconds > 1 else 0.0)
    report.write(options, plan, out, failures)
    print(f"paper: {out / 'report.html'} and {out / 'report.md'}", file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (OSError, ValueError, KeyError) as problem:
        sys.exit(f"paper: {problem}")
