// Trainings and benches with their progress and reports, and the recordings. Asked for only while the panel is open.

import { by_id, make, set_text } from './dom.js';
import { clock, duration, number } from './format.js';
import { show_bar } from './jobs.js';

const kEvery_ms = 5000;

/// `leave(url)` opens a report; see leave.js.
export function start_runs(connection, leave) {
  const panel = by_id('runs-panel');
  const ask = () => { if (panel.open && !document.hidden) connection.send({ do: 'runs' }); };
  const runs = new Rows(by_id('runs'), 'No trainings or benches yet', () => add_run(leave), show_run);
  const recordings = new Rows(by_id('recordings'), 'No recordings yet', () => add_recording(connection), show_recording);
  connection.on('runs', message => {
    runs.show(message.runs);
    recordings.show(message.recordings);
  });
  panel.addEventListener('toggle', ask);
  setInterval(ask, kEvery_ms);
}

/// A list whose rows stay while their text changes, so that the focus stays, too.
class Rows {
  #rows = new Map();

  constructor(list, none, add, show) {
    Object.assign(this, { list, none, add, show_one: show });
  }

  show(items) {
    const names = new Set(items.map(item => item.name));
    for (const [name, row] of this.#rows) {
      if (names.has(name)) continue;
      row.element.remove();
      this.#rows.delete(name);
    }
    this.list.querySelector('.none')?.remove();
    items.forEach((item, index) => this.#show_at(item, index));
    if (!items.length) this.list.append(make('li', { className: 'none soft', textContent: this.none }));
  }

  #show_at(item, index) {
    if (!this.#rows.has(item.name)) this.#rows.set(item.name, this.add());
    const row = this.#rows.get(item.name);
    row.item = item;
    this.show_one(row, item);
    if (this.list.children[index] !== row.element) this.list.insertBefore(row.element, this.list.children[index] ?? null);
  }
}

function add_run(leave) {
  const row = { name: make('b'), state: make('span', { className: 'tag' }), progress: make('span', { className: 'soft' }),
                bar: make('div', { className: 'bar' }, make('span')), report: make('a', { textContent: 'Report', target: '_blank', rel: 'noopener' }) };
  row.bar.setAttribute('role', 'progressbar');
  row.report.addEventListener('click', event => leave(event, row.report.href));
  row.element = make('li', { className: 'run' }, row.name, row.state, row.progress, row.report, row.bar);
  return row;
}

function show_run(row, run) {
  set_text(row.name, run.name);
  set_text(row.state, run.state);
  row.state.dataset.state = run.state;
  const progress = run.total ? `${number(run.done)} of ${number(run.total)} ${run.unit ?? ''}` : '';
  set_text(row.progress, [run.verb, progress.trim(), run.note, run.updated_utc && `at ${clock(run.updated_utc)}`].filter(Boolean).join(' · '));
  show_bar(row.bar, run.done, run.state === 'running' ? run.total : 0);
  row.bar.setAttribute('aria-label', `Progress of ${run.name}`);
  row.report.hidden = !is_local(run.report);
  if (is_local(run.report)) row.report.href = run.report;
  row.report.setAttribute('aria-label', `Report of ${run.name}`);
}

const is_local = path => typeof path === 'string' && /^\/[^/\\]/.test(path);

function add_recording(connection) {
  const row = { name: make('b'), length: make('span', { className: 'soft' }), replay: make('button', { type: 'button', textContent: 'Replay' }) };
  row.replay.addEventListener('click', () => connection.send({ do: 'replay', name: row.item.name }));
  row.element = make('li', { className: 'recording' }, row.name, row.length, row.replay);
  return row;
}

function show_recording(row, recording) {
  set_text(row.name, recording.name);
  set_text(row.length, duration(recording.seconds));
  row.replay.setAttribute('aria-label', `Replay ${recording.name}`);
}
