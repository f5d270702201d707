// What happened, newest first.

import { by_id, make } from './dom.js';
import { clock } from './format.js';

const kMost = 200;

export function start_events(connection) {
  const list = by_id('events');
  connection.on('hello', hello => list.replaceChildren(...hello.events.slice(-kMost).reverse().map(row_of)));
  connection.on('event', event => {
    list.prepend(row_of(event));
    if (list.children.length > kMost) list.lastElementChild.remove();
  });
}

function row_of({ utc, level, text }) {
  const row = make('li', {}, make('time', { textContent: clock(utc), title: utc }), make('b', { textContent: level }), make('span', { textContent: text }));
  row.dataset.level = level;
  return row;
}
