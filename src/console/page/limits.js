// How near each safety limit is.

import { by_id, make, set_text } from './dom.js';
import { number } from './format.js';

const kBetween_ms = 250;
const kNear = 0.9, kWarm = 0.75;

export function start_limits(connection) {
  const rows = new Map();
  let shown_ms = 0;
  connection.on('hello', () => rows.clear());
  connection.on('state', ({ limits }) => {
    if (!limits?.length || performance.now() - shown_ms < kBetween_ms) return;
    shown_ms = performance.now();
    if (!rows.size) by_id('limits').replaceChildren();
    for (const limit of limits) {
      if (!rows.has(limit.name)) rows.set(limit.name, add_row(limit.name));
      show(rows.get(limit.name), limit);
    }
  });
}

function add_row(name) {
  const row = { filled: make('span'), value: make('span', { className: 'value' }) };
  row.bar = make('div', { className: 'bar' }, row.filled);
  row.bar.setAttribute('role', 'meter');
  row.bar.setAttribute('aria-label', name);
  row.bar.setAttribute('aria-valuemin', '0');
  by_id('limits').append(make('div', { className: 'limit' }, make('span', { textContent: name }), row.value, row.bar));
  return row;
}

function show({ bar, filled, value }, limit) {
  const known = Number.isFinite(limit.value) && Number.isFinite(limit.bound) && limit.bound !== 0;
  const part = known ? Math.min(1, Math.max(0, limit.value / limit.bound)) : 0;
  const digits = Math.abs(limit.bound) < 10 ? 2 : Math.abs(limit.bound) < 100 ? 1 : 0;
  const unit = limit.unit === 'C' ? '°C' : limit.unit;
  set_text(value, `${number(limit.value, digits)} of ${number(limit.bound, digits)} ${unit}`);
  filled.style.width = `${(100 * part).toFixed(1)}%`;
  bar.parentElement.dataset.near = part > kNear ? 'red' : part > kWarm ? 'warm' : 'no';
  bar.setAttribute('aria-valuemax', String(limit.bound));
  bar.setAttribute('aria-valuenow', String(limit.value));
  bar.setAttribute('aria-valuetext', value.textContent);
}
