// What is drawn over the image. Places come as fractions of it; every line has a dark rim, to be seen on any ground.

import { coil_names, overlay_colours as colours } from './coils.js';
import { number } from './format.js';

const kOn = 0.01;  // of the largest current: above it a coil counts as on
const kLabel = '600 12px system-ui, "Liberation Sans", Arial, sans-serif';

/// `view`: hello, state, draft (what is being pointed at), refused (a plan with bad points); any may be null.
export function draw_overlay(context, width, height, { hello, state, draft, refused }) {
  const pen = new Pen(context, width, height);
  if (state) {
    pen.polygon(state.fence, colours.fence, 1.5, [7, 5]);
    for (const side of state.keep_out ?? []) pen.polygon(side, colours.keep_out, 1.5);
    for (const arrow of state.field ?? []) draw_field(pen, arrow);
    pen.line(state.trail, colours.trail, 1.8);
    pen.line(state.plan, colours.plan, 2, [8, 5]);
    for (const head of state.plan_heads ?? []) pen.line(head, colours.plan, 1.5);
    if (state.target) draw_target(pen, state.target, state.target_head);
    if (state.pose?.valid) draw_pose(pen, state.pose, state.spread);
    draw_coils(pen, state, hello?.max_current_A ?? 1);
  }
  if (refused) draw_refused(pen, refused);
  if (draft) draw_draft(pen, draft);
}

class Pen {
  constructor(context, width, height) {
    Object.assign(this, { context, width, height });
    context.lineCap = context.lineJoin = 'round';
  }

  at([u, v]) { return [u * this.width, v * this.height]; }

  stroke(path, colour, width, dash = []) {
    const { context } = this;
    context.setLineDash(dash);
    for (const [style, wide] of [[colours.rim, width + 2], [colour, width]]) {
      context.strokeStyle = style;
      context.lineWidth = wide;
      context.stroke(path);
    }
    context.setLineDash([]);
  }

  line(points, colour, width, dash, closed = false) {
    if (!points || points.length < 2) return;
    const path = new Path2D();
    for (const point of points) path.lineTo(...this.at(point));
    if (closed) path.closePath();
    this.stroke(path, colour, width, dash);
  }

  polygon(points, colour, width, dash) { this.line(points, colour, width, dash, true); }

  circle(place, radius, colour, width = 0) {
    const path = new Path2D();
    path.arc(...this.at(place), radius, 0, 2 * Math.PI);
    if (width) return this.stroke(path, colour, width);
    this.context.fillStyle = colour;
    this.context.fill(path);
  }

  arrow(from, to, colour, width, head = 9) {
    const [x0, y0] = this.at(from), [x1, y1] = this.at(to);
    const angle = Math.atan2(y1 - y0, x1 - x0);
    const path = new Path2D();
    path.moveTo(x0, y0);
    path.lineTo(x1, y1);
    for (const side of [-0.45, 0.45]) {
      path.moveTo(x1, y1);
      path.lineTo(x1 - head * Math.cos(angle + side), y1 - head * Math.sin(angle + side));
    }
    this.stroke(path, colour, width);
  }

  /// A label on its own ground, kept inside of the image.
  label(place, text, ground, ink) {
    const { context } = this;
    context.font = kLabel;
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    const half = context.measureText(text).width / 2 + 8, high = 11;
    const [x, y] = this.at(place);
    const inside_x = Math.min(Math.max(x, half + 4), this.width - half - 4);
    const inside_y = Math.min(Math.max(y, high + 4), this.height - high - 4);
    context.fillStyle = ground;
    context.beginPath();
    context.rect(inside_x - half, inside_y - high, 2 * half, 2 * high);
    context.fill();
    context.fillStyle = ink;
    context.fillText(text, inside_x, inside_y + 0.5);
  }
}

function draw_field(pen, [u, v, du, dv]) {
  if (Math.hypot(du * pen.width, dv * pen.height) < 2) return;
  pen.arrow([u, v], [u + du, v + dv], colours.field, 1.2, 5);
}

function draw_target(pen, target, head) {
  pen.circle(target, 9, colours.target, 2);
  const [x, y] = pen.at(target), cross = new Path2D();
  for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
    cross.moveTo(x + 5 * dx, y + 5 * dy);
    cross.lineTo(x + 14 * dx, y + 14 * dy);
  }
  pen.stroke(cross, colours.target, 2);
  if (head) pen.arrow(target, head, colours.target, 2);
}

function draw_pose(pen, pose, spread) {
  pen.polygon(spread, colours.spread, 1.5);
  if (pose.tail && pose.head) pen.arrow(pose.tail, pose.head, colours.pose, 2.5, 10);
  if (pose.middle) pen.circle(pose.middle, 3.5, colours.pose);
}

function draw_coils(pen, state, largest_A) {
  (state.coil_places ?? []).forEach((place, coil) => {
    const current_A = state.on_A?.[coil] ?? 0;
    const on = Math.abs(current_A) > kOn * largest_A;
    const name = coil_names()[coil];
    const text = on ? `${name}  ${number(current_A, 1)} A` : name;
    pen.label(place, text, on ? colours.coil_on : colours.coil_off, on ? colours.coil_on_ink : colours.coil_off_ink);
  });
}

function draw_refused(pen, plan) {
  pen.line(plan.points, colours.plan, 2, [8, 5]);
  for (const point of plan.bad ?? []) pen.circle(point, 4, colours.bad);
}

function draw_draft(pen, draft) {
  if (draft.kind === 'path') pen.line(draft.points, colours.draft, 2.5);
  if (draft.kind === 'target') draw_target(pen, draft.to, draft.towards);
  if (draft.kind === 'cross') {
    const [u, v] = draft.to;
    pen.line([[u, 0], [u, 1]], colours.draft, 1);
    pen.line([[0, v], [1, v]], colours.draft, 1);
  }
}
