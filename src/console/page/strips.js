// The instruments as strips of the last minutes: drawn at most twice a second, and only those in sight.

import { coil_colours, coil_names } from './coils.js';
import { by_id, dark_scheme, make, palette, set_text } from './dom.js';
import { number } from './format.js';

const kKept_s = 600;
const kBetween_ms = 500;
const kBuckets = 150;  // two points each
const kAxis_px = 46;

const kStrips = [
  { title: 'Error', unit: 'mm', digits: 2, of: 'error_mm', span: 1 },
  { title: 'Currents', unit: 'A', digits: 1, of: 'current_A', coils: true },
  { title: 'Duty', unit: '%', digits: 0, of: 'duty', coils: true, factor: 100 },
  { title: 'Temperatures', unit: '°C', digits: 1, of: 'temperature_C', coils: true, free: true },
  { title: 'Supply', unit: 'V', digits: 2, of: 'supply_V', free: true },
  { title: 'Pose age', unit: 'ms', digits: 0, of: 'pose_age_ms', span: 10 },
  { title: 'Control jitter', unit: 'ms', digits: 2, of: 'jitter_ms', span: 1 },
];

export class Strips {
  #samples = [];
  #strips = [];
  #minutes = 3;
  #period_s = 1;
  #drawn_ms = -kBetween_ms;
  #due = false;

