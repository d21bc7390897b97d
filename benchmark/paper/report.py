# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Report of benchmark/paper.sh: Markdown, and one HTML page that needs nothing else."""
import pathlib

import bin_tables
import figures
import gains
import gallery
import machine
import page
import picking
import stamps
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
    gained = gains.table(results)
    whole = [("The paper's tables: public data", [
        tables.retrieval_rates(results, plan), tables.retrieval_times(results, plan),
        tables.retrieval_details(results, plan), tables.by_model(results, plan),
        tables.laser(results, plan)])]
    bins = [("The paper's tables: bins", [
        bin_tables.rates(results, plan), bin_tables.times(results, plan), bin_tables.behind(results, plan),
        bin_tables.real_listed(results, plan),
        picking.table(results.picking, options.picking, options.package)])]
    beyond = [("Where the paper does not look", [tables.partial(results, plan), tables.occlusion(results, plan)]),
              ("Ablations", [bin_tables.ablations(results, plan), bin_tables.noise(results, plan)])]
    if options.dataset:
        return [("Summary", [gained, claims]), ("Bins", bins[0][1][:3] + (bins[0][1][-1:] if results.picking else [])),
                ("Single parts as point sets", [tables.retrieval_details(results, plan),
                                                tables.by_model(results, plan), tables.partial(results, plan)])]
    return [("Summary", [gained, claims])] + whole + bins + beyond


def command_of(options, words):
    """The command that makes a table again, with the options that change its figures."""
    said = ["benchmark/paper.sh", words]
    said += ["--data DIR"] if options.data and not options.dataset else []
    said += ["--quick"] if options.quick else []
    values = {"--trials": options.trials, "--bins": options.bins, "--ablation-bins": options.ablation_bins,
              "--split": options.split, "--config": options.config and pathlib.Path(options.config).name,
              "--parts": " ".join(options.parts)}
    for key, value in values.items():
        said += [f"{key} {value}"] if value and key not in words else []
    return " ".join(said + [f"-j {options.jobs}"])


def few(names):
    return ", ".join(names[:12]) + (f" and {len(names) - 12} more" if len(names) > 12 else "")


def about_text(plan, results):
    text = (f"{stamps.sentence(list(results.stamps.values())) or 'Nothing has been run'}. {len(results.by_name)} of"
            f" {len(plan.cells)} experiments are in this report, with {plan.trials} motion(s) of a model per noise,"
            f" {plan.views} per view and clutter, and {plan.bins} bin(s) of a part"
            f"{' (--quick)' if plan.options.quick else ''}.")
    if results.absent:
        text += f" Not in it, because they were not run: {few(results.absent)}."
    text += " Loads are the worst of all experiments. Every table names the version and the machine that it is from."
    return text


def warnings_of(results):
    """What a reader must know before any figure."""
    taken = list(results.stamps.values())
    said = [machine.busy_warning(stamps.worst(taken, "load"), stamps.worst(taken, "others_busy"))] if taken else []
    if results.left_out:
        said.append(f"> **WARNING: {len(results.left_out)} results in this folder are left out**, since they are of"
                    f" other code, data or options than these; run this again to renew them:"
                    f" {few(results.left_out)}.\n")
    return [warning for warning in said if warning]


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
        yield f"- `{table.command}`{'; ' + table.origin if table.origin else ''}"
    yield ""


def markdown(all_sections, said, text, warnings, failures):
    yield "# Cur-PPF: the paper's experiments, run again\n"
    yield INTRODUCTION + "\n"
    yield from warnings
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
    code = stamps.code_of(out, plan.cells, options.code, options.report_only)
    results = figures.Results(plan, out, picking.read(options.picking), code)
    text, warnings = about_text(plan, results), warnings_of(results)
    all_sections = sections(results, plan, options)
    for table in (table for _, group in all_sections for table in group):
        table.command = command_of(options, table.command) if table.command else ""
        table.origin = stamps.sentence(results.stamps_of(table.cells)) if table.cells else ""
    said = gains.headline(results)
    content = "\n".join(markdown(all_sections, said, text, warnings, failures)).rstrip() + "\n"
    for path in [out / "report.md"] + ([options.write] if options.write else []):
        with open(path, "w", encoding="utf-8") as stream:
            stream.write(content)
    pictures = gallery.figures_of(results, plan, out)
    (out / "report.html").write_text(page.html_of(all_sections, said, INTRODUCTION, text, warnings, failures, pictures),
                                     encoding="utf-8")
