// SPDX-License-Identifier: Apache-2.0
// The events of a running target: points for the plots, lines that it tells, and numbers that keep it enabled.

import { askRepeatedly, jsonLines } from "./server.js";

export const WINDOW = 10; // seconds that are kept for the plots

// This page, among others of the same session: a target that one page has enabled needs the answers of that page.
export const page = crypto.randomUUID();

export const live = {
  times: /** @type {number[]} */ ([]),
  lows: /** @type {(number | null)[][]} */ ([]), // for each signal, one value per time
  highs: /** @type {(number | null)[][]} */ ([]),
  lines: /** @type {string[]} */ ([]), // the newest lines of the target, and answers to commands
  dropped: 0,
};

let reading = false;

const respond = askRepeatedly("respond", 3);

// Reads the events until the connection with the target ends. Calls `changed` after each.
export async function followTarget(signals, changed) {
  if (reading) return;
  reading = true;
  Object.assign(live, { times: [], lows: signals.map(() => []), highs: signals.map(() => []), lines: [], dropped: 0 });
  try {
    for await (const event of jsonLines("api/live/events")) {
      // A page that nobody sees must not keep a robot enabled.
      if (event.number !== null && !document.hidden) respond({ page, number: event.number });
      for (const [time, lows, highs] of event.points) add(time, lows, highs);
      live.dropped = event.dropped;
      tell(event.lines);
      changed(event.lines.length > 0);
    }
  } catch {
    // the state says that the connection has ended
  } finally {
    // The state without the target arrives soon. If the target is still connected then, the events go on.
    setTimeout(() => {
      reading = false;
      changed(true);
    }, 1000);
  }
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
