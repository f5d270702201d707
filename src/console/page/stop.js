// STOP: one touch, click or key from everywhere, never disabled and never a question.

import { by_id } from './dom.js';
import { toast } from './toast.js';

const kKeys = { ' ': 'space', Escape: 'escape' };

/// Sent to the document at every STOP: whatever holds, aims or asks lets go.
export const kStopped = 'lodestone-stopped';

export function start_stop(connection) {
  const button = by_id('stop');

  const stop = by => {
    const sent = connection.send({ do: 'stop', by });
    button.dataset.pressed = 'true';
    setTimeout(() => delete button.dataset.pressed, 400);
    document.dispatchEvent(new Event(kStopped));
    if (!sent) toast('STOP could not be sent: no connection to the console. Use the emergency stop of the bench.', true);
  };

  // Before anything else hears them, whatever has the focus; a held key stops once.
  window.addEventListener('keydown', event => {
    if (!(event.key in kKeys)) return;
    swallow(event);
    if (!event.repeat) stop(kKeys[event.key]);
  }, true);
  // A button that has the focus would be clicked as the space bar comes up.
  window.addEventListener('keyup', event => {
    if (event.key in kKeys) swallow(event);
  }, true);

  button.addEventListener('pointerdown', event => {
    event.preventDefault();
    stop(event.pointerType === 'touch' ? 'touch' : 'button');
  });
  // Enter, or a screen reader: a click without a pointer.
  button.addEventListener('click', event => {
    if (event.detail === 0) stop('button');
  });
  return stop;
}

function swallow(event) {
  event.preventDefault();
  event.stopImmediatePropagation();
}
