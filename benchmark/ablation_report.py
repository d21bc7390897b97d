# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""The table of benchmark/ablation.sh, in Markdown."""
import ablation_figures
import machine

TITLES = ["ingredient", "in place of the default"] + [f"{name}, %" for name in ablation_figures.SHARES] + [
    "AP, %", "wrong", "in empty bins", "votes", "time", "what the default buys"]


def points(value):
    return f"{100 * value:+.1f}"


def share_cell(value, difference):
    low, high = difference[1]
    return f"{100 * value:.1f} ({points(low)} to {points(high)})"


def is_certain(limits, nothing):
    return limits[0] > nothing or limits[1] < nothing


def bought(row, unsteady):
    """Of what the default has over the variant, only what is certain; of times only what two equal runs do not differ by."""
    words = [f"{points(-difference)} {name}" for name, (difference, limits) in
             zip(ablation_figures.SHARES, row["differences"]) if is_certain(limits, 0)]
    ratio, limits = row["time"]
    if is_certain(limits, 1) and not 1 / unsteady <= ratio <= unsteady:
        words.append(f"{ratio:.2f} x as fast" if ratio > 1 else f"takes {1 / ratio:.2f} x the time")
    return ", ".join(words) or "nothing certain"


def figures_cells(figures, differences, default_votes):
    shares = [share_cell(value, difference) if differences else f"{100 * value:.1f}"
              for value, difference in zip(figures.shares, differences or figures.shares)]
    precision = figures.average_precision
    return shares + ["-" if precision is None else f"{100 * precision:.1f}", str(figures.wrong),
                     str(figures.false_in_empty), f"{figures.votes / max(1, default_votes):.2f}"]


def print_row(cells):
    print("| " + " | ".join(cells) + " |")


def print_report(default, rows, failures, about):
    print("# What each ingredient buys\n")
    if warning := machine.busy_warning(about["load_before"], about["others_busy"]):
        print(warning)
    print(f"{about['scenes']} scenes of {about['set']}, preset {about['preset']}, {about['threads']} thread(s);"
          f" {about['processor']}; version {about['version']}.\n")
    print("One thing at a time is done otherwise than by default. In brackets: the 95 % interval of the difference to"
          " the default, in points, by drawing whole scenes again (paired bootstrap); votes and time are multiples of the"
          f" default's. Two runs of the default next to each other differed in time by up to {about['unsteady']:.2f} x."
          " The last column names only differences whose interval leaves out none at all; of a hundred"
          " intervals five miss by chance, so a small difference that stands alone proves little. Sorted by the recall"
          " that is lost.\n")
    print_row(TITLES)
    print("|---|---|" + "---:|" * (len(TITLES) - 3) + "---|")
    print_row(["**default**", ""] + figures_cells(default, None, default.votes) + ["1.00", ""])
    for row in sorted(rows, key=lambda row: [difference for difference, _ in row["differences"]]):
        ratio, limits = row["time"]
        print_row([row["variant"].ingredient, row["variant"].instead] +
                  figures_cells(row["figures"], row["differences"], default.votes) +
                  [f"{ratio:.2f} ({limits[0]:.2f} to {limits[1]:.2f})", bought(row, about["unsteady"])])
    print()
    for variant, message in failures:
        print(f"- {variant.title()}: could not be run: {message}")


def to_json(default, rows, failures, about):
    def figures(of):
        return {**dict(zip(ablation_figures.SHARES, of.shares)), "average_precision": of.average_precision,
                "wrong": of.wrong, "false_in_empty": of.false_in_empty, "votes": of.votes}
    return {"format": 1, "about": about, "default": figures(default),
            "variants": [{"ingredient": row["variant"].ingredient, "instead": row["variant"].instead,
                          "values": row["variant"].values, "leaf_factor": row["variant"].leaf_factor,
                          **figures(row["figures"]), "time_ratio": row["time"][0], "time_interval_95": row["time"][1],
                          "differences": {name: {"value": value, "interval_95": limits} for name, (value, limits) in
                                          zip(ablation_figures.SHARES, row["differences"])}} for row in rows],
            "failures": [{"variant": variant.title(), "message": message} for variant, message in failures]}
