# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""The HTML page of the report."""
import html
import re

STYLE = """
:root { color-scheme: light dark; --page: #f5f6f8; --card: #fff; --ink: #1a1f27; --soft: #616b7a; --line: #e1e5ea;
  --good: #1f9d57; --bad: #d92d3a; --accent: #3461d1; }
@media (prefers-color-scheme: dark) { :root { --page: #111419; --card: #1a1f26; --ink: #e8ebf0; --soft: #98a2b1;
  --line: #2c333d; --good: #46c57f; --bad: #ff6b74; --accent: #7fa2ff; } }
body { margin: 0; background: var(--page); color: var(--ink);
  font: 15px/1.45 system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
main { max-width: 1280px; margin: 0 auto; padding: 28px 24px 48px; }
h1 { font-size: 26px; margin: 0 0 6px; } h2 { font-size: 20px; margin: 40px 0 10px; }
h3 { font-size: 16px; margin: 24px 0 8px; }
p, li { max-width: 110ch; } .soft { color: var(--soft); font-size: 13.5px; }
.card { background: var(--card); border: 1px solid var(--line); border-radius: 10px; overflow-x: auto; }
.warning { border-left: 4px solid var(--bad); padding: 8px 14px; background: var(--card); }
.said { font-size: 16px; padding: 6px 18px 6px 34px; }
.said li { margin: 6px 0; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; font-size: 14px; }
th, td { padding: 6px 10px; text-align: right; border-bottom: 1px solid var(--line); vertical-align: top; }
th { color: var(--soft); font-weight: 600; font-size: 12.5px; vertical-align: bottom; }
th:first-child, td:first-child { text-align: left; }
.words td, .words th { text-align: left; }
tr.paper td { color: var(--soft); } tr.gap td { border-bottom: 2px solid var(--soft); padding: 0; height: 0; }
.holds { color: var(--good); } .fails { color: var(--bad); } code { font-size: 12.5px; }
.items { display: flex; flex-wrap: wrap; gap: 14px; align-items: flex-start; }
figure { margin: 0; max-width: 420px; background: var(--card); border: 1px solid var(--line); border-radius: 8px;
  padding: 8px; }
figure img { max-width: 100%; max-height: 330px; display: block; margin: 0 auto; border-radius: 4px; }
figure.big { max-width: 600px; } figure.big img { max-height: 520px; }
figcaption { font-size: 12.5px; color: var(--soft); margin-top: 5px; }
.chart { width: 300px; } .chart.wide { width: 560px; } .chart text { font-size: 11.5px; fill: var(--ink); }
nav a { margin-right: 14px; color: var(--accent); text-decoration: none; font-size: 14px; }
"""


def inline(text):
    text = html.escape(text)
    text = re.sub(r"\*\*(.+?)\*\*", r"<b>\1</b>", text)
    text = re.sub(r"`(.+?)`", r"<code>\1</code>", text)
    return text.replace("<b>holds</b>", '<b class="holds">holds</b>').replace(
        "<b>does not hold</b>", '<b class="fails">does not hold</b>')


def row_of(row, width):
    if not row:
        return f'<tr class="gap"><td colspan="{width}"></td></tr>'
    kind = ' class="paper"' if row[0].endswith(", paper") else ""
    return f"<tr{kind}>" + "".join(f"<td>{inline(cell)}</td>" for cell in row) + "</tr>"


def table_of(table):
    parts = [f"<h3>{inline(table.title)}</h3>"]
    if not table.rows:
        return parts + [f'<p class="soft">Not run{inline(": " + table.missing) if table.missing else ""}.</p>']
    words = ' class="words"' if "because" in table.columns else ""
    rows = list(table.rows)
    while rows and not rows[-1]:
        rows.pop()
    parts.append(f'<div class="card"><table{words}><thead><tr>' +
                 "".join(f"<th>{inline(column)}</th>" for column in table.columns) + "</tr></thead><tbody>" +
                 "".join(row_of(row, len(table.columns)) for row in rows) + "</tbody></table></div>")
    notes = table.notes + ([f"Left out: {table.missing}."] if table.missing else [])
    notes += [f"`{table.command}`{'; ' + table.origin if table.origin else ''}"] if table.command else []
    return parts + [f'<p class="soft">{"<br>".join(inline(note) for note in notes)}</p>']


def figure_of(figure):
    items = []
    for caption, markup in figure.items:
        big = ' class="big"' if "jpeg" in markup[:60] or "chart wide" in markup[:80] else ""
        items.append(f"<figure{big}>{markup}<figcaption>{inline(caption)}</figcaption></figure>")
    if not items:
        return [f"<h3>{inline(figure.title)}</h3>", f'<p class="soft">Not drawn: {inline(figure.missing)}.</p>']
    return [f"<h3>{inline(figure.title)}</h3>", f'<p class="soft">{inline(figure.note)}</p>' if figure.note else "",
            f'<div class="items">{"".join(items)}</div>']


def html_sections(all_sections, pictures):
    for k, (heading, group) in enumerate(all_sections):
        yield f'<h2 id="s{k}">{inline(heading)}</h2>'
        for table in group:
            yield from table_of(table)
        if k == 0 and pictures and pictures[0].title == "At a glance":
            yield from figure_of(pictures[0])


def html_page(body):
    return ("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width="
            "device-width, initial-scale=1\"><title>Cur-PPF: the paper's experiments, run again</title><style>" +
            STYLE + "</style></head><body><main>\n" + "\n".join(body) + "\n</main></body></html>\n")


def html_navigation(all_sections):
    links = [f'<a href="#s{k}">{inline(heading)}</a>' for k, (heading, _) in enumerate(all_sections)]
    return "<nav>" + "".join(links + ['<a href="#figures">Figures</a>', '<a href="#run">How it was run</a>']) + "</nav>"


def page_body(all_sections, said, introduction, text, warnings, failures, pictures):
    body = ["<h1>Cur-PPF: the paper's experiments, run again</h1>", f"<p>{inline(introduction)}</p>",
            html_navigation(all_sections)]
    body += [f'<p class="warning">{inline(warning.lstrip("> ").strip())}</p>' for warning in warnings]
    if said:
        body.append('<div class="card"><ul class="said">' + "".join(f"<li>{inline(s)}</li>" for s in said) +
                    "</ul></div>")
    body += html_sections(all_sections, pictures)
    body.append('<h2 id="figures">The paper\'s figures, from our runs</h2>')
    for figure in pictures:
        if figure.title != "At a glance":
            body += figure_of(figure)
    body += ['<h2 id="run">How it was run</h2>', f"<p>{inline(text)}</p>"]
    body += [f'<p class="warning">{inline(name)} failed: {inline(reason)}</p>' for name, reason in failures.items()]
    return body


def html_of(*arguments):
    return html_page(page_body(*arguments))
