// Pointing in the image with mouse, finger or keys: a target with its heading, or a path.

import { by_id, set_text } from './dom.js';
import { kStopped } from './stop.js';

const kHeading_px = 14;    // a shorter drag gives no heading
const kSpacing_px = 3;     // between the points of a path
const kClose_px = 18;      // a path that ends this near to its beginning is closed
const kMost_points = 2000;
const kStep = 0.01, kBig_step = 0.05;  // of the image, for the arrow keys
const kArrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export class Aim {
  tool = 'target';
  #connection;
  #view;
  #from = null;

  constructor(connection, view) {
    this.#connection = connection;
    this.#view = view;
    this.#listen(view.canvas);
    for (const tool of ['target', 'path']) by_id(`tool-${tool}`).addEventListener('click', () => this.#take(tool));
    document.addEventListener(kStopped, () => this.#clear());
    connection.on('state', () => this.#show_hint());
    connection.on('closed', () => this.#clear());
  }

  get #drives() { return ['armed', 'running'].includes(this.#connection.mode) && this.#connection.state.controller !== 'hand'; }
  get #may_point() { return this.#connection.operating && (this.tool === 'path' || this.#drives); }

  #listen(canvas) {
    canvas.addEventListener('pointerdown', event => this.#begin(event));
    canvas.addEventListener('pointermove', event => this.#move(event));
    canvas.addEventListener('pointerup', event => this.#end(event));
    canvas.addEventListener('pointercancel', () => this.#clear());
    canvas.addEventListener('keydown', event => this.#key(event));
    canvas.addEventListener('blur', () => this.#clear());
  }

  #take(tool) {
    this.tool = tool;
    for (const each of ['target', 'path']) by_id(`tool-${each}`).setAttribute('aria-pressed', String(each === tool));
    this.#clear();
    this.#show_hint();
  }

  #show_hint() {
    const { mode, operating } = this.#connection;
    const hint = this.tool === 'path' ? 'Draw in the image.'
      : !operating ? 'Who operates can drive to a target.'
      : this.#drives ? 'Click in the image; drag to give a heading.'
      : mode === 'disarmed' ? 'Arm to drive to a target.' : 'No target can be taken now.';
    set_text(by_id('hint'), hint);
  }

  #clear() {
    this.#from = null;
    this.#draft(null);
  }

  #draft(draft) {
    this.#view.draft = draft;
    this.#view.redraw();
  }

  #place(event) {
    const box = this.#view.canvas.getBoundingClientRect();
    const part = (value, low, size) => Math.min(1, Math.max(0, (value - low) / size));
    return [round(part(event.clientX, box.left, box.width)), round(part(event.clientY, box.top, box.height))];
  }

  #distance_px(a, b) {
    const { clientWidth, clientHeight } = this.#view.canvas;
    return Math.hypot((a[0] - b[0]) * clientWidth, (a[1] - b[1]) * clientHeight);
  }

  #begin(event) {
    if (!event.isPrimary || event.button !== 0 || !this.#may_point) return;
    this.#view.canvas.setPointerCapture(event.pointerId);
    this.#from = this.#place(event);
    this.#draft(this.tool === 'path' ? { kind: 'path', points: [this.#from] } : { kind: 'target', to: this.#from });
  }

  #move(event) {
    if (!this.#from || !event.isPrimary) return;
    if (this.tool === 'path') this.#add_points(event);
    else this.#turn(this.#place(event));
    this.#view.redraw();
  }

  /// All places between two frames, so that a quick hand draws no corners.
  #add_points(event) {
    const { points } = this.#view.draft;
    for (const each of event.getCoalescedEvents?.() ?? [event]) {
      const place = this.#place(each);
      if (this.#distance_px(place, points.at(-1)) >= kSpacing_px) points.push(place);
    }
  }

  #turn(place) {
    const { draft } = this.#view;
    if (this.#distance_px(place, this.#from) >= kHeading_px) draft.towards = place;
    else delete draft.towards;
  }

  #end(event) {
    if (!this.#from || !event.isPrimary) return;
    const { draft } = this.#view;
    this.#clear();
    if (draft.kind === 'path') this.#send_path(draft.points);
    else this.#send_target(draft);
  }

  #send_target({ to, towards }) {
    this.#view.refused = null;
    this.#connection.send(towards ? { do: 'go', to, towards } : { do: 'go', to });
  }

  #send_path(points) {
    if (points.length < 2) return;
    const closed = points.length > 8 && this.#distance_px(points[0], points.at(-1)) < kClose_px;
    this.#connection.send({ do: 'draw', points: thinned(points), closed });
  }

  /// Keys move a cross, Enter drives there.
  #key(event) {
    if (this.tool !== 'target' || !this.#may_point) return;
    const cross = this.#view.draft?.kind === 'cross' ? this.#view.draft.to : this.#connection.state.target ?? [0.5, 0.5];
    if (event.key in kArrows) {
      const step = event.shiftKey ? kBig_step : kStep;
      this.#draft({ kind: 'cross', to: cross.map((value, axis) => round(Math.min(1, Math.max(0, value + step * kArrows[event.key][axis])))) });
      event.preventDefault();
    } else if (event.key === 'Enter' && this.#view.draft?.kind === 'cross') {
      this.#clear();
      this.#send_target({ to: cross });
    }
  }
}

const round = value => Math.round(value * 1e4) / 1e4;

function thinned(points) {
  if (points.length <= kMost_points) return points;
  const step = (points.length - 1) / (kMost_points - 1);
  return Array.from({ length: kMost_points }, (_, index) => points[Math.round(index * step)]);
}
