# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""The first thing a reader sees: what Cur-PPF gains over PPF, where, and at what cost. Every verdict is computed."""
import math

import cells
import figures
import picking
from tables import number, published

EQUAL = 1.0  # points of success or rate within which two methods are called equal


def percent(value):
    return "-" if math.isnan(value) else f"{value:.1f} %"


def times_less(share):
    return "-" if math.isnan(share) else f"{1 / share:.1f}x" if share < 1 else f"1/{share:.1f}x"


def verdict(held):
    return {True: "holds", False: "does not hold", None: "not run"}.get(held, held)


def within(share, limit):
    """Whether a share is at most so large, if its interval leaves that no doubt."""
    if not share.total:
        return None
    low, high = figures.wilson(share.hits, share.total)
    return "cannot be told" if low <= limit <= high else share.value() <= limit


def better(share, other):
    """Whether a share is larger, if the intervals do not meet."""
    if not share.total or not other.total:
        return None
    if figures.wilson(share.hits, share.total)[0] > figures.wilson(other.hits, other.total)[1]:
        return True
    if figures.wilson(share.hits, share.total)[1] < figures.wilson(other.hits, other.total)[0]:
        return False
    return "no difference seen"


class Claim:
    """A sentence of the paper, its figures and ours, and whether it holds here."""

    def __init__(self, claim, paper, ours, held, because=""):
        self.claim, self.paper, self.ours, self.held, self.because = claim, paper, ours, held, because

    def row(self):
        return [self.claim, self.paper, self.ours, f"**{verdict(self.held)}**", self.because]


def share_of(results, method, base, key, **equal):
    return figures.ratios(figures.runs_of(results, method, **equal), figures.runs_of(results, base, **equal), key)


def known(*values):
    return not any(math.isnan(value) for value in values)


def public_claims(results):
    whole = results.named("whole_")
    rate = {name: figures.rate(figures.runs_of(whole, name, noise=0.1)) for name in
            ("PPF", "Cur-PPF (unweighted)", "Cur-PPF")}
    gain = rate["Cur-PPF (unweighted)"] - rate["PPF"]
    weighted = rate["Cur-PPF"] - rate["Cur-PPF (unweighted)"]
    time = share_of(whole, "Cur-PPF (unweighted)", "PPF", "ms", noise=0.1)
    votes = share_of(whole, "Cur-PPF (unweighted)", "PPF", "votes", noise=0.1)
    cost = share_of(whole, "Cur-PPF", "Cur-PPF (unweighted)", "ms", noise=0.1)
    return [
        Claim("Curvature raises the matching rate (Table 1)", "87.75 to 93.65 %",
              f"{percent(rate['PPF'])} to {percent(rate['Cur-PPF (unweighted)'])}",
              gain > EQUAL if known(gain) else None,
              "a sound PPF has nothing left to gain on whole surfaces" if known(gain) and rate["PPF"] > 99 else ""),
        Claim("Curvature saves time (Table 2)", "3.8x", f"{times_less(time)}, with {times_less(votes)} fewer votes",
              time < 0.9 if known(time) else None, "the longer key sorts out model pairs before they vote"),
        Claim("Weighted votes raise the rate further (Table 3)", "93.65 to 96.30 %",
              f"{percent(rate['Cur-PPF (unweighted)'])} to {percent(rate['Cur-PPF'])}",
              weighted > EQUAL if known(weighted) else None, "see weight 1 to 8 in the ablations"),
        Claim("... at about the same time (Table 4)", "1.18x the time", f"{number(cost, 2)}x the time",
              cost < 1.25 if known(cost) else None)]


def bin_group(results):
    return results.named("own_") or [result for part in cells.PARTS for result in results.named(f"bins_{part}_")]


def of_kept(results, what, name):
    """A share of all poses that are kept: five of a tube's bin, three of a column's, as in the paper."""
    own = results.named("own_")
    groups = [(own, 5)] if own else [(results.named(f"bins_{part}_"), top) for part, (_, top) in cells.PARTS.items()]
    shares = [what(figures.runs_of(group, name), top) for group, top in groups]
    return figures.Share(sum(share.hits for share in shares), sum(share.total for share in shares))


