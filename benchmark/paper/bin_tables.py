# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Tables 6 and 7 and the ablations: whole bins."""
import math

import cells
import figures
from tables import Table, average, holds_everywhere, missing_of, number, published

COLUMNS = {"three_way_tube": "Three-Way Tube", "upright_column": "Pillar"}
IN_PAPER = ("PPF", "Cur-PPF", "PPF + ICP", "Cur-PPF + ICP")
BIN_CELLS = ("bins_", "real_", "own_")
REAL_TOP = 5  # best poses of a real bin that are kept


def sources(results):
    """(heading, results, best poses that are kept) of every column."""
    own = results.named("own_")
    if own:
        return [("own parts", own, REAL_TOP)]
    columns = [(COLUMNS[part], results.named(f"bins_{part}_"), top) for part, (_, top) in cells.PARTS.items()]
    real = results.named("real_")
    return columns + ([("real elbows", real, REAL_TOP)] if real else [])


def names_of(columns):
    for _, results, _ in columns:
        if results:
            return figures.methods_of(results[0])
    return []


def scenes_text(columns):
    return "; ".join(f"{heading}: {sum(result['scenes'] for result in results)} bins, best {top} poses of each"
                     for heading, results, top in columns)


def heading_note(columns):
    return (f"{scenes_text(columns)}. The tube and the column are of our own making, in virtual structured-light scans:"
            " the paper's scenes are not public. The elbows were measured by a real stereo camera.")


def only_option(results):
    return "--dataset DIR" if results.named("own_") else "--only bins real"


def rates(results, plan):
    columns = sources(results)
    table = Table("Table 6: matching rate in bins, %", ["method"] + [heading for heading, _, _ in columns] +
                  ["average of the two"], [], command=only_option(results),
                  cells=BIN_CELLS, missing=missing_of(plan, "bins", "real"))
    two = [column for column in columns if column[0] in COLUMNS.values()]
    for name in names_of(columns):
        if name in IN_PAPER:
            paper = published("6", name)
            shown = dict(zip(COLUMNS.values(), paper))
            table.rows.append([f"{name}, paper"] + [number(shown.get(heading, math.nan), 2)
                                                    for heading, _, _ in columns] + [number(paper[2], 2)])
        ours = {heading: figures.mean(figures.scene_rates(figures.runs_of(group, name), top))
                for heading, group, top in columns}
        mean = average([ours[heading] for heading, _, _ in two])[-1] if two else math.nan
        table.rows.append([f"**{name}, ours**"] + [number(value, 2) for value in ours.values()] + [number(mean, 2)])
        if name in IN_PAPER and two:
            table.notes.append(f"{name}: " + holds_everywhere([ours[h] for h, _, _ in two] + [mean], paper))
    table.notes.insert(0, heading_note(columns))
    table.notes += ["PPF searches the whole scene and Cur-PPF the candidate targets, as in the paper's Figure 16.",
                    "Equation 9 divides by the object's points in the scene: with candidate targets those of the"
                    " candidate, on the whole scene the measured points under the pose. Rows of different segmentation"
                    " divide by different points; what is right does not depend on it (next table but one).",
                    "A bin with fewer poses than are kept counts by those that it has, one without any as 0; how many"
                    " came stands there too."]
    return table


def times(results, plan):
    columns = sources(results)
    table = Table("Table 7: time in bins, ms a scene", ["method"], [], command=only_option(results),
                  cells=BIN_CELLS, missing=missing_of(plan, "bins", "real"))
    for heading, _, _ in columns:
        table.columns += [f"{heading}: ms", "of PPF's"]
    for name in names_of(columns):
        if name in IN_PAPER:
            shown = dict(zip(COLUMNS.values(), published("7", name)))
            base = dict(zip(COLUMNS.values(), published("7", "PPF")))
            row = [f"{name}, paper"]
            for heading, _, _ in columns:
                row += [number(shown[heading], 0), number(shown[heading] / base[heading], 2)] if heading in shown else [
                    "-", "-"]
            table.rows.append(row)
        row = [f"**{name}, ours**"]
        for _, group, _ in columns:
            runs, base = figures.runs_of(group, name), figures.runs_of(group, "PPF")
            row += [number(figures.mean([run["ms"] for run in runs]), 0), number(figures.ratios(runs, base, "ms"), 3)]
        table.rows.append(row)
    table.notes = ["Processor time of one thread. The shares are of PPF's time on the same scenes in the same run, the"
                   " geometric mean over the scenes: they hold on other machines, the milliseconds do not.",
                   "PPF + ICP: where there is no candidate target, 50 clusters are refined, each against the whole scene;"
                   " that there are so many is our choice and not the method's."]
    return table


