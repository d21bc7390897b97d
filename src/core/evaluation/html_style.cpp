// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "html_parts.hpp"

namespace bin_picking
{
const char* const REPORT_STYLE = R"css(
:root { color-scheme: light dark;
  --page: #f5f6f8; --card: #ffffff; --ink: #1a1f27; --soft: #616b7a; --line: #e1e5ea; --track: #e8ebf0;
  --accent: #3461d1;
  --right: #1f9d57; --hidden: #1895a3; --wrong: #d92d3a; --missed: #c76a00; }
@media (prefers-color-scheme: dark) { :root {
  --page: #111419; --card: #1a1f26; --ink: #e8ebf0; --soft: #98a2b1; --line: #2c333d; --track: #2a313b;
  --accent: #7fa2ff;
  --right: #46c57f; --hidden: #45c2cf; --wrong: #ff6b74; --missed: #ffab40; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--ink);
  font: 15px/1.45 system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
main { max-width: 1440px; margin: 0 auto; padding: 28px 24px 48px; }
h1 { font-size: 26px; line-height: 1.2; margin: 0 0 4px; overflow-wrap: anywhere; }
h2 { font-size: 17px; margin: 36px 0 12px; }
.soft { color: var(--soft); }
.details { color: var(--soft); margin: 0 0 22px; overflow-wrap: anywhere; }
.details b { color: var(--ink); font-weight: 600; }
.tiles { display: grid; grid-template-columns: repeat(auto-fill, minmax(205px, 1fr)); gap: 12px; }
.tile, .panel, .scene { background: var(--card); border: 1px solid var(--line); border-radius: 10px; }
.tile { padding: 14px 16px; }
.tile .name { color: var(--soft); font-size: 13px; }
.tile .value { font-size: 28px; font-weight: 650; letter-spacing: -.02em; font-variant-numeric: tabular-nums; }
.tile .note { color: var(--soft); font-size: 13px; font-variant-numeric: tabular-nums; }
.track { position: relative; height: 6px; border-radius: 3px; background: var(--track); margin: 6px 0 6px; }
.track i { position: absolute; top: 0; bottom: 0; border-radius: 3px; background: var(--accent); opacity: .4; }
.track b { position: absolute; top: -3px; width: 4px; height: 12px; margin-left: -2px; border-radius: 2px;
  background: var(--accent); }
.track u { position: absolute; top: -2px; width: 10px; height: 10px; margin-left: -5px; border-radius: 50%;
  border: 2px solid var(--ink); }
td.reliability { width: 40%; min-width: 160px; } td.reliability .track { margin-top: 9px; }
.panel { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { padding: 9px 12px; text-align: right; white-space: nowrap; border-bottom: 1px solid var(--line);
  vertical-align: top; }
th { font-size: 12.5px; font-weight: 600; color: var(--soft); white-space: normal; vertical-align: bottom; }
th:first-child, td:first-child { text-align: left; }
tr:last-child td { border-bottom: 0; }
tr.all td { font-weight: 650; }
td small { display: block; color: var(--soft); font-weight: 400; font-size: 12px; }
.stages { padding: 14px 16px; display: grid; grid-template-columns: max-content 1fr max-content; gap: 7px 14px;
  align-items: center; }
.bar { position: relative; height: 12px; }
.bar i, .bar b { position: absolute; left: 0; top: 0; bottom: 0; border-radius: 3px; background: var(--accent); }
.bar i { opacity: .28; }
.stages .time { text-align: right; font-variant-numeric: tabular-nums; }
.filters { display: flex; flex-wrap: wrap; gap: 8px; margin-bottom: 14px; align-items: center; }
.filters button { font: inherit; font-size: 13.5px; padding: 5px 12px; border-radius: 999px; cursor: pointer;
  border: 1px solid var(--line); background: var(--card); color: var(--ink); }
.filters button[aria-pressed=true] { background: var(--ink); color: var(--page); border-color: var(--ink); }
.legend { display: flex; flex-wrap: wrap; gap: 6px 16px; margin-left: auto; font-size: 13px; color: var(--soft); }
.key { display: inline-block; width: 14px; height: 10px; border-radius: 2px; border: 2px solid; margin-right: 6px; }
.key.hidden, .key.duplicate, .key.missed { border-style: dashed; }
.scenes { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(440px, 100%), 1fr)); gap: 16px;
  align-items: start; }
.scene { overflow: hidden; }
.scene.wide { grid-column: 1 / -1; }
.scene.off { display: none; }
.scene header { display: flex; flex-wrap: wrap; gap: 4px 10px; padding: 10px 14px; align-items: baseline; }
.scene header b { font-size: 15px; overflow-wrap: anywhere; }
.chips { margin-left: auto; display: flex; gap: 10px; font-size: 13px; font-weight: 600; white-space: nowrap; }
.picture { position: relative; background: #161a22; cursor: zoom-in; line-height: 0; }
.wide .picture { cursor: zoom-out; }
.picture img { width: 100%; height: auto; display: block; }
.picture svg { position: absolute; inset: 0; width: 100%; height: 100%; }
.picture path { stroke-width: 1.6; stroke-linejoin: round; vector-effect: non-scaling-stroke; fill-rule: evenodd; }
.picture text { font-weight: 700; text-anchor: middle; dominant-baseline: central; fill: #fff; paint-order: stroke;
  stroke: #000a; stroke-width: 3px; vector-effect: non-scaling-stroke; pointer-events: none; }
.mark-right { fill: #35c97455; stroke: #35d07b; }
.mark-hidden { fill: #2bbccb38; stroke: #45c2cf; stroke-dasharray: 3 2; }
.mark-duplicate { fill: #ff4d5838; stroke: #ff6b74; stroke-dasharray: 6 3; }
.mark-wrong { fill: #ff4d5866; stroke: #ff6b74; }
.picture .mark-missed { fill: #0000; stroke: #ffab40; stroke-width: 3; stroke-dasharray: 7 3; pointer-events: all; }
.picture path:hover, .picture path.lit { fill-opacity: .65; stroke: #fff; stroke-width: 2.6; }
.picture .mark-missed:hover, .picture .mark-missed.lit { fill: #ffab40; fill-opacity: .4; }
.finds { margin: 0; padding: 8px 14px 12px; list-style: none; font-size: 13.5px; font-variant-numeric: tabular-nums; }
.finds li { padding: 2px 6px; margin: 0 -6px; border-radius: 5px; display: flex; gap: 8px; }
.finds li:hover { background: var(--track); }
.finds [data-mark] { cursor: default; }
.finds .score { margin-left: auto; color: var(--soft); white-space: nowrap; }
details { border-top: 1px solid var(--line); }
summary { padding: 8px 14px; cursor: pointer; font-size: 13.5px; color: var(--soft); }
.right { color: var(--right); } .hidden { color: var(--hidden); } .wrong, .duplicate { color: var(--wrong); }
.missed { color: var(--missed); }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 6px 18px; color: var(--soft); font-size: 13.5px;
  max-width: 100ch; }
dt { font-weight: 600; color: var(--ink); } dd { margin: 0; }
@media (max-width: 640px) {
  main { padding: 18px 12px; } dl { grid-template-columns: 1fr; } .legend { margin-left: 0; } }
@media print { .filters { display: none; } .scene { break-inside: avoid; } }
)css";

const char* const REPORT_SCRIPT = R"js(
const scenes = [...document.querySelectorAll('.scene')];
const buttons = [...document.querySelectorAll('.filters button')];
const filter = wanted => {
  for (const b of buttons) b.setAttribute('aria-pressed', b.dataset.show === wanted);
  for (const s of scenes) s.classList.toggle('off', wanted !== 'all' && !s.dataset.has.split(' ').includes(wanted));
};
for (const b of buttons) b.addEventListener('click', () => filter(b.dataset.show));
for (const s of scenes) {
  s.querySelector('.picture').addEventListener('click', () => s.classList.toggle('wide'));
  for (const row of s.querySelectorAll('[data-mark]')) {
    const mark = s.querySelector('path[data-id="' + row.dataset.mark + '"]');
    if (!mark) continue;
    row.addEventListener('mouseenter', () => mark.classList.add('lit'));
    row.addEventListener('mouseleave', () => mark.classList.remove('lit'));
  }
}
)js";
}  // namespace bin_picking
