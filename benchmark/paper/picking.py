# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Table 8 from what `benchmark_picking --json FILE` writes (benchmark/picking/json_report.cpp)."""
import collections
import dataclasses
import json
import pathlib

from figures import Share
from tables import PUBLISHED, Table, number, published

PAPER_PART = "three_way_tube"
OUTCOMES = ("taken", "missed", "collision", "another_part")
CURE = "give a file that `benchmark_picking PART_DIR... --gripper FILE.yaml --json FILE` of this version has written"
# Which bins are filled, how many at most and where things are kept: bins that differ in nothing else are one row.
NO_SETTING = ("--seeds", "--json", "--picks", "--threads", "--models")


@dataclasses.dataclass
class Row:
    """All bins of one part that were emptied alike."""
    part: str
    how: str         # in words
    is_truth: bool   # true poses in place of detections
    bins: list       # as in the file

    def attempts(self):
        return [attempt for one in self.bins for attempt in one["attempts"]]

    def taken(self):
        return Share(sum(a["outcome"] == "taken" for a in self.attempts()), len(self.attempts()))

    def causes(self):
        """What failed attempts failed by, the most frequent first."""
        return collections.Counter(a["cause"] for a in self.attempts() if a["outcome"] != "taken").most_common()

    def called_free(self):
        return sum(a["called_free"] for a in self.attempts())

    def shakes(self):
        return sum(one["shakes"] for one in self.bins)

    def filled(self):
        return sum(one["filled"] for one in self.bins)


def field(node, key, kind, where, file):
    if not isinstance(node, dict) or key not in node:
        raise ValueError(f"{file} has no '{key}' in {where}; {CURE}")
    if not isinstance(node[key], kind) or (kind is int and isinstance(node[key], bool)):
        raise ValueError(f"'{key}' in {where} of {file} is {json.dumps(node[key])[:40]}, which benchmark_picking does"
                         f" not write; {CURE}")
    return node[key]


def load(file):
    try:
        study = json.loads(pathlib.Path(file).read_text(encoding="utf-8"))
    except OSError as problem:
        raise ValueError(f"--picking {file} cannot be read ({problem.strerror}); {CURE}") from problem
    except ValueError as problem:
        raise ValueError(f"{file} is not JSON ({problem}); {CURE}") from problem
    check(study, file)
    return study


def check(study, file):
    for key, kind in (("command", list), ("sensor", str), ("gripper", str), ("truth", bool), ("parts", list)):
        field(study, key, kind, "its outermost object", file)
    for p, part in enumerate(study["parts"]):
        field(part, "name", str, f"parts[{p}]", file)
        for b, one in enumerate(field(part, "bins", list, f"parts[{p}]", file)):
            where = f"parts[{p}].bins[{b}]"
            for key, kind in (("seed", int), ("filled", int), ("shakes", int), ("attempts", list), ("left", dict)):
                field(one, key, kind, where, file)
            for a, attempt in enumerate(one["attempts"]):
                place = f"{where}.attempts[{a}]"
                if field(attempt, "outcome", str, place, file) not in OUTCOMES:
                    raise ValueError(f"the outcome in {place} of {file} is '{attempt['outcome']}', but it must be one"
                                     f" of {', '.join(OUTCOMES)}; {CURE}")
                field(attempt, "cause", str, place, file)
                field(attempt, "called_free", bool, place, file)


def settings(command):
    """The options of a command that say how bins are emptied: {option: words}; "": the parts."""
    chosen, option = {"": []}, ""
    for word in command[1:]:
        if word.startswith("--"):
            option = word
            chosen[option] = []
        else:
            chosen[option].append(word)
    for flag in ("--mixed", "--truth", "--no-shake"):  # what follows these is a folder of a part
        chosen[""] += chosen.get(flag, [])
    single = ("--gripper", "--robot", "--count", "--failures", "--sensor", "--preset")
    return {key: words[:1] if key in single else words for key, words in chosen.items() if key not in NO_SETTING}


def base_name(folder):
    return pathlib.PurePath(folder).name


def described(study):
    options = settings(study["command"])

    def value(key, default):
        return (options.get(key) or [default])[0]
    robot = pathlib.PurePath(value("--robot", "")).stem
    words = ["true poses, nothing detected" if study["truth"] else f"preset {value('--preset', 'fast')}",
             f"sensor {study['sensor']}", f"gripper {study['gripper']}", f"robot {robot}" if robot else "any reach",
             f"{value('--count', '25')} of a kind in a bin"]
    words += [f"kinds together: {' '.join(sorted(map(base_name, options[''])))}"] if "--mixed" in options else []
    words += ["never shaken"] if "--no-shake" in options else []
    words += [f"bin given up after {value('--failures', '')} failures in a row"] if "--failures" in options else []
    words += [" ".join(["--set"] + options["--set"])] if "--set" in options else []
    words += [f"version {study['version']}"] if study.get("version") else []  # files of two versions are not one row
    return ", ".join(words)


