// A recording: its video and its trajectory, moved together by one slider.

import { by_id, fit_canvas, palette, set_text } from './dom.js';
import { duration, number } from './format.js';

const kMargin = 1.08;  // of the dish's radius

export class Replay {
  #connection;
  #video = by_id('replay-video');
  #slider = by_id('replay-slider');
  #play = by_id('replay-play');
  #samples = [];

  constructor(connection) {
    this.#connection = connection;
    connection.on('replay', message => this.#open(message));
    by_id('replay-close').addEventListener('click', () => this.#close());
    this.#play.addEventListener('click', () => this.#video.paused ? this.#video.play().catch(() => {}) : this.#video.pause());
    this.#slider.addEventListener('input', () => this.#seek(Number(this.#slider.value)));
    for (const change of ['play', 'pause', 'ended']) this.#video.addEventListener(change, () => this.#show_playing());
    this.#video.addEventListener('loadedmetadata', () => this.#size());
    document.addEventListener('visibilitychange', () => { if (document.hidden) this.#video.pause(); });
    new ResizeObserver(() => this.#draw()).observe(by_id('replay-path'));
  }

  #open({ name, video, samples }) {
    this.#samples = samples;
    by_id('replay').hidden = false;
    set_text(by_id('replay-name'), name);
    this.#show_film(video);
    this.#slider.value = '0';
    this.#size();
    this.#draw();
    by_id('replay').scrollIntoView({ block: 'nearest' });
    by_id('replay-title').focus();
  }

  /// A recording without a camera has a trajectory only.
  #show_film(video) {
    this.#video.hidden = this.#play.disabled = !video;
    if (video) this.#video.src = video;
    else this.#video.removeAttribute('src');
    this.#video.load();
  }

  #close() {
    this.#video.pause();
    this.#show_film(null);
    this.#samples = [];
    by_id('replay').hidden = true;
  }

  get #time_s() { return Number(this.#slider.value); }

  #size() {
    const of_samples_s = this.#samples.length ? this.#samples.at(-1).time_s - this.#samples[0].time_s : 0;
    const of_video_s = Number.isFinite(this.#video.duration) ? this.#video.duration : 0;
    this.#slider.max = String(Math.max(of_samples_s, of_video_s, 0.01));
    this.#draw();
  }

  #seek(time_s) {
    this.#video.pause();
    if (Number.isFinite(this.#video.duration)) this.#video.currentTime = Math.min(time_s, this.#video.duration);
    this.#draw();
  }

  #show_playing() {
    set_text(this.#play, this.#video.paused ? 'Play' : 'Pause');
    if (!this.#video.paused) this.#follow_video();
  }

  #follow_video() {
    if (this.#video.paused) return;
    this.#slider.value = String(this.#video.currentTime);
    this.#draw();
    requestAnimationFrame(() => this.#follow_video());
  }

  /// How many samples lie before the slider's time; the last of them is shown.
  #count() {
    const until_s = (this.#samples[0]?.time_s ?? 0) + this.#time_s + 1e-6;
    const after = this.#samples.findIndex(sample => sample.time_s > until_s);
    return after < 0 ? this.#samples.length : after;
  }

  #draw() {
    if (by_id('replay').hidden) return;
    const count = this.#count(), sample = this.#samples[count - 1];
    set_text(by_id('replay-time'), `${duration(this.#time_s)} of ${duration(Number(this.#slider.max))}`);
    set_text(by_id('replay-sample'), sample ? `x ${number(sample.x_mm, 1)} mm   y ${number(sample.y_mm, 1)} mm${Number.isFinite(sample.heading_deg) ? `   heading ${number(sample.heading_deg)}°` : ''}   error ${number(sample.error_mm, 2)} mm` : '');
    this.#draw_trajectory(count, sample);
  }

  #draw_trajectory(count, sample) {
    const { context, width, height } = fit_canvas(by_id('replay-path'));
    const radius_mm = this.#connection.hello?.dish_radius_mm ?? 34;
    const scale = Math.min(width, height) / (2 * kMargin * radius_mm);
    const at = (x_mm, y_mm) => [width / 2 + x_mm * scale, height / 2 - y_mm * scale];
    context.lineJoin = 'round';
    stroke(context, palette('--strong-line'), 1.2, () => context.arc(...at(0, 0), radius_mm * scale, 0, 2 * Math.PI));
    this.#draw_path(context, at, this.#samples, palette('--strong-line'), 1.2);
    this.#draw_path(context, at, this.#samples.slice(0, count), palette('--accent'), 2);
    if (sample?.target_mm) draw_cross(context, at(...sample.target_mm), palette('--good'));
    if (sample && Number.isFinite(sample.x_mm)) draw_needle(context, at(sample.x_mm, sample.y_mm), sample.heading_deg, palette('--bad'));
  }

  #draw_path(context, at, samples, colour, width) {
    stroke(context, colour, width, () => {
      for (const { x_mm, y_mm } of samples) if (Number.isFinite(x_mm) && Number.isFinite(y_mm)) context.lineTo(...at(x_mm, y_mm));
    });
  }
}

function stroke(context, colour, width, path) {
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.beginPath();
  path();
  context.stroke();
}

function draw_cross(context, [x, y], colour) {
  stroke(context, colour, 2, () => {
    context.moveTo(x - 7, y); context.lineTo(x + 7, y);
    context.moveTo(x, y - 7); context.lineTo(x, y + 7);
  });
}

/// From tail to head, with a point at the head; of a sphere, which has no heading, the point alone.
function draw_needle(context, [x, y], heading_deg, colour) {
  const half = Number.isFinite(heading_deg) ? 11 : 0, angle = -(heading_deg ?? 0) * Math.PI / 180;
  const dx = half * Math.cos(angle), dy = half * Math.sin(angle);
  stroke(context, colour, 3, () => { context.moveTo(x - dx, y - dy); context.lineTo(x + dx, y + dy); });
  context.fillStyle = colour;
  context.beginPath();
  context.arc(x + dx, y + dy, 4, 0, 2 * Math.PI);
  context.fill();
}
