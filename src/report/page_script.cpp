#include "page_assets.h"

namespace lodestone::report {

const char kPageScript[] = R"JS(
const lodestone_charts = [];
const lodestone_dark = matchMedia('(prefers-color-scheme: dark)');
// Colours that are hard to see on a dark ground, and what stands for them there; the style has the same for drawings.
const lodestone_light_for = { '#1f5f8b': '#6db3e8', '#6aa6c9': '#b9dcf2', '#c8553d': '#f08a72', '#b9bfc5': '#8b949e',
                              '#7a8b3c': '#b6c95f', '#7b4ea3': '#c39be6', '#e0a695': '#a8604f' };

function lodestone_chart(id, spec) {
  lodestone_charts.push({ id: id, spec: spec, chart: lodestone_draw(id, spec) });
}

function lodestone_draw(id, spec) {
  const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const soft = css('--soft'), ink = css('--ink'), grid = css('--grid');
  const colour = c => lodestone_dark.matches && lodestone_light_for[c] || c;
  const title = label => ({ display: true, text: label, color: soft });
  const axis = (label, log) => ({
    type: log ? 'logarithmic' : 'linear', title: title(label), grid: { color: grid },
    ticks: { maxTicksLimit: 7, color: soft },
  });
  Chart.defaults.font.family = css('--sans');
  Chart.defaults.font.size = 12;
  Chart.defaults.color = ink;
  const x = spec.categories ? { title: title(spec.x_label), grid: { display: false }, ticks: { color: soft } }
                            : axis(spec.x_label, false);
  const y = axis(spec.y_label, spec.log_y);
  if (!spec.log_y && spec.from_zero) y.beginAtZero = true;
  if (spec.y_max !== null) y.max = spec.y_max;
  const dataset = s => ({
    label: s.name, data: spec.categories ? s.values : s.points.map(p => ({ x: p[0], y: p[1] })),
    borderColor: colour(s.colour), backgroundColor: colour(s.colour) + (s.band ? '2e' : ''),
    borderWidth: spec.categories || s.band ? 0 : 1.8, borderDash: s.dashed ? [6, 4] : [],
    showLine: !s.dots, stepped: !!s.stepped, fill: s.filled ? '-1' : false,
    pointRadius: s.dots ? 1.6 : s.band || s.stepped ? 0 : s.points && s.points.length < 15 ? 3 : 0,
    pointHitRadius: s.band ? 0 : 6, tension: 0, maxBarThickness: 42,
  });
  return new Chart(document.getElementById(id), {
    type: spec.categories ? 'bar' : 'line',
    data: { labels: spec.categories || undefined, datasets: spec.series.map(dataset) },
    options: {
      animation: false, responsive: true, maintainAspectRatio: false,
      interaction: { mode: 'nearest', axis: 'x', intersect: false },
      scales: { x: x, y: y },
      plugins: {
        tooltip: { filter: item => !!item.dataset.label || spec.series.length === 1 },
        legend: { display: spec.series.filter(s => s.name).length > 1, align: 'start',
                  labels: { color: ink, boxWidth: 14, boxHeight: 2 + (spec.categories ? 8 : 0),
                            filter: item => !!item.text } },
        title: { display: !!spec.title, text: spec.title, align: 'start', padding: { bottom: 6 }, color: ink,
                 font: { size: 14, weight: '600' } },
      },
    },
  });
}

lodestone_dark.addEventListener('change', () => {
  for (const each of lodestone_charts) {
    each.chart.destroy();
    each.chart = lodestone_draw(each.id, each.spec);
  }
});

// A click, or Enter where the keyboard is, shows a drawing as large as the window; the next one, or Escape, puts it back.
function lodestone_enlarge(target) {
  const large = document.querySelector('.large');
  if (large) large.classList.remove('large');
  const frame = large ? null : target && target.closest('.panel, figure');
  if (frame) frame.classList.add('large');
  document.body.classList.toggle('has-large', !!frame);
}
document.addEventListener('DOMContentLoaded', () => {
  for (const each of document.querySelectorAll('figure svg, figure canvas, figure img')) {
    each.classList.add('enlarge');
    each.tabIndex = 0;
    each.addEventListener('click', () => lodestone_enlarge(each));
  }
});
document.addEventListener('keydown', event => {
  if (event.key === 'Escape' && document.querySelector('.large')) lodestone_enlarge(null);
  if (event.key === 'Enter' && event.target.classList.contains('enlarge')) lodestone_enlarge(event.target);
});
)JS";

}  // namespace lodestone::report
