// The camera's image, and over it a second canvas with what is known: drawn only when something new has come.

import { by_id, fit_canvas, set_text } from './dom.js';
import { number } from './format.js';
import { draw_overlay } from './overlay.js';

const kStale_s = 1.5;

export class View {
  /// What the operator is pointing at; see aim.js.
  draft = null;
  /// A path that was refused, with its bad points; see drive.js.
  refused = null;
  #connection;
  #canvas = by_id('view');
  #image = by_id('image').getContext('bitmaprenderer');
  #drawing = false;
  #last = null;
  #rate_Hz = 0;
  #aspect = 0;

  constructor(connection) {
    this.#connection = connection;
    connection.on('hello', hello => this.#shape(hello.image));
    connection.on('image', image => this.#show(image));
    connection.on('state', state => this.#show_state(state));
    connection.on('closed', () => this.#forget());
    new ResizeObserver(() => this.redraw()).observe(this.#canvas);
  }

  get canvas() { return this.#canvas; }

  /// Once in the next frame, however often it is asked for.
  redraw() {
    if (this.#drawing) return;
    this.#drawing = true;
    requestAnimationFrame(() => {
      this.#drawing = false;
      const { context, width, height } = fit_canvas(this.#canvas);
      draw_overlay(context, width, height, { hello: this.#connection.hello, state: this.#connection.state, draft: this.draft, refused: this.refused });
    });
  }

  #shape(image) {
    const aspect = image.width_px / image.height_px;
    if (aspect === this.#aspect) return;
    this.#aspect = aspect;
    by_id('stage').style.setProperty('--aspect', String(aspect));
  }

  /// The last image stays, grey; nothing is known of the needle any more.
  #forget() {
    this.#last = null;
    this.#rate_Hz = 0;
    this.#show_pose(null);
    set_text(by_id('picture'), '');
    this.redraw();
  }

  /// The bitmap goes to the screen as it is, without a copy.
  #show(image) {
    by_id('no-image').hidden = true;
    if (this.#last) {
      const period_s = Math.max(1e-3, image.sent_s - this.#last.sent_s);
      this.#rate_Hz += (this.#rate_Hz ? 0.1 : 1) * (1 / period_s - this.#rate_Hz);
    }
    this.#last = { taken_s: image.taken_s, sent_s: image.sent_s };
    this.#shape(this.#connection.hello.image);
    this.#image.transferFromImageBitmap(image.bitmap);
  }

  #show_state(state) {
    this.#show_pose(state.pose);
    this.#show_picture(state.time_s);
    this.redraw();
  }

  #show_pose(pose) {
    const element = by_id('pose');
    element.dataset.valid = String(!!pose?.valid);
    if (!pose?.valid) return set_text(element, `No pose${pose?.why ? `: ${pose.why}` : ''}`);
    const heading = pose.heading_deg === undefined ? '' : `   heading ${number(pose.heading_deg)}°`;  // a sphere has none
    set_text(element, `x ${number(pose.x_mm, 1)} mm   y ${number(pose.y_mm, 1)} mm${heading}`);
    element.title = `± ${number(pose.sigma_mm, 2)} mm, ${number(pose.age_s * 1e3)} ms old`;
  }

  #show_picture(time_s) {
    const element = by_id('picture');
    const age_s = this.#last ? time_s - this.#last.taken_s : null;
    const stale = age_s !== null && age_s > kStale_s;
    element.dataset.stale = String(stale);
    if (age_s === null) set_text(element, 'No image yet');
    else if (stale) set_text(element, `The image is ${number(age_s, 1)} s old`);
    else set_text(element, `${number(this.#rate_Hz)} images/s, ${number(Math.max(0, this.#last.sent_s - this.#last.taken_s) * 1e3)} ms from camera to console`);
  }
}