def read(files):
    """A row for each part and way of emptying, over all files. \\throws ValueError"""
    rows, seen = {}, {}
    for file in files:
        study = load(file)
        how = described(study)
        for part in study["parts"]:
            row = rows.setdefault((part["name"], how), Row(part["name"], how, study["truth"], []))
            for one in part["bins"]:
                key = (part["name"], how, one["seed"])
                if key in seen:
                    raise ValueError(f"bin {one['seed']} of {part['name']} is in {seen[key]} and again in {file}: it"
                                     " would count twice; leave one of the files out")
                seen[key] = file
                row.bins.append(one)
    return sorted(rows.values(), key=lambda row: (row.part != PAPER_PART, row.part, row.how))


def commands(files, package):
    """The commands that wrote the files, with paths as seen from the package, without the place of their models."""
    return [" ".join(str(word).replace(f"{package}/", "") for word in without(load(file)["command"], "--models"))
            for file in files]


def without(command, option):
    """The command without an option and its value."""
    return [word for word, before in zip(command, [None, *command]) if option not in (word, before)]


def cells_of(row):
    share = row.taken()
    causes = "; ".join(f"{count} x {cause}" for cause, count in row.causes())
    return [str(len(row.bins)), str(share.total), str(share.hits), str(share.total - share.hits), share.text(),
            causes or "-", str(row.called_free()), str(row.shakes()), str(row.filled() - share.hits)]


def mark(how, ways):
    """Tells rows apart that were emptied in different ways."""
    return f" ({ways.index(how) + 1})" if len(ways) > 1 else ""


def table(rows, files, package):
    paper = published("8", "Cur-PPF + ICP")
    result = Table("Table 8: capture success rate", [
        "", "bins", "picks", "successes", "failures", "success, % (95 % interval)", "failures by cause",
        "collisions called free", "shakes", "parts left"], [])
    total, success, failure, _ = paper
    causes = "; ".join(f"{count} x {cause}" for cause, count in PUBLISHED["8"]["failures"].items())
    result.rows.append(["Three-way tube in a real cell, paper", "-", str(total), str(success), str(failure),
                        Share(success, total).text(), causes, "-", "not told", "-"])
    ways = list(dict.fromkeys(row.how for row in rows))
    for row in rows:
        result.rows.append([f"**{row.part}, ours, virtual cell**{mark(row.how, ways)}"] + cells_of(row))
    for how in ways:
        alike = [row for row in rows if row.how == how]
        if len(alike) > 1:
            result.rows.append([f"all of ours together{mark(how, ways)}"] +
                               cells_of(Row("all", how, alike[0].is_truth, [b for row in alike for b in row.bins])))
    result.notes = notes(rows, ways)
    result.command = "--picking FILE..."
    for command in commands(files, package):
        result.notes.append(f"`{command}`")
    return result


def notes(rows, ways):
    if not rows:
        return ["Ours stays empty: no report of the picking benchmark was given. `benchmark_picking"
                " config/parts/three_way_tube --gripper config/grippers/ag95.yaml --robot config/robots/ur5e.yaml"
                " --json picks.json` writes one (built with -DBIN_PICKING_BENCHMARKS=ON); then `--picking picks.json`."]
    said = ["Ours: " + "; ".join(f"{how}{mark(how, ways)}" for how in ways) + ". The paper's row is Cur-PPF + ICP; the"
            " interval beside its rate is computed from its counts."]
    attempts = sum(len(row.attempts()) for row in rows)
    shakes = sum(row.shakes() for row in rows)
    return said + [
        "The virtual cell judges a grip by the true geometry, not by what planned it: the gripper goes straight in,"
        " closes and comes straight out; touching a part, the bin or the table where it must not is a collision, and"
        " holding nothing, or not as meant, or outside of the friction cone, is a miss; so is taking a part where the"
        " detection's own kind does not lie within 25 mm. Only a part that is taken without any collision is a"
        " success. Nothing slips, tips or rolls, and the description of the gripper is exact: a real cell is less"
        " kind.",
        "A shake: where no grasp is allowed, nothing is tried; the bin is shaken, what is left in it falls anew, and it"
        f" goes on. That is no failure and no pick: here {shakes} shakes beside {attempts} picks"
        f" ({number(shakes / max(1, attempts), 2)} a pick). The paper tells of none and does not say what was done"
        " where nothing could be grasped, so that the two rates are not of the same rule.",
        "Called free: collisions with something that the answer had checked and vouched for. Left: parts still in the"
        " bins when they were given up or the number of picks was reached."]


def of_the_paper(rows):
    """What the paper's 95 of 100 may be held against, picks of tubes that were detected: (successes, shakes)."""
    tubes = [row for row in rows if row.part == PAPER_PART and not row.is_truth]
    shares = [row.taken() for row in tubes]
    return (Share(sum(share.hits for share in shares), sum(share.total for share in shares)),
            sum(row.shakes() for row in tubes))