  constructor(connection) {
    this.#strips = kStrips.map(spec => new Strip(spec, () => this.#draw_soon()));
    by_id('strips').append(...this.#strips.map(strip => strip.element));
    connection.on('hello', hello => this.#begin(hello));
    connection.on('state', state => this.#add(state.sample));
    dark_scheme.addEventListener('change', () => this.#recolour());
    for (const button of by_id('span').children) button.addEventListener('click', () => this.#choose(Number(button.dataset.minutes)));
    this.#show_key();
  }

  #begin(hello) {
    this.#period_s = hello.period_s;
    this.#samples = hello.samples.slice();
    this.#recolour();
  }

  #add(sample) {
    if (!sample || sample.time_s <= (this.#samples.at(-1)?.time_s ?? -Infinity)) return;
    this.#samples.push(sample);
    const old = this.#samples.findIndex(each => each.time_s > sample.time_s - kKept_s);
    if (old > 100) this.#samples.splice(0, old);
    this.#draw_soon();
  }

  #choose(minutes) {
    this.#minutes = minutes;
    for (const button of by_id('span').children) button.setAttribute('aria-pressed', String(Number(button.dataset.minutes) === minutes));
    this.#draw_soon(0);
  }

  #draw_soon(between_ms = kBetween_ms) {
    if (this.#due) return;
    this.#due = true;
    setTimeout(() => requestAnimationFrame(() => {
      this.#due = false;
      this.#drawn_ms = performance.now();
      this.#draw();
    }), Math.max(0, this.#drawn_ms + between_ms - performance.now()));
  }

  #draw() {
    const last = this.#samples.at(-1);
    const now_s = last?.time_s ?? 0;
    const span_s = 60 * this.#minutes;
    const shown = this.#samples.slice(first_after(this.#samples, now_s - span_s));
    for (const strip of this.#strips) strip.draw(shown, last, now_s, span_s, this.#period_s);
  }

  #show_key() {
    const colours = coil_colours();
    by_id('coil-key').replaceChildren(...coil_names().map((name, coil) => {
      const line = make('i');
      line.style.background = colours[coil];
      return make('span', {}, line, name);
    }));
  }

  #recolour() {
    this.#show_key();
    for (const strip of this.#strips) strip.recolour();
    this.#draw_soon(0);
  }
}

class Strip {
  #spec;
  #values = make('span', { className: 'values' });
  #canvas = make('canvas');
  #chart = null;
  #in_sight = false;

  constructor(spec, wanted) {
    this.#spec = spec;
    this.#canvas.setAttribute('aria-hidden', 'true');
    const title = make('h3', {}, `${spec.title} `, make('small', { textContent: spec.unit }));
    this.element = make('article', { className: 'strip' }, title, this.#values, make('div', { className: 'paper' }, this.#canvas));
    new IntersectionObserver(([entry]) => {
      this.#in_sight = entry.isIntersecting;
      if (this.#in_sight) wanted();
    }).observe(this.element);
  }

  get #lines() { return this.#spec.coils ? coil_names().length : 1; }

  draw(samples, last, now_s, span_s, period_s) {
    this.#show_values(last);
    if (!this.#in_sight || !globalThis.Chart) return;
    this.#chart ??= new Chart(this.#canvas, chart_of(this.#spec, this.#lines));
    const { data, options } = this.#chart;
    data.datasets.forEach((set, line) => {
      set.data = decimated(samples, now_s, span_s, sample => this.#value(sample, line));
      set.spanGaps = Math.max(3 * period_s, 2.5 * span_s / kBuckets);
    });
    options.scales.x.min = -span_s;
    options.scales.x.ticks.stepSize = span_s > 300 ? 120 : span_s > 60 ? 60 : 15;
    this.#chart.update('none');
  }

  recolour() {
    this.#chart?.destroy();
    this.#chart = null;
    this.#values.replaceChildren();
  }

  #value(sample, line) {
    const value = this.#spec.coils ? sample[this.#spec.of]?.[line] : sample[this.#spec.of];
    return value === null || value === undefined ? null : value * (this.#spec.factor ?? 1);
  }

  #show_values(last) {
    const texts = Array.from({ length: this.#lines }, (_, line) => number(last ? this.#value(last, line) : null, this.#spec.digits));
    if (!this.#values.children.length) this.#values.append(...texts.map(() => make('span')));
    texts.forEach((text, line) => set_text(this.#values.children[line], text));
    if (this.#spec.coils && !this.#chart) coil_colours().forEach((colour, coil) => { this.#values.children[coil].style.borderColor = colour; });
  }
}

function chart_of(spec, lines) {
  const colours = spec.coils ? coil_colours() : [palette('--accent')];
  const soft = palette('--soft'), grid = palette('--grid');
  const font = { family: palette('--sans'), size: 11 };
  const set = (_, line) => ({ data: [], borderColor: colours[line], borderWidth: 1.4, pointRadius: 0, tension: 0 });
  const x = { type: 'linear', max: 0, grid: { color: grid, tickLength: 3 }, ticks: { color: soft, font, maxRotation: 0, callback: time_label } };
  const y = {
    beginAtZero: !spec.free, suggestedMax: spec.span, grace: spec.free ? '10%' : 0, grid: { color: grid, tickLength: 3 },
    ticks: { color: soft, font, maxTicksLimit: 4 }, afterFit: scale => { scale.width = kAxis_px; },
  };
  return {
    type: 'line',
    data: { datasets: Array.from({ length: lines }, set) },
    options: {
      animation: false, responsive: true, maintainAspectRatio: false, parsing: false, normalized: true, events: [],
      scales: { x, y }, plugins: { legend: { display: false }, tooltip: { enabled: false } },
    },
  };
}

const time_label = seconds => seconds === 0 ? 'now' : seconds % 60 === 0 ? `${seconds / 60} min`.replace('-', '−') : `${seconds} s`.replace('-', '−');

function first_after(samples, time_s) {
  let low = 0, high = samples.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (samples[middle].time_s < time_s) low = middle + 1; else high = middle;
  }
  return low;
}

/// The least and the greatest of each stretch of time, so that no spike is lost. Stretches are of absolute time: they stay as the
/// strip moves on.
function decimated(samples, now_s, span_s, value_of) {
  const width_s = span_s / kBuckets, points = [];
  let bucket = null;
  const flush = () => {
    if (!bucket) return;
    const pair = bucket.least.x <= bucket.most.x ? [bucket.least, bucket.most] : [bucket.most, bucket.least];
    points.push(...(pair[0] === pair[1] ? [pair[0]] : pair));
  };
  for (const sample of samples) {
    const y = value_of(sample);
    if (y === null) continue;
    const index = Math.floor(sample.time_s / width_s), point = { x: sample.time_s - now_s, y };
    if (bucket?.index !== index) {
      flush();
      bucket = { index, least: point, most: point };
    }
    if (y < bucket.least.y) bucket.least = point;
    if (y > bucket.most.y) bucket.most = point;
  }
  flush();
  return points;
}
