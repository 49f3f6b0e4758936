// SPDX-License-Identifier: Apache-2.0
// The events of a running target: points for the plots, lines that it tells, and its newest state. They come from a
// worker (live_worker.js), which needs signs of life of this page.

import { secretOf } from "./key.js";

export const WINDOW = 10; // seconds that are kept for the plots
const OLD = 1; // seconds without news after which values are old
const BEAT = 100; // ms between two signs of life

// This page, among others of the same session: a target that one page has enabled needs the answers of that page.
export const page = crypto.randomUUID();

export const live = {
  times: /** @type {number[]} */ ([]),
  lows: /** @type {(number | null)[][]} */ ([]), // for each signal, one value per time
  highs: /** @type {(number | null)[][]} */ ([]),
  lines: /** @type {string[]} */ ([]), // the newest lines of the target, and answers to commands
  dropped: 0,
  state: /** @type {Record<string, string> | null} */ (null), // the newest words of the target's state
  worst: /** @type {number | null} */ (null), // the longest answer of this page, in seconds
  inTime: false, // the answers of this page can keep the target enabled
  kept: /** @type {KeptRows | null} */ (null), // the rows that can be saved
  moving: /** @type {number | null} */ (null), // the target's number in the newest event, for a movement by hand
};

// The newest event: its time by both clocks of the browser, of which only one goes on while the computer is suspended.
let newest = { at: performance.now(), wall: Date.now(), age: 0, old: true };
let reading = false;
let shownOld = 0;
let changed = (/** @type {boolean} */ _all) => {};
let worker = /** @type {Worker | null} */ (null);

// Seconds since the newest news of the target.
export const age = () => newest.age + Math.max(performance.now() - newest.at, Date.now() - newest.wall) / 1000;

// True if the values and the state that the page shows are old, or if there are none yet.
export const isOld = () => newest.old || age() - newest.age > OLD;

// The newest words of the target's state.
/** @param {LiveTarget} target */
export const stateOf = (target) => live.state ?? target.state;

// Reads the events until the connection with the target ends. `whenChanged` is called after each, with true if the whole
// page must be drawn.
export function followTarget(signals, whenChanged) {
  changed = whenChanged;
  if (reading) return;
  reading = true;
  Object.assign(live, { times: [], lows: signals.map(() => []), highs: signals.map(() => []), lines: [], dropped: 0 });
  Object.assign(live, { state: null, worst: null, inTime: false, kept: null, moving: null });
  newest = { ...newest, old: true };
  worker ??= startWorker();
  worker.postMessage({ secret: secretOf(), page });
}

function startWorker() {
  const started = new Worker(new URL("./live_worker.js", import.meta.url), { type: "module" });
  // A page that nobody sees must not keep a robot enabled.
  const beat = () => started.postMessage({ alive: !document.hidden });
  document.addEventListener("visibilitychange", beat);
  setInterval(beat, BEAT);
  setInterval(tellAge, BEAT);
  started.onmessage = ({ data }) => {
    if (data === null) return ended();
    take(data);
    started.postMessage({ taken: true });
  };
  return started;
}

function take(event) {
  for (const [time, lows, highs] of event.points) add(time, lows, highs);
  newest = { at: performance.now(), wall: Date.now(), age: event.age, old: event.old };
  const differs = JSON.stringify(event.state) !== JSON.stringify(live.state) || event.in_time !== live.inTime;
  Object.assign(live, { dropped: event.dropped, state: event.state, worst: event.worst, inTime: event.in_time });
  live.kept = event.kept;
  live.moving = event.moving;
  tell(event.lines);
  changed(differs || event.lines.length > 0);
}

function ended() {
  // The state without the target arrives soon. If the target is still connected then, the events go on.
  setTimeout(() => {
    reading = false;
    changed(true);
  }, 1000);
}

// Draws the page when values become old or new, and each second while they are old.
function tellAge() {
  const now = isOld() ? Math.max(1, Math.floor(age())) : 0;
  if (now === shownOld) return;
  shownOld = now;
  changed(true);
}

function add(time, lows, highs) {
  live.times.push(time);
  for (const [index, value] of lows.entries()) live.lows[index].push(value);
  for (const [index, value] of highs.entries()) live.highs[index].push(value);
  let old = 0;
  while (live.times[old] < time - WINDOW) old++;
  if (old < 100) return; // few moves of long lists
  for (const values of [live.times, ...live.lows, ...live.highs]) values.splice(0, old);
}

// Shows lines below the plots.
export function tell(lines) {
  live.lines = [...live.lines, ...lines].slice(-12);
}
