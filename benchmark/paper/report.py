# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Report of benchmark/paper.sh: Markdown, and one HTML page that needs nothing else."""
import json

import bin_tables
import figures
import gallery
import machine
import page
import picking
import summary
import tables
from tables import Table

INTRODUCTION = (
    "Cui, Yu, Wu and Wu published Cur-PPF (Sensors 2022, 22, 1805) without a program. This is every experiment of"
    " theirs run again with ours, whose preset `paper` makes each choice as in the text; docs/paper.md tells how its"
    " gaps were read. Their bins are not public: virtual scans stand in for them, and it says so where they do. Every"
    " figure comes from a run; those marked \"paper\" are the paper's own.")


def sections(results, plan, options):
    """(heading, tables) in order."""
    claims = Table("Its claims, one by one", ["claim", "paper", "ours", "here it", "because"],
                   [claim.row() for claim in summary.claims(results)],
                   ["Every verdict is computed from the tables below; \"holds\" is about the claim on our data, not"
                    " about their scenes."])
    whole = [("The paper's tables: public data", [
        tables.retrieval_rates(results, plan), tables.retrieval_times(results, plan),
        tables.retrieval_details(results, plan), tables.laser(results, plan)])]
    bins = [("The paper's tables: bins", [
        bin_tables.rates(results, plan), bin_tables.times(results, plan), bin_tables.behind(results, plan),
        bin_tables.real_listed(results, plan),
        picking.table(results.picking, options.picking, options.package)])]
    beyond = [("Where the paper does not look", [tables.partial(results, plan), tables.occlusion(results, plan)]),
              ("Ablations", [bin_tables.ablations(results, plan), bin_tables.noise(results, plan)])]
    if options.dataset:
        return [("Summary", [claims]), ("Bins", bins[0][1][:3] + (bins[0][1][-1:] if results.picking else [])),
                ("Single parts as point sets", [tables.retrieval_details(results, plan),
                                                tables.partial(results, plan)])]
    return [("Summary", [claims])] + whole + bins + beyond


def about_text(about, plan, results):
    done, all_cells = len(results.by_name), len(plan.cells)
    text = (f"{about.get('processor', 'unknown processor')}, {about.get('processors', '?')} processors; version"
            f" {about.get('version', 'unknown')}; load average before the run {about.get('load', 0):.1f}, others"
            f" kept {about.get('others_busy', 0):.1f} processors busy. {done} of {all_cells} experiments are in"
            f" this report, with {plan.trials} motion(s) of a model per noise, {plan.views} per view and clutter, and"
            f" {plan.bins} bin(s) of a part{' (--quick)' if plan.options.quick else ''}.")
    return text, machine.busy_warning(about.get("load", 0), about.get("others_busy", 0))


def lines_of(table):
    yield f"### {table.title}\n"
    if not table.rows:
        yield f"Not run{': ' + table.missing if table.missing else ''}.\n"
        return
    yield "| " + " | ".join(table.columns) + " |"
    yield "|---|" + "---:|" * (len(table.columns) - 1)
    for row in table.rows:
        if row:
            yield "| " + " | ".join(row) + " |"
    yield ""
    for note in table.notes:
        yield f"- {note}"
    if table.missing:
        yield f"- Left out: {table.missing}."
    if table.command:
        yield f"- `benchmark/paper.sh {table.command}`"
    yield ""


def markdown(all_sections, said, text, warning, failures):
    yield "# Cur-PPF: the paper's experiments, run again\n"
    yield INTRODUCTION + "\n"
    if warning:
        yield warning
    for sentence in said:
        yield f"- {sentence}"
    yield ""
    for heading, group in all_sections:
        yield f"## {heading}\n"
        for table in group:
            yield from lines_of(table)
    yield "## How it was run\n"
    yield text + "\n"
    yield ("`benchmark/paper.sh --data DIR` makes it again; with `--dataset DIR` on your own parts and clouds. The HTML"
           " page beside it has the figures.\n")
    for name, reason in failures.items():
        yield f"- {name} failed: {reason}"


def write(options, plan, out, failures):
    results = figures.Results(plan, out, picking.read(options.picking))
    file = out / "machine.json"
    about = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    text, warning = about_text(about, plan, results)
    all_sections = sections(results, plan, options)
    said = summary.headline(results)
    content = "\n".join(markdown(all_sections, said, text, warning, failures)).rstrip() + "\n"
    for path in [out / "report.md"] + ([options.write] if options.write else []):
        with open(path, "w", encoding="utf-8") as stream:
            stream.write(content)
    pictures = gallery.figures_of(results, plan, out)
    (out / "report.html").write_text(page.html_of(all_sections, said, INTRODUCTION, text, warning, failures, pictures),
                                     encoding="utf-8")
