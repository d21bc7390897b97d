# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""The paper's figures from the pictures that the runs drew, and charts as SVG."""
import base64
import dataclasses
import html

import cells
import figures
from tables import missing_of


@dataclasses.dataclass
class Figure:
    title: str
    note: str
    items: list  # of (caption, markup)
    needs: tuple = ()  # groups of experiments whose pictures it shows
    missing: str = ""  # why it has no items


def embedded(path):
    if not path.exists():
        return ""
    kind = "jpeg" if path.suffix == ".jpg" else "png"
    data = base64.b64encode(path.read_bytes()).decode()
    return f'<img alt="" loading="lazy" src="data:image/{kind};base64,{data}">'


def pictures(out, entries):
    items = [(caption, embedded(out / "pictures" / name)) for caption, name in entries]
    return [(caption, markup) for caption, markup in items if markup]


def histogram(result, width=300, height=120):
    """Bars of the curvature, the low range blue, the high range red, as they enter the weights."""
    low, high, counts = result["from"], result["to"], result["counts"]
    step = (high - low) / len(counts)
    most = max(counts) or 1
    bars = []
    for k, count in enumerate(counts):
        middle = abs(low + (k + 0.5) * step)
        color = "#3461d1" if middle <= result["low_max"] else "#d92d3a" if middle > result["high_min"] else "#8a93a1"
        tall = count / most * (height - 18)
        bars.append(f'<rect x="{k * width / len(counts):.1f}" y="{height - 16 - tall:.1f}" '
                    f'width="{width / len(counts) - 1:.1f}" height="{tall:.1f}" fill="{color}"/>')
    labels = (f'<text x="0" y="{height - 3}">{low:.3g}</text><text x="{width}" y="{height - 3}" '
              f'text-anchor="end">{high:.3g}</text>')
    return f'<svg viewBox="0 0 {width} {height}" class="chart">{"".join(bars)}{labels}</svg>'


def plain(value):
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def bars(entries, unit, width=560):
    """Horizontal bars: (name, value)."""
    most = max((value for _, value in entries), default=1) or 1
    rows = []
    for k, (name, value) in enumerate(entries):
        y = 24 * k
        length = value / most * (width - 330)
        rows.append(f'<text x="236" y="{y + 15}" text-anchor="end">{html.escape(name)}</text>'
                    f'<rect x="244" y="{y + 3}" width="{max(1, length):.1f}" height="16" rx="3" fill="#3461d1"/>'
                    f'<text x="{250 + length:.1f}" y="{y + 15}">{plain(value)}{html.escape(unit)}</text>')
    return f'<svg viewBox="0 0 {width} {24 * len(entries) + 4}" class="chart wide">{"".join(rows)}</svg>'


def charts(results):
    items = []
    whole = results.named("whole_")
    if whole:
        base = figures.runs_of(whole, "PPF")
        items.append(("Votes on whole surfaces, share of PPF's", bars(
            [(name, figures.ratios(figures.runs_of(whole, name), base, "votes"))
             for name in figures.methods_of(whole[0])], "")))
    for part, (_, top) in cells.PARTS.items():
        group = results.named(f"bins_{part}_")
        if group:
            names = figures.methods_of(group[0])
            items.append((f"{part}: ms a bin", bars(
                [(name, figures.mean([run["ms"] for run in figures.runs_of(group, name)])) for name in names], " ms")))
            items.append((f"{part}: right, of the best {top} poses", bars(
                [(name, 100 * figures.right_share(figures.runs_of(group, name), top).value()) for name in names],
                " %")))
    return Figure("At a glance", "", items)


def overlays(out, results, start, method, title):
    """The scene white, the model at the found pose green."""
    entries = []
    for name, _, _ in cells.MODELS:
        result = results.get(f"{start}_{name}")
        if result and method in figures.methods_of(result):
            entries.append((name, f"{start}_{name}_{figures.methods_of(result).index(method)}.png"))
    return Figure(title, "White: the scene; green: the model at the pose that was found.", pictures(out, entries),
                  ("retrieval",))


def curvature(out, results, names, title, note, needs):
    items = []
    for name in names:
        result = results.get(f"curvature_{name}")
        if not result:
            continue
        items += pictures(out, [(f"{name}: red high, blue low", f"curvature_{name}.png")])
        items.append((f"{name}: low to {result['low_max']:.3g}, high from {result['high_min']:.3g}",
                      histogram(result)))
    return Figure(title, note, items, needs)


def segmentation(out, results, part, title):
    captions = ["(a) one side of the model", "(b) its gray picture", "(c) the scene", "(d) gray from depth",
                "(e) watershed segments", "(f) candidate targets", "(g) their points"]
    entries = [(caption, f"segmentation_{part}_{letter}.png") for caption, letter in zip(captions, "abcdefg")]
    return Figure(title, "A virtual bin, Algorithm 1, pixel and contour counts.",
                  pictures(out, entries if results.get(f"segmentation_{part}") else []), ("bins",))


def process(out, results):
    items = []
    for part in cells.PARTS:
        result = results.get(f"bins_{part}_01")
        if result:
            items += pictures(out, [(f"{part}: {name}", f"bins_{part}_{k}.jpg")
                                    for k, name in enumerate(figures.methods_of(result))])
    return Figure("Figure 16: from the bin to ranked poses", "Red, orange, yellow, green, blue: best first, with the"
                  " matching rate (our preset: its score).", items, ("bins",))


def laser(out, results):
    entries = []
    for name in [name for name, _ in cells.LASER] + ["rs1"]:
        result = results.get(f"laser_{name}")
        if result:
            methods = figures.methods_of(result)
            entries += [(f"{name}: {method}", f"laser_{name}_{methods.index(method)}.png")
                        for method in ("Cur-PPF", "Cur-PPF + ICP")]
    return Figure("Figure 14: several objects, without and with ICP", "", pictures(out, entries), ("laser",))


def figures_of(results, plan, out):
    names = [name for name, _, _ in cells.MODELS]
    all_figures = [
        charts(results),
        segmentation(out, results, "three_way_tube", "Figure 5: segmentation and candidate targets, three-way tube"),
        curvature(out, results, cells.PARTS, "Figure 7: curvature of the real parts",
                  "Mean curvature in 1/m at a radius of 10 mm; ranges of Section 3.2.1.", ("bins",)),
        overlays(out, results, "whole", "PPF", "Figure 10: PPF on the Retrieval models"),
        overlays(out, results, "whole", "Cur-PPF (unweighted)", "Figure 11: Cur-PPF, unweighted"),
        curvature(out, results, names, "Figure 12: curvature histograms of the six models",
                  "Normal variation (no unit) at a radius of 15 mm; blue: low range, red: high range.",
                  ("retrieval",)),
        overlays(out, results, "whole", "Cur-PPF", "Figure 13: Cur-PPF, weighted"),
        laser(out, results), process(out, results),
        segmentation(out, results, "upright_column", "Figure 16, o to r: candidate targets of the upright column"),
        overlays(out, results, "clutter", "Cur-PPF", "Beyond the paper: one view in clutter, Cur-PPF")]
    for figure in all_figures[1:]:
        if not figure.items:
            figure.missing = missing_of(plan, *figure.needs) or "its experiments were not run"
    return [figure for figure in all_figures if figure.items or (figure.missing and not plan.options.dataset)]