def behind(results, plan):
    columns = sources(results)
    table = Table("Behind Tables 6 and 7: what the matching rate hides",
                  ["method", "part", "rate, %", "poses kept", "right, of the kept poses, %", "first one right, %",
                   "wrong, of poses with a rate of 85 % or more, %", "right ones off by", "votes, of PPF's"], [],
                  command=only_option(results),
                  cells=BIN_CELLS, missing=missing_of(plan, "bins", "real"))
    for heading, group, top in columns:
        is_real = heading == "real elbows"
        for name in names_of(columns):
            runs, base = figures.runs_of(group, name), figures.runs_of(group, "PPF")
            off, turned = figures.pose_error(runs, top)
            untold = "not told by the silver poses"
            table.rows.append([
                name, heading, number(figures.mean(figures.scene_rates(runs, top))),
                f"{sum(len(figures.kept(run, top)) for run in runs)} of {top * len(runs)}",
                untold if is_real else figures.right_share(runs, top).text(),
                untold if is_real else figures.first_right(runs).text(),
                untold if is_real else figures.graspable_but_wrong(runs, top).text(),
                f"{number(off, 2)} mm, {number(turned, 2)} deg", number(figures.ratios(runs, base, "votes"), 3)])
        table.rows.append([])
    voteless = [f"{name}: {count}" for name in names_of(columns) for count in [sum(
        run["votes"] == 0 for _, group, _ in columns for run in figures.runs_of(group, name))] if count]
    table.notes = ["Right: no point of the part is off by more than a tenth of its diameter (MSSD). A rate of 85 % is"
                   " what the paper grasps at (Section 3.2.2)."]
    if voteless:
        table.notes.append("Bins in which nothing was searched, no candidate target having been found, are not in the"
                           " shares of votes: " + ", ".join(voteless) + ".")
    return table


def real_listed(results, plan):
    group = results.named("real_")
    table = Table("Real elbow bins: silver poses that are found, %", ["method", "found among all returned poses"], [],
                  command="--only real", cells=("real_",), missing=missing_of(plan, "real"))
    for name in figures.methods_of(group[0]) if group else []:
        table.rows.append([name, figures.found_of_listed(figures.runs_of(group, name)).text()])
    table.notes = ["Six clouds of a real stereo camera. The list holds a few elbows of each; the paper's presets return"
                   " five poses at most, so that they cannot find them all where more lie free."]
    return table


def ablations(results, plan):
    group = results.named("ablation_")
    table = Table("Ablations: Cur-PPF + ICP on the three-way tube, one thing done otherwise",
                  ["ingredient", "in place", "rate, %", "right, of the best five, %", "first one right, %",
                   "curvature bins", "votes", "time", "ms"], [], command="--only ablations", cells=("ablation_",),
                  missing=missing_of(plan, "ablations"))
    if not group:
        return table
    rows = cells.ablation_methods(plan.config("three_way_tube"))
    base = figures.runs_of(group, rows[0][2]["name"])
    for k, (ingredient, instead, method) in enumerate(rows):
        runs = figures.runs_of(group, method["name"])
        if not runs:
            continue
        table.rows.append([ingredient, instead, number(figures.mean(figures.scene_rates(runs, 5))),
                           figures.right_share(runs, 5).text(), figures.first_right(runs).text(),
                           str(group[0]["models"][k]["curvature_bins"]), number(figures.ratios(runs, base, "votes"), 2),
                           number(figures.ratios(runs, base, "ms"), 2),
                           number(figures.mean([run["ms"] for run in runs]), 0)])
    table.notes = [f"{len(group)} bin(s) of 25 tubes, five poses of each: intervals are wide, and what lies within them"
                   " is no finding. Votes and time are multiples of the first row's, whose"
                   " weight is 3. \"Off\" segmentation draws"
                   " 1/50 of the points as references, not 1/5."]
    return table


def noise(results, plan):
    table = Table("Depth noise of the sensor, three-way tube: right of the best five, %; mean rate, %", ["method"] + [
        f"{value} mm" for value in cells.SENSOR_NOISES], [], command="--only ablations", cells=("noise_",),
        missing=missing_of(plan, "ablations"))
    groups = {value: results.named(f"noise_{value}_") for value in cells.SENSOR_NOISES}
    there = [group for group in groups.values() if group]
    for name in figures.methods_of(there[0][0]) if there else []:
        row = [name]
        for group in groups.values():
            runs = figures.runs_of(group, name)
            row.append(f"{figures.right_share(runs, 5).text()}; rate "
                       f"{number(figures.mean(figures.scene_rates(runs, 5)))}" if runs else "-")
        table.rows.append(row)
    table.notes = [f"{max((len(group) for group in groups.values()), default=0)} bin(s) a column, the same piles."]
    return table
