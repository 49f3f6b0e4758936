// SPDX-License-Identifier: Apache-2.0
// Reads the events of a running target, and sends the numbers of its lease back, in a thread of its own: an answer does
// not wait while the page draws. It answers only while the page is visible and alive, so that the user can press Stop.

import { adopt } from "./key.js";
import { askRepeatedly, jsonLines } from "./server.js";

const ALIVE = 700; // ms for which a sign of life of the page counts
const KEPT = 1000; // points that wait for the page

let alive = -ALIVE; // the time of the last sign of life
let waiting = null; // an event that joins those that the page has not got yet
let busy = false; // the page has not yet taken the last event

const respond = askRepeatedly("respond", 3);

addEventListener("message", ({ data }) => {
  if ("taken" in data) {
    busy = false;
    pass();
  } else if ("alive" in data) alive = data.alive ? performance.now() : -ALIVE;
  else read(data);
});

// Reads the events until the connection with the target ends.
async function read({ secret, page }) {
  adopt(secret);
  try {
    for await (const event of jsonLines(`api/live/events?page=${page}`)) {
      if (event.number !== null && performance.now() - alive < ALIVE) respond({ page, number: event.number });
      waiting = joined(waiting, event);
      pass();
    }
  } catch {
    // the state says that the connection has ended
  }
  waiting = null;
  busy = false;
  postMessage(null);
}

// Gives the page one event at a time, so that a slow page always gets the newest state.
function pass() {
  if (busy || !waiting) return;
  busy = true;
  postMessage(waiting);
  waiting = null;
}

const joined = (before, event) =>
  before
    ? {
        ...event,
        points: [...before.points, ...event.points].slice(-KEPT),
        lines: [...before.lines, ...event.lines],
        moving: event.moving ?? before.moving,
      }
    : event;
