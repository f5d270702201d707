#include "lodestone/report/html_page.h"

#include "lodestone/report/html.h"

namespace lodestone::report {

extern const char kChartJs[];

namespace {

constexpr const char* kStyle = R"CSS(
:root { --ink: #1d2733; --soft: #5b6773; --line: #dde2e7; --paper: #fbfbf9; --card: #ffffff; --accent: #1f5f8b; }
* { box-sizing: border-box; }
html { scroll-behavior: smooth; }
body { margin: 0; background: var(--paper); color: var(--ink);
  font: 16px/1.55 "Source Serif 4", Charter, "Bitstream Charter", Georgia, "DejaVu Serif", serif; }
header, main, nav { max-width: 1120px; margin: 0 auto; padding: 0 28px; }
header { padding-top: 44px; }
h1 { font-size: 32px; line-height: 1.2; font-weight: 600; margin: 0 0 6px; letter-spacing: -0.01em; }
h2 { font-size: 23px; font-weight: 600; margin: 0 0 12px; }
h3 { font-size: 17px; font-weight: 600; margin: 30px 0 8px; }
p { max-width: 74ch; margin: 0 0 14px; }
.subtitle { color: var(--soft); margin: 0; }
nav { font: 14px/1.5 system-ui, "Helvetica Neue", "Liberation Sans", Arial, sans-serif; padding-top: 16px; }
nav a { color: var(--accent); text-decoration: none; margin-right: 22px; white-space: nowrap; }
nav a:hover { text-decoration: underline; }
section { border-top: 1px solid var(--line); margin-top: 34px; padding-top: 26px; }
code, pre { font: 13px/1.5 ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace; }
code { background: #eef1f3; padding: 1px 5px; border-radius: 3px; }
pre { background: #f3f5f6; border: 1px solid var(--line); padding: 12px; overflow: auto; max-height: 420px; }
details { margin: 14px 0; }
summary { cursor: pointer; color: var(--accent);
  font: 14px/1.6 system-ui, "Helvetica Neue", "Liberation Sans", Arial, sans-serif; }
.cards { display: grid; grid-template-columns: repeat(auto-fit, minmax(165px, 1fr)); gap: 14px; margin: 20px 0 26px; }
.card { background: var(--card); border: 1px solid var(--line); border-radius: 6px; padding: 14px 16px;
  font-family: system-ui, "Helvetica Neue", "Liberation Sans", Arial, sans-serif; }
.card .value { font-size: 25px; font-weight: 600; letter-spacing: -0.02em; font-variant-numeric: tabular-nums; }
.card .unit { font-size: 14px; font-weight: 400; color: var(--soft); }
.card .what { font-size: 13px; line-height: 1.4; color: var(--soft); margin-top: 2px; }
.scroll { overflow-x: auto; margin: 10px 0 6px; }
table { border-collapse: collapse; font: 14px/1.4 system-ui, "Helvetica Neue", "Liberation Sans", Arial, sans-serif;
  font-variant-numeric: tabular-nums; }
th { text-align: left; font-weight: 600; color: var(--soft); border-bottom: 1.5px solid var(--ink);
  padding: 5px 14px 5px 0; vertical-align: bottom; }
td { padding: 5px 14px 5px 0; border-bottom: 1px solid var(--line); vertical-align: top; }
th.number, td.number { text-align: right; white-space: nowrap; }
tr.published td { color: var(--soft); font-style: italic; }
tr.first td { border-top: 1.5px solid #9aa5b0; }
tr.ours td:first-child, tr.strong td { font-weight: 600; }
figure { margin: 14px 0 20px; background: var(--card); border: 1px solid var(--line); border-radius: 6px;
  padding: 14px 16px 12px; }
figcaption { font: 13.5px/1.5 system-ui, "Helvetica Neue", "Liberation Sans", Arial, sans-serif; color: var(--soft);
  margin-top: 8px; max-width: 92ch; }
figcaption b { color: var(--ink); }
.two { display: grid; grid-template-columns: repeat(auto-fit, minmax(440px, 1fr)); gap: 18px; }
.three { display: grid; grid-template-columns: repeat(auto-fit, minmax(310px, 1fr)); gap: 18px; }
.two figure, .three figure { margin: 0; }
.panels { display: grid; grid-template-columns: repeat(auto-fit, minmax(235px, 1fr)); gap: 10px; }
.panels .panel { text-align: center; font: 13px/1.5 system-ui, "Liberation Sans", Arial, sans-serif; color: var(--soft); }
.panels .panel b { color: var(--ink); font-size: 14px; }
.chart { position: relative; height: 270px; }
.chart.small { height: 215px; }
.missing { background: #fff7e6; border: 1px solid #f0deb4; border-radius: 6px; padding: 10px 14px; }
svg { width: 100%; height: auto; display: block; }
svg text { font-family: system-ui, "Helvetica Neue", "Liberation Sans", Arial, sans-serif; }
footer { max-width: 1120px; margin: 40px auto 0; padding: 18px 28px 40px; color: var(--soft); font-size: 14px; }
@media (max-width: 640px) { .two, .three { grid-template-columns: 1fr; } header, main, nav { padding: 0 16px; } }
@media print { figure, .card { break-inside: avoid; } nav { display: none; } }
)CSS";

// Draws one chart from plain data, so that every chart of the page looks alike.
constexpr const char* kDraw = R"JS(
function lodestone_chart(id, spec) {
  const axis = (label, log) => ({
    type: log ? 'logarithmic' : 'linear',
    title: { display: true, text: label, color: '#5b6773' },
    grid: { color: '#eceff1' },
    ticks: { maxTicksLimit: 7, color: '#5b6773' },
  });
  Chart.defaults.font.family = 'system-ui, "Helvetica Neue", "Liberation Sans", Arial, sans-serif';
  Chart.defaults.font.size = 12;
  Chart.defaults.color = '#1d2733';
  const x = spec.categories ? { title: { display: true, text: spec.x_label, color: '#5b6773' }, grid: { display: false } }
                            : axis(spec.x_label, false);
  const y = axis(spec.y_label, spec.log_y);
  if (!spec.log_y && spec.from_zero) y.beginAtZero = true;
  if (spec.y_max !== null) y.max = spec.y_max;
  new Chart(document.getElementById(id), {
    type: spec.categories ? 'bar' : 'line',
    data: {
      labels: spec.categories || undefined,
      datasets: spec.series.map(s => ({
        label: s.name, data: spec.categories ? s.values : s.points.map(p => ({ x: p[0], y: p[1] })),
        borderColor: s.colour, backgroundColor: s.colour, borderWidth: spec.categories ? 0 : 1.8,
        borderDash: s.dashed ? [6, 4] : [], pointRadius: s.points && s.points.length < 15 ? 3 : 0, pointHitRadius: 6,
        tension: 0, maxBarThickness: 42,
      })),
    },
    options: {
      animation: false, responsive: true, maintainAspectRatio: false,
      interaction: { mode: 'nearest', axis: 'x', intersect: false },
      scales: { x: x, y: y },
      plugins: {
        legend: { display: spec.series.length > 1, align: 'start',
                  labels: { boxWidth: 14, boxHeight: 2 + (spec.categories ? 8 : 0) } },
        title: { display: !!spec.title, text: spec.title, align: 'start', padding: { bottom: 6 },
                 font: { size: 14, weight: '600' } },
      },
    },
  });
}
)JS";

}  // namespace

HtmlPage::HtmlPage(std::string title, std::string subtitle)
    : title_(std::move(title)), subtitle_(std::move(subtitle)) {}

void HtmlPage::add_section(const std::string& id, const std::string& title, const std::string& content) {
  sections_.push_back({id, title, content});
}

std::string HtmlPage::render() const {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src "
      "'unsafe-inline'; "
      "style-src 'unsafe-inline'; img-src data:\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
      escape(title_) + "</title>\n<style>" + kStyle + "</style>\n<script>" + kChartJs +
      "</script>\n<script>" + kDraw + "</script>\n</head>\n<body>\n<header><h1>" + escape(title_) + "</h1>";
  if (!subtitle_.empty()) html += "<p class=\"subtitle\">" + escape(subtitle_) + "</p>";
  html += "</header>\n<nav>";
  for (const Section& section : sections_)
    html += "<a href=\"#" + escape(section.id) + "\">" + escape(section.title) + "</a>";
  html += "</nav>\n<main>\n";
  for (const Section& section : sections_)
    html += "<section id=\"" + escape(section.id) + "\"><h2>" + escape(section.title) + "</h2>\n" +
            section.content + "</section>\n";
  return html +
         "</main>\n<footer>Made by <code>lodestone report</code>. Charts: Chart.js (MIT licence), "
         "contained in this file.</footer>\n</body>\n</html>\n";
}

}  // namespace lodestone::report
