// Short hands for the document. Text from outside goes in as text, never as HTML.

export const by_id = id => document.getElementById(id);

/// Writes only what changed: an aria-live region is not read out again, and nothing is laid out anew.
export function set_text(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

export function make(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

/// The value of a CSS custom property, such as a colour of the palette.
export const palette = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export const dark_scheme = matchMedia('(prefers-color-scheme: dark)');

/// Space belongs to STOP, so a check box takes Enter.
export function enter_toggles(box) {
  box.addEventListener('keydown', event => {
    if (event.key !== 'Enter') return;
    event.preventDefault();  // or what the click opens would get the key, too
    if (!event.repeat) box.click();
  });
}

/// Sizes a canvas to the pixels of the screen; its context then counts CSS pixels.
export function fit_canvas(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth, height = canvas.clientHeight;
  const columns = Math.round(width * ratio), rows = Math.round(height * ratio);
  if (canvas.width !== columns || canvas.height !== rows) Object.assign(canvas, { width: columns, height: rows });
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}
