// Jobs that are started from here: their buttons, how far the one that runs is, and what it asks.

import { by_id, make, set_text } from './dom.js';
import { capital, number } from './format.js';

const kFirst_run = 'rig check';

export function start_jobs(connection) {
  connection.on('hello', ({ jobs }) => show_buttons(connection, jobs));
  connection.on('state', state => {
    show_job(state.job);
    show_question(state);
    for (const button of by_id('jobs').querySelectorAll('button')) button.disabled = !!state.job?.running || state.mode === 'running';
  });
  connection.on('closed', () => show_job(null));
  by_id('job-end').addEventListener('click', () => connection.send({ do: 'job', verb: null }));
  by_id('question-yes').addEventListener('click', () => connection.send({ do: 'answer', yes: true }));
  by_id('question-no').addEventListener('click', () => connection.send({ do: 'answer', yes: false }));
}

function show_buttons(connection, jobs) {
  const buttons = jobs.map(verb => {
    const button = make('button', { type: 'button', textContent: capital(verb) });
    button.dataset.job = verb;
    button.addEventListener('click', () => connection.send({ do: 'job', verb }));
    return button;
  });
  const help = make('p', { className: 'soft', textContent: jobs.includes(kFirst_run) ? 'New at this bench? Rig check walks through its wiring, coil by coil.' : '' });
  by_id('jobs').replaceChildren(...buttons, help);
  if (!jobs.length) set_text(help, 'This rig has no jobs.');
}

function show_job(job) {
  by_id('job').hidden = !job;
  if (!job) return;
  set_text(by_id('job-verb'), capital(job.verb));
  set_text(by_id('job-count'), job.total ? `${number(job.done)} of ${number(job.total)}` : '');
  show_bar(by_id('job-bar'), job.done, job.total);
  set_text(by_id('job-note'), job.note ?? '');
  show_text(by_id('job-text'), job.text ?? '');
  by_id('job-end').disabled = !job.running;
}

/// What was said last is in sight.
function show_text(element, text) {
  element.hidden = !text;
  if (element.textContent === text) return;
  element.textContent = text;
  element.scrollTop = element.scrollHeight;
}

/// Also for the list of runs.
export function show_bar(bar, done, total) {
  const percent = total > 0 ? Math.min(100, 100 * done / total) : 0;
  bar.hidden = !(total > 0);
  bar.firstElementChild.style.width = `${percent.toFixed(1)}%`;
  bar.setAttribute('aria-valuenow', percent.toFixed(0));
}

/// Everybody sees the question; the operator answers.
function show_question(state) {
  by_id('question').hidden = !state.question;
  if (!state.question) return;
  set_text(by_id('question-text'), String(state.question));
  by_id('question-yes').disabled = by_id('question-no').disabled = !state.you_operate;
}
