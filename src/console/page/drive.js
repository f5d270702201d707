// What drives and along what: controller, given paths, follow, end, unattended, recording.

import { by_id, enter_toggles, make, set_text } from './dom.js';
import { capital, duration, number } from './format.js';
import { toast } from './toast.js';

const kHand = 'hand';
const kLongest_csv = 60000;  // a message holds 64 kB

export class Drive {
  #connection;
  #dialog;
  #view;
  #plan = null;

  constructor(connection, dialog, view) {
    this.#connection = connection;
    this.#dialog = dialog;
    this.#view = view;
    connection.on('hello', hello => this.#show_hello(hello));
    connection.on('state', state => this.#show_state(state));
    connection.on('plan', plan => this.#show_plan(plan));
    connection.on('answer', answer => { if (!answer.ok) toast(answer.text || `Refused: ${answer.to}`, true); });
    this.#listen();
  }

  #listen() {
    const send = message => this.#connection.send(message);
    by_id('controller').addEventListener('change', event => send({ do: 'controller', name: event.target.value }));
    by_id('follow').addEventListener('click', () => send({ do: 'follow' }));
    by_id('end').addEventListener('click', () => send({ do: 'end' }));
    by_id('place').addEventListener('click', () => send({ do: 'place' }));
    by_id('record').addEventListener('click', () => send({ do: 'record', on: !this.#connection.state?.recording }));
    for (const button of document.querySelectorAll('[data-shape]')) {
      button.addEventListener('click', () => this.#draw_shape(button.dataset.shape));
    }
    by_id('csv').addEventListener('change', event => this.#send_csv(event.target));
    by_id('unattended').addEventListener('change', event => this.#choose_unattended(event.target));
    enter_toggles(by_id('unattended'));
  }

  #show_hello({ controllers, rig, shapes }) {
    const option = name => make('option', { value: name, textContent: name === kHand ? 'By hand' : capital(name) });
    const names = [...controllers.filter(name => name !== kHand), kHand];
    by_id('controller').replaceChildren(...names.map(option));
    by_id('controller').size = Math.max(2, names.length);
    set_text(by_id('place'), ['serial', 'driver'].includes(rig.kind) ? 'Needle was moved' : 'Put needle to centre');
    for (const button of document.querySelectorAll('[data-shape]')) button.hidden = !shapes.includes(button.dataset.shape);
    this.#forget_plan();
  }

  #show_state(state) {
    const by_hand = state.controller === kHand;
    const running = state.mode === 'running';
    by_id('hand').hidden = !by_hand;
    by_id('aiming').hidden = by_id('plan').hidden = by_id('follow').hidden = by_hand;
    this.#show_choices(state);
    by_id('end').disabled = !running;
    by_id('place').disabled = running;
    by_id('shape-centre').disabled = !['armed', 'running'].includes(state.mode);  // it is driven to at once
    this.#show_follow(state);
  }

  /// Whoever takes over can follow what was planned before.
  #show_follow(state) {
    const planned = this.#plan ? this.#plan.ok : (state.plan?.length ?? 0) > 1;
    if (!this.#plan) set_text(by_id('plan'), planned ? 'A path is planned' : 'No path planned');
    by_id('follow').disabled = !(planned && ['armed', 'running'].includes(state.mode));
    by_id('follow').title = planned && state.mode === 'disarmed' ? 'Arm first' : '';
  }

  #show_choices(state) {
    const select = by_id('controller');
    if (select.value !== state.controller) select.value = state.controller;
    if (!this.#dialog.open) by_id('unattended').checked = state.unattended;
    by_id('unattended-label').dataset.on = String(state.unattended);
    by_id('record').setAttribute('aria-pressed', String(state.recording));
    set_text(by_id('record'), state.recording ? 'End recording' : 'Record');
  }

  /// A good plan comes with every state from now on; a refused one is only in this answer.
  #show_plan(plan) {
    this.#plan = plan;
    this.#view.refused = plan.ok ? null : plan;
    this.#view.redraw();
    const element = by_id('plan');
    element.dataset.bad = String(!plan.ok);
    const size = `${number(plan.length_mm)} mm, ${duration(plan.seconds)}`;
    set_text(element, plan.ok ? [`Planned: ${size}`, plan.text].filter(Boolean).join('. ') : plan.text || 'This path cannot be followed');
  }

  #forget_plan() {
    this.#plan = this.#view.refused = null;
    by_id('plan').dataset.bad = 'false';
  }

  #draw_shape(shape) {
    this.#forget_plan();
    this.#connection.send({ do: 'draw', shape });
  }

  async #send_csv(input) {
    const [file] = input.files;
    input.value = '';
    if (!file) return;
    if (file.size > kLongest_csv) return toast(`${file.name} is too long: ${number(file.size / 1000)} kB of at most ${kLongest_csv / 1000} kB`, true);
    this.#connection.send({ do: 'draw', csv: await file.text() });
  }

  async #choose_unattended(box) {
    if (!box.checked) return this.#connection.send({ do: 'unattended', on: false });
    const yes = await this.#dialog.ask({
      title: 'Run unattended?',
      lines: ['The next run goes on without this page, under the supervisor alone, and ends with its task.', 'Closing or hiding the page will not stop it.'],
      yes: 'Unattended', no: 'Stay attended',
      stale: state => !state.you_operate || state.mode === 'stopped',
    });
    if (yes) this.#connection.send({ do: 'unattended', on: true });
    else box.checked = false;
  }
}