def bin_claims(results):
    group = bin_group(results)

    def mean_rate(name):
        if results.named("own_"):
            return figures.mean(figures.scene_rates(figures.runs_of(group, name), 5))
        return figures.mean([figures.mean(figures.scene_rates(figures.runs_of(results.named(f"bins_{part}_"), name),
                                                              top)) for part, (_, top) in cells.PARTS.items()])
    ppf, cur, refined = mean_rate("PPF"), mean_rate("Cur-PPF"), mean_rate("Cur-PPF + ICP")
    time = share_of(group, "Cur-PPF", "PPF", "ms")
    segmentation = share_of(group, "PPF on the candidates", "PPF", "ms")
    curvature = share_of(group, "Cur-PPF", "PPF on the candidates", "ms")
    fast = share_of(group, "our preset fast", "Cur-PPF + ICP", "ms")
    right = {name: 100 * of_kept(results, figures.right_share, name).value() for name in
             ("PPF", "Cur-PPF", "Cur-PPF + ICP", "our preset fast")}
    wrong = of_kept(results, figures.graspable_but_wrong, "Cur-PPF + ICP")
    return [
        Claim("In bins Cur-PPF has the higher matching rate (Table 6)", "85.50 to 94.98 %",
              f"{percent(ppf)} to {percent(cur)}", cur - ppf > EQUAL if known(cur, ppf) else None,
              f"of the kept poses {percent(right['PPF'])} (PPF) and {percent(right['Cur-PPF'])} (Cur-PPF) are right"),
        Claim("... and takes half the time (Table 7)", "2.1x",
              f"{times_less(time)}: segmentation {times_less(segmentation)}, curvature {times_less(curvature)}",
              time < 0.6 if known(time) else None,
              "the paper's two rows differ in segmentation and feature; here they are told apart"),
        Claim("ICP brings the rate to 98 % (Table 6)", "94.98 to 98.20 %", f"{percent(cur)} to {percent(refined)}",
              refined >= 98.2 if known(refined) else None),
        Claim("A rate above 85 % means a pose good enough to grasp (Section 3.2.2)", "95 of 100 grasps",
              f"wrong, of Cur-PPF + ICP's poses above 85 %: {wrong.text()}",
              within(wrong, 0.05),
              "at 5 mm a wrong pose matches the surface of a thin-walled part too"),
        Claim("(not in the paper) our preset fast beside Cur-PPF + ICP", "-",
              f"{times_less(fast)} faster; right: {percent(right['Cur-PPF + ICP'])} to "
              f"{percent(right['our preset fast'])}",
              right["our preset fast"] >= right["Cur-PPF + ICP"] if known(*right.values()) else None)]


def partial_claims(results):
    clutter = results.named("clutter_") + results.named("view_")
    ppf, cur, spread = (figures.successes(figures.runs_of(clutter, name)) for name in
                        ("PPF", "Cur-PPF", "Cur-PPF, spread 0.3"))
    votes = share_of(clutter, "Cur-PPF, spread 0.3", "PPF", "votes")
    return [Claim("Curvature enhances the description (2.1.2) also in single views and clutter",
                  "not measured", f"right, %: PPF {ppf.text()}, Cur-PPF {cur.text()}, with votes for the next"
                  f" bin too {spread.text()} at {times_less(votes)} fewer votes",
                  better(cur, ppf),
                  "a neighbourhood cut off by an edge has another curvature than the model's")]


def picking_claims(results):
    rows = picking.of_the_paper(results.picking)
    taken = figures.Share(sum(row.taken().hits for row in rows), sum(row.taken().total for row in rows))
    total, success, _, _ = published("8", "Cur-PPF + ICP")
    low, high = figures.wilson(taken.hits, taken.total)
    shakes = sum(row.shakes() for row in rows)
    held = "cannot be told" if low <= success / total <= high else low > success / total
    ways = "; ".join(dict.fromkeys(row.how for row in rows))
    return [Claim("A grasp succeeds 95 times of 100 (Table 8)", f"{success} of {total}",
                  f"{taken.text()} with {shakes} shakes" if taken.total else "-", held if taken.total else None,
                  f"a virtual cell, kinder than a real one; {ways}" if taken.total else "")]


def claims(results):
    return public_claims(results) + partial_claims(results) + bin_claims(results) + picking_claims(results)


def headline(results):
    """A few sentences; nothing that has not been run is spoken of."""
    parts = (said_of_cells, said_of_whole, said_of_bins, said_of_poses, said_of_partial, said_of_fast, said_of_picks)
    return [sentence for part in parts if (sentence := part(results))]


