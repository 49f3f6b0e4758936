// SPDX-License-Identifier: Apache-2.0
// What belongs to the view and not to the project: which tab is open, what is searched for, what is being dragged.

import { act } from "./server.js";

export const ui = {
  tab: "problems",
  dock: "open", // "open", "large", "closed"
  refused: null, // what the server said against the last action: {message, hint, port}
  adding: null, // output that is getting another end
  held: null, // end of a wire that somebody holds: {side, name}
  dragged: false, // a drag ends at this moment: the click that follows means nothing
  filter: { text: "", robot: "", fits: false },
  chosen: null, // configuration picked on the start page, or in the dialog
  zoom: {}, // per picture
  logOpen: false,
};

let redraw = () => {};
export function whenDrawn(draw) {
  redraw = draw;
}
export function draw() {
  redraw();
}

// Does an action and shows what speaks against it; true: done.
export async function attempt(action, body = {}, port = null) {
  const error = await act(action, body);
  ui.refused = error ? { ...error, port } : null;
  if (error) say(`Refused: ${error.message}`);
  draw();
  return error === null;
}

// Has a screen reader say something.
export function say(text) {
  const place = document.getElementById("said");
  place.textContent = "";
  setTimeout(() => {
    place.textContent = text;
  }, 50);
}
