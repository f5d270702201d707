// Driving by hand, with a dead man's grip: what is held drives, and letting go, looking away or a STOP ends it.

import { by_id, set_text } from './dom.js';
import { number } from './format.js';
import { kStopped } from './stop.js';

const kDead_zone = 0.18;
const kStop_button = 1;  // B, or circle, of a gamepad
const kKeys = {
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1],
  KeyA: [-1, 0], KeyD: [1, 0], KeyW: [0, -1], KeyS: [0, 1],
};

export class Hand {
  #connection;
  #dialog;
  #stop;
  #keys = new Set();
  #stick = null;          // [right, down] in -1 to 1 while it is held
  #pad = null;            // the same of the gamepad
  #pad_must_rest = true;  // after a release from outside, the gamepad counts again once it was in the middle
  #pad_stops = false;
  #held = false;

  constructor(connection, dialog, stop) {
    this.#connection = connection;
    this.#dialog = dialog;
    this.#stop = stop;
    this.#listen_to_keys();
    this.#listen_to_stick(by_id('stick'));
    this.#listen_for_release();
  }

  get #drives() {
    const { operating, mode, state } = this.#connection;
    return operating && state.controller === 'hand' && ['armed', 'running'].includes(mode) && !this.#dialog.open;
  }

  /// Called with every beat.
  beat() {
    this.#read_gamepad();
    this.#update();
    if (this.#held) this.#send();
  }

  release() {
    this.#keys.clear();
    this.#stick = this.#pad = null;
    this.#pad_must_rest = true;
    this.#update();
  }

  #listen_to_keys() {
    window.addEventListener('keydown', event => {
      if (!(event.code in kKeys) || !this.#drives || is_field(event.target) || has_modifier(event)) return;
      event.preventDefault();
      event.stopPropagation();
      if (event.repeat) return;  // a key held through a STOP does not drive again
      this.#keys.add(event.code);
      this.#update();
    }, true);
    window.addEventListener('keyup', event => {
      if (this.#keys.delete(event.code)) this.#update();
    }, true);
  }

  #listen_to_stick(stick) {
    const pull = event => {
      const box = stick.getBoundingClientRect();
      const radius = box.width / 2;
      this.#stick = within_circle([(event.clientX - box.left - radius) / radius, (event.clientY - box.top - radius) / radius]);
      this.#update();
    };
    const let_go = () => {
      this.#stick = null;
      this.#update();
    };
    stick.addEventListener('pointerdown', event => {
      if (!event.isPrimary || !this.#drives) return;
      stick.setPointerCapture(event.pointerId);
      pull(event);
    });
    stick.addEventListener('pointermove', event => { if (this.#stick && event.isPrimary) pull(event); });
    for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) stick.addEventListener(end, let_go);
  }

  #listen_for_release() {
    const release = () => this.release();
    window.addEventListener('blur', release);
    window.addEventListener('pagehide', release);
    document.addEventListener('visibilitychange', release);
    document.addEventListener(kStopped, release);
    this.#connection.on('closed', release);
    this.#connection.on('state', () => { if (this.#held && !this.#drives) release(); });
  }

  #read_gamepad() {
    const pad = [...navigator.getGamepads?.() ?? []].find(each => each?.connected);
    set_text(by_id('gamepad'), pad ? 'Gamepad found: its button B stops.' : '');
    if (!pad) return void (this.#pad = null);
    const stops = !!pad.buttons[kStop_button]?.pressed;
    if (stops && !this.#pad_stops) this.#stop('button');
    this.#pad_stops = stops;
    const axes = within_circle([pad.axes[0] ?? 0, pad.axes[1] ?? 0]);
    const rests = Math.hypot(...axes) < kDead_zone;
    if (!this.#drives) this.#pad_must_rest = true;  // deflected before it may drive: it rests first
    if (rests) this.#pad_must_rest = false;
    this.#pad = rests || this.#pad_must_rest || !document.hasFocus() ? null : axes;
  }

  /// What is held, as seen in the image: [right, down]; null where nothing is.
  #pull() {
    if (!this.#drives) return null;
    if (this.#stick) return this.#stick;
    if (this.#keys.size) return within_circle([...this.#keys].map(key => kKeys[key]).reduce(([x, y], [dx, dy]) => [x + dx, y + dy]));
    return this.#pad;
  }

  /// The beginning and the end go out at once, what is between with the beat.
  #update() {
    const pull = this.#pull();
    const was_held = this.#held;
    this.#held = pull !== null;
    this.#show(pull);
    if (this.#held && !was_held) this.#send();
    if (was_held && !this.#held) this.#connection.send({ do: 'hand', drive: [0, 0] });
  }

  #send() {
    this.#connection.send({ do: 'hand', drive: to_dish(this.#pull(), this.#connection) });
  }

  #show(pull) {
    const [right, down] = pull ?? [0, 0];
    const reach_px = by_id('stick').clientWidth * 0.32;
    by_id('knob').style.transform = `translate(${right * reach_px}px, ${down * reach_px}px)`;
    by_id('stick').dataset.held = String(pull !== null);
    const drive = pull && to_dish(pull, this.#connection);
    set_text(by_id('hand-drive'), drive ? `x ${number(drive[0], 2)}  y ${number(drive[1], 2)}` : '');
  }
}

/// From directions in the image to those of the dish, however the camera is turned.
function to_dish(pull, { hello, state }) {
  const [x, y] = state?.axes ?? [];
  const axis = (along, otherwise) => {
    if (!along || !hello) return otherwise;
    const right = along[0] * hello.image.width_px, down = along[1] * hello.image.height_px;
    const length = Math.hypot(right, down);
    return length > 0 ? [right / length, down / length] : otherwise;
  };
  const along = ([right, down]) => Math.round((pull[0] * right + pull[1] * down) * 1e3) / 1e3 || 0;
  return within_circle([along(axis(x, [1, 0])), along(axis(y, [0, -1]))]);
}

function within_circle([x, y]) {
  const length = Math.hypot(x, y);
  return length > 1 ? [x / length, y / length] : [x, y];
}

const is_field = target => target instanceof Element && !!target.closest('select, input, dialog');
const has_modifier = event => event.ctrlKey || event.altKey || event.metaKey;