def reached(results):
    """(ours, the paper's rate) of every cell of Tables 1, 3, 5 and 6 for Cur-PPF that has been run."""
    pairs = []
    for row, table in (("Cur-PPF (unweighted)", "1"), ("Cur-PPF", "3")):
        for k, (name, _, _) in enumerate(cells.MODELS):
            runs = figures.runs_of(results.named(f"whole_{name}"), row, noise=0.1)
            pairs.append((figures.rate(runs), published(table, row)[k]))
    for row in ("Cur-PPF", "Cur-PPF + ICP"):
        pairs.append((figures.rate(figures.runs_of(results.named("laser_Parasaurolophus"), row)),
                      published("5", row)[3]))
        for k, (part, (_, top)) in enumerate(cells.PARTS.items()):
            runs = figures.runs_of(results.named(f"bins_{part}_"), row)
            pairs.append((figures.mean(figures.scene_rates(runs, top)), published("6", row)[k]))
    return [(ours, theirs) for ours, theirs in pairs if known(ours)]


def said_of_cells(results):
    pairs = reached(results)
    if not pairs:
        return ""
    return (f"**Cur-PPF reaches the paper's matching rate** in {sum(a >= b for a, b in pairs)} of the {len(pairs)}"
            " cells of Tables 1, 3, 5 and 6 that were run.")


def said_of_whole(results):
    whole = results.named("whole_")
    votes, time = (share_of(whole, "Cur-PPF (unweighted)", "PPF", key) for key in ("votes", "ms"))
    if not known(votes, time):
        return ""
    ppf, cur = (figures.rate(figures.runs_of(whole, name)) for name in ("PPF", "Cur-PPF"))
    return ("**What it gains is time.** On whole surfaces curvature in the feature casts"
            f" {times_less(votes)} fewer votes and takes {times_less(time)} less time than PPF; the matching"
            f" rate is {percent(ppf)} with PPF and {percent(cur)} with weighted Cur-PPF: the paper's gain in"
            " rate is not seen.")


def said_of_bins(results):
    group = bin_group(results)
    time, segmentation = share_of(group, "Cur-PPF", "PPF", "ms"), share_of(group, "PPF on the candidates", "PPF", "ms")
    curvature = share_of(group, "Cur-PPF", "PPF on the candidates", "ms")
    if not known(time, segmentation, curvature):
        return ""
    return (f"**In bins** Cur-PPF takes {times_less(time)} less time than PPF (the paper: 2.1x), but"
            f" {times_less(segmentation)} of it come from searching only the candidate targets, which PPF can do too;"
            f" curvature alone saves {times_less(curvature)}.")


def said_of_poses(results):
    shares = {name: of_kept(results, figures.right_share, name) for name in
              ("PPF", "PPF on the candidates", "Cur-PPF", "Cur-PPF + ICP")}
    wrong = of_kept(results, figures.graspable_but_wrong, "Cur-PPF + ICP")
    if not wrong.total:
        return ""
    text = ", ".join(f"{name} {share.text()}" for name, share in shares.items())
    return (f"**What the matching rate hides:** it is near 100 % for all, yet of the kept poses are right, %: {text}."
            f" Of the poses with ICP that the paper would grasp (rate above 85 %), {wrong.text()} % are wrong.")


def said_of_partial(results):
    scenes = results.named("clutter_") + results.named("view_")
    right = {name: figures.successes(figures.runs_of(scenes, name)) for name in
             ("PPF", "Cur-PPF", "Cur-PPF, spread 0.3")}
    if not right["PPF"].total:
        return ""
    votes = share_of(scenes, "Cur-PPF", "PPF", "votes")
    text = ", ".join(f"{name} {share.text()}" for name, share in right.items())
    return f"**In single views and clutter**, with {times_less(votes)} fewer votes, are right, %: {text}."


def said_of_fast(results):
    group = bin_group(results)
    share = of_kept(results, figures.right_share, "our preset fast")
    if not share.total:
        return ""
    time = share_of(group, "our preset fast", "Cur-PPF + ICP", "ms")
    return (f"**Our preset fast**, the same pipeline with a test of every pose against the measured depth, takes"
            f" {times_less(time)} less time than Cur-PPF + ICP; right, %: {share.text()}.")


def said_of_picks(results):
    rows = picking.of_the_paper(results.picking)
    attempts = [attempt for row in rows for attempt in row.attempts()]
    if not attempts:
        return ""
    taken = figures.Share(sum(attempt["outcome"] == "taken" for attempt in attempts), len(attempts))
    total, success, _, _ = published("8", "Cur-PPF + ICP")
    return (f"**Picking tubes in the virtual cell**: of the picks succeed, %: {taken.text()}, with"
            f" {sum(row.shakes() for row in rows)} shakes where nothing could be grasped (the paper, in a real cell:"
            f" {success} of {total}). A virtual cell is kinder than a real one.")
