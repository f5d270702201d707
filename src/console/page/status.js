// The band at the top: what state the rig is in and why, arming, who operates, who asks to.

import { by_id, set_text } from './dom.js';
import { capital, duration, number } from './format.js';

const kModes = {
  offline: 'No connection to the console', disconnected: 'Disconnected', disarmed: 'Disarmed', armed: 'Armed',
  running: 'Running', stopped: 'Stopped',
};
const kArm = { disarmed: 'Arm', armed: 'Disarm', running: 'Disarm', stopped: 'Re-arm' };
const kKinds = { virtual: 'virtual', emulated: 'emulated controller', serial: 'serial', driver: 'driver' };

export function start_status(connection, dialog) {
  connection.on('hello', show_rig);
  connection.on('state', state => show_state(connection, state));
  connection.on('closed', () => show_offline(connection));
  start_arming(connection, dialog);
  start_seat(connection);
}

function show_rig(hello) {
  const kind = kKinds[hello.rig.kind] ?? hello.rig.kind;
  const name = hello.rig.name.includes(hello.rig.kind) ? hello.rig.name : `${hello.rig.name} (${kind})`;
  set_text(by_id('rig'), name);
  by_id('rig').title = `Lodestone ${hello.version}`;
}

function show_mode(mode, reason, progress) {
  document.body.dataset.mode = by_id('mode').dataset.mode = mode;
  set_text(by_id('mode'), kModes[mode] ?? capital(mode));
  set_text(by_id('reason'), reason);
  set_text(by_id('progress'), progress);
}

function show_state(connection, state) {
  document.body.dataset.connected = 'true';
  document.body.dataset.operating = String(state.you_operate);
  show_mode(state.mode, reason_of(state), progress_of(state));
  show_arm(state);
  show_operator(connection, state);
  show_asking(connection, state);
  by_id('unattended-run').hidden = !(state.mode === 'running' && !state.attended);
  for (const fieldset of document.querySelectorAll('fieldset.seat')) fieldset.disabled = !state.you_operate;
}

function show_offline(connection) {
  document.body.dataset.connected = 'false';
  document.body.dataset.operating = 'false';
  show_mode('offline', connection.bye || 'Trying again every second. What you see is old.', '');
  set_text(by_id('why'), '');
  set_text(by_id('operator'), '');
  by_id('arm').disabled = by_id('operate').disabled = true;
  by_id('takeover').hidden = by_id('question').hidden = by_id('unattended-run').hidden = true;
  for (const fieldset of document.querySelectorAll('fieldset.seat')) fieldset.disabled = true;
}

function reason_of(state) {
  if (state.reason) return state.reason;
  if (state.mode === 'disarmed') return 'The coils take no pulses';
  if (state.mode === 'armed') return state.controller === 'hand' ? 'Ready to be driven by hand' : 'Ready for a target or a path';
  return '';
}

/// Beside the mode, not in the region that is read out: it changes with every step.
function progress_of({ mode, run, controller }) {
  if (mode !== 'running' || !run) return '';
  const left = run.left_s === null || run.left_s === undefined ? '' : `, ${duration(run.left_s)} left`;
  const what = controller === 'hand' ? 'By hand' : `${capital(run.task)} by ${controller}`;
  return `${what}: ${duration(run.time_s)}${left}, ${number(run.steps)} steps`;
}

function show_arm(state) {
  const button = by_id('arm');
  const blocked = state.mode === 'stopped' ? state.why_not ?? '' : '';
  set_text(button, kArm[state.mode] ?? 'Arm');
  set_text(by_id('why'), blocked && `Cannot re-arm yet: ${blocked}`);
  button.disabled = !state.you_operate || !!blocked || !['disarmed', 'armed', 'stopped'].includes(state.mode);
  button.title = blocked || (state.mode === 'running' ? 'End the run first' : '');
}

function start_arming(connection, dialog) {
  by_id('arm').addEventListener('click', async () => {
    const { mode } = connection;
    if (mode === 'disarmed') connection.send({ do: 'arm' });
    if (mode === 'armed') connection.send({ do: 'disarm' });
    if (mode === 'stopped') await rearm(connection, dialog);
  });
}

/// What was shown is what is confirmed: a question about another reason is taken back.
async function rearm(connection, dialog) {
  const { reason, clears } = connection.state;
  const yes = await dialog.ask({
    title: 'Re-arm the coils?',
    lines: [`Stopped: ${reason}`, clears && 'Faults that the coil controller has latched are cleared, too.', 'The coils then take pulses again.'],
    yes: 'Re-arm', no: 'Stay stopped',
    stale: state => state.mode !== 'stopped' || state.reason !== reason || state.clears !== clears || !state.you_operate,
    blocked: state => state.why_not ? `Not yet: ${state.why_not}` : '',
  });
  if (yes) connection.send({ do: 'rearm', reason, clears });
}

function start_seat(connection) {
  by_id('operate').addEventListener('click', () => connection.send({ do: connection.operating ? 'yield' : 'operate' }));
  by_id('takeover-give').addEventListener('click', () => connection.send({ do: 'yield' }));
  by_id('takeover-keep').addEventListener('click', () => connection.send({ do: 'refuse' }));
  ask_for_empty_seat(connection);
}

/// Once for each load of the page: whoever opens the first one means to operate.
function ask_for_empty_seat(connection) {
  let asked = false;
  connection.on('state', state => {
    if (asked) return;
    asked = true;
    if (state.operator === null && !state.you_operate) connection.send({ do: 'operate' });
  });
}

const absent = value => value === null || value === undefined;

function show_operator(connection, state) {
  const me = connection.hello?.you;
  const who = state.you_operate ? 'You operate' : absent(state.operator) ? 'Nobody operates' : `Page ${state.operator} operates, you watch`;
  const viewers = state.viewers === 1 ? '1 page open' : `${state.viewers} pages open`;
  set_text(by_id('operator'), `${who} · ${viewers}`);
  const waiting = !absent(state.asking) && state.asking === me;
  const button = by_id('operate');
  set_text(button, state.you_operate ? 'Leave the seat' : waiting ? `Asked, ${number(state.asking_left_s)} s` : 'Operate');
  button.disabled = waiting;
}

function show_asking(connection, state) {
  const asked = state.you_operate && !absent(state.asking);
  by_id('takeover').hidden = !asked;
  if (!asked) return;
  set_text(by_id('takeover-text'), `Page ${state.asking} asks to take over`);
  set_text(by_id('takeover-keep'), `Keep (${Math.ceil(state.asking_left_s)} s)`);
}
