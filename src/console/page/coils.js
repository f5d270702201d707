// Names and colours of the rig's coils, in the order of the protocol, and of what is drawn over the image.

import { dark_scheme } from './dom.js';

let names = ['+x', '−x', '+y', '−y'];

export const coil_names = () => names;
export const name_coils = listed => { names = listed.map(name => name.replace('-', '−')); };

/// For lines and their keys on the ground of the page: the colours of the reports.
export function coil_colours() {
  if (names.length !== 4) return names.map((_, coil) => `hsl(${Math.round(360 * coil / names.length)} 60% ${dark_scheme.matches ? 68 : 36}%)`);
  return dark_scheme.matches ? ['#6db3e8', '#b9dcf2', '#f08a72', '#a8604f'] : ['#1f5f8b', '#6aa6c9', '#c8553d', '#dfa08e'];
}

export const overlay_colours = {
  rim: 'rgba(12, 16, 22, 0.55)', fence: '#ffb454', keep_out: '#ff7b72', field: '#9fd8e8', trail: '#ffe08a', plan: '#6fc3ff', target: '#7bf0a5',
  spread: '#ff9ad5', pose: '#ff5d8f', draft: '#ffffff', bad: '#ff3b30', coil_on: '#ffd23f', coil_on_ink: '#14181d',
  coil_off: 'rgba(20, 24, 29, 0.78)', coil_off_ink: '#e4e8ec',
};
