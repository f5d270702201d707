// A short message at the lower edge: why something was refused.

import { by_id, set_text } from './dom.js';

const kShown_ms = 7000;
let timer = 0;

export function toast(text, bad = false) {
  const element = by_id('toast');
  set_text(element, text);
  element.dataset.bad = String(bad);
  element.hidden = false;
  clearTimeout(timer);
  timer = setTimeout(() => { element.hidden = true; }, kShown_ms);
}
