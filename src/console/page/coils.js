// Names and colours of the four coils, in the order of the protocol, and of what is drawn over the image.

import { dark_scheme } from './dom.js';

export const kCoils = ['+x', '−x', '+y', '−y'];

/// For lines and their keys on the ground of the page: the colours of the reports.
export const coil_colours = () => dark_scheme.matches ? ['#6db3e8', '#b9dcf2', '#f08a72', '#a8604f'] : ['#1f5f8b', '#6aa6c9', '#c8553d', '#dfa08e'];

export const overlay_colours = {
  rim: 'rgba(12, 16, 22, 0.55)', fence: '#ffb454', field: '#9fd8e8', trail: '#ffe08a', plan: '#6fc3ff', target: '#7bf0a5',
  spread: '#ff9ad5', pose: '#ff5d8f', draft: '#ffffff', bad: '#ff3b30', coil_on: '#ffd23f', coil_on_ink: '#14181d',
  coil_off: 'rgba(20, 24, 29, 0.78)', coil_off_ink: '#e4e8ec',
};
