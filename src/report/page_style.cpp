#include "page_assets.h"

namespace lodestone::report {

const char kPageStyle[] = R"CSS(
:root { color-scheme: light dark;
  --ink: #1d2733; --soft: #5b6773; --line: #dde2e7; --grid: #eceff1; --strong-line: #9aa5b0; --paper: #fbfbf9;
  --card: #ffffff; --accent: #1f5f8b; --code: #eef1f3; --note: #fff7e6; --note-line: #f0deb4;
  --sans: system-ui, "Helvetica Neue", "Liberation Sans", Arial, sans-serif; }
* { box-sizing: border-box; }
html { scroll-behavior: smooth; }
body { margin: 0; background: var(--paper); color: var(--ink);
  font: 16px/1.55 "Source Serif 4", Charter, "Bitstream Charter", Georgia, "DejaVu Serif", serif; }
header, main, nav { max-width: 1240px; margin: 0 auto; padding: 0 28px; }
header { padding-top: 44px; }
h1 { font-size: 32px; line-height: 1.2; font-weight: 600; margin: 0 0 6px; letter-spacing: -0.01em; }
h2 { font-size: 23px; font-weight: 600; margin: 0 0 12px; }
h3 { font-size: 17px; font-weight: 600; margin: 30px 0 8px; }
p { max-width: 74ch; margin: 0 0 14px; }
.subtitle { color: var(--soft); margin: 0; }
nav { font: 14px/1.5 var(--sans); padding-top: 16px; }
nav a { color: var(--accent); text-decoration: none; margin-right: 22px; white-space: nowrap; }
nav a:hover { text-decoration: underline; }
section { border-top: 1px solid var(--line); margin-top: 34px; padding-top: 26px; }
code, pre { font: 13px/1.5 ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace; }
code { background: var(--code); padding: 1px 5px; border-radius: 3px; overflow-wrap: anywhere; }
pre { background: var(--code); border: 1px solid var(--line); padding: 12px; overflow: auto; max-height: 420px; }
details { margin: 14px 0; }
summary { cursor: pointer; color: var(--accent); font: 14px/1.6 var(--sans); }
.cards { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr)); gap: 14px; margin: 20px 0 26px; }
.card { background: var(--card); border: 1px solid var(--line); border-radius: 6px; padding: 14px 16px;
  font-family: var(--sans); }
.card .value { font-size: 25px; font-weight: 600; letter-spacing: -0.02em; font-variant-numeric: tabular-nums;
  white-space: nowrap; }
.card .unit { font-size: 14px; font-weight: 400; color: var(--soft); }
.card .what { font-size: 13px; line-height: 1.4; color: var(--soft); margin-top: 2px; }
.scroll { overflow-x: auto; margin: 10px 0 6px; }
table { border-collapse: collapse; font: 14px/1.4 var(--sans); font-variant-numeric: tabular-nums; }
th { text-align: left; font-weight: 600; color: var(--soft); border-bottom: 1.5px solid var(--ink);
  padding: 5px 14px 5px 0; vertical-align: bottom; }
td { padding: 5px 14px 5px 0; border-bottom: 1px solid var(--line); vertical-align: top; }
th.number, td.number { text-align: right; }
td.number, .whole { white-space: nowrap; }
tr.published td { color: var(--soft); font-style: italic; }
tr.first td { border-top: 1.5px solid var(--strong-line); }
tr.ours td:first-child, tr.strong td { font-weight: 600; }
figure { margin: 14px 0 20px; background: var(--card); border: 1px solid var(--line); border-radius: 6px;
  padding: 14px 16px 12px; }
figcaption { font: 13.5px/1.5 var(--sans); color: var(--soft); margin-top: 8px; max-width: 92ch; }
figcaption b { color: var(--ink); }
.two { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(440px, 100%), 1fr)); gap: 18px; }
.three { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(310px, 100%), 1fr)); gap: 18px; }
.two figure, .three figure { margin: 0; min-width: 0; }
.panels { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(235px, 100%), 1fr)); gap: 10px; }
.panels .panel { text-align: center; font: 13px/1.5 var(--sans); color: var(--soft); max-width: 420px; }
.panels .panel b { color: var(--ink); font-size: 14px; }
.panels figure { margin: 0; }
.panels.wide { grid-template-columns: repeat(auto-fit, minmax(min(420px, 100%), 1fr)); }
.panels.wide .panel { max-width: none; min-width: 0; }
img { max-width: 100%; height: auto; display: block; }
.chart { position: relative; height: 270px; }
.chart.small { height: 235px; }
.missing { background: var(--note); border: 1px solid var(--note-line); border-radius: 6px; padding: 10px 14px; }
svg { width: 100%; height: auto; display: block; }
svg text { font-family: var(--sans); }
.enlarge { cursor: zoom-in; }
.large { position: fixed; inset: 0; z-index: 10; margin: 0 !important; max-width: none !important; overflow: auto;
  background: var(--paper); cursor: zoom-out; padding: 3vh 4vw; border: 0; border-radius: 0; }
.large .chart { height: 84vh; }
.large > svg { height: 84vh; }
.large .enlarge { cursor: zoom-out; }
.large > img { max-height: 88vh; width: auto; margin: 0 auto; }
body.has-large { overflow: hidden; }
footer { max-width: 1240px; margin: 40px auto 0; padding: 18px 28px 40px; color: var(--soft); font-size: 14px; }
@media (max-width: 640px) { header, main, nav { padding: 0 16px; } }
@media print { figure, .card { break-inside: avoid; } nav { display: none; } }
@media screen and (prefers-color-scheme: dark) {
  :root { --ink: #e4e8ec; --soft: #a3adb8; --line: #333c46; --grid: #2b333c; --strong-line: #6a7682; --paper: #14181d;
    --card: #1b2026; --accent: #7cb8e4; --code: #262d35; --note: #3a3018; --note-line: #6b5a2a; }
  svg text { fill: var(--soft); }
  svg .ground { fill: #10141a; }
  svg .rim { stroke: var(--soft); }
  svg .frame { stroke: #46505b; }
  svg .coil { fill: #4a3a2b; stroke: #b98a5e; }
  svg .hollow { fill: #10141a; }
  svg [stroke="#1f5f8b"] { stroke: #6db3e8; } svg [fill="#1f5f8b"] { fill: #6db3e8; }
  svg [stroke="#c8553d"] { stroke: #f08a72; } svg [fill="#c8553d"] { fill: #f08a72; }
  svg [stroke="#7a8b3c"] { stroke: #b6c95f; } svg [fill="#7a8b3c"] { fill: #b6c95f; }
  svg [stroke="#2f7d4f"] { stroke: #62c98c; }
}
)CSS";

}  // namespace lodestone::report
