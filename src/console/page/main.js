// The operator's console: puts the parts together, and beats while this page operates.

import { Aim } from './aim.js';
import { name_coils } from './coils.js';
import { Connection } from './connection.js';
import { Dialog } from './dialog.js';
import { Drive } from './drive.js';
import { start_events } from './events.js';
import { Hand } from './hand.js';
import { start_jobs } from './jobs.js';
import { start_leaving } from './leave.js';
import { start_limits } from './limits.js';
import { Replay } from './replay.js';
import { start_runs } from './runs.js';
import { start_status } from './status.js';
import { start_stop } from './stop.js';
import { Strips } from './strips.js';
import { View } from './view.js';

const kBeat_ms = 100;

const connection = new Connection();
connection.on('hello', hello => name_coils(hello.coils));
const stop = start_stop(connection);
const dialog = new Dialog(connection);
const view = new View(connection);
const hand = new Hand(connection, dialog, stop);
start_status(connection, dialog);
new Aim(connection, view);
new Drive(connection, dialog, view);
new Strips(connection);
new Replay(connection);
start_limits(connection);
start_events(connection);
start_jobs(connection);
start_runs(connection, start_leaving(connection, dialog));

let beaten_ms = performance.now();

/// On the main thread, and nowhere else: a page that hangs shall be heard to be silent.
function beat() {
  const now_ms = performance.now();
  connection.give_way(now_ms - beaten_ms - kBeat_ms);
  beaten_ms = now_ms;
  if (!connection.operating) return;
  connection.send({ do: 'beat', visible: document.visibilityState === 'visible', focused: document.hasFocus() });
  hand.beat();
}

window.lodestone = { lastState: null };
connection.on('state', state => { window.lodestone.lastState = state; });
connection.start();
setInterval(beat, kBeat_ms);
document.addEventListener('visibilitychange', beat);  // the timers of a hidden page are slow
