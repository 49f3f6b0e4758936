// SPDX-License-Identifier: Apache-2.0
// The state of the view, which is not part of the project: the open tab, the search, the end that is being dragged.

import { act } from "./server.js";

export const ui = {
  tab: "problems",
  dock: "open", // "open", "large", "closed"
  refused: /** @type {(Refusal & { port: string }) | null} */ (null), // the error of the last action if it was refused
  adding: null, // the name of the output to which the user adds another end
  held: /** @type {Held | null} */ (null), // the end of a wire that the user holds
  dragged: false, // true right after a drag: the click event that follows must be ignored
  filter: { text: "", robot: "", fits: false },
  component: null, // the name of the component in the tab Component
  chosen: null, // the configuration chosen on the start page or in the dialog
};

export let draw = () => {};
export function whenDrawn(drawPage) {
  draw = drawPage;
}

// Changes some values of `ui`, and draws the page.
/** @param {Partial<typeof ui>} values */
export function change(values) {
  Object.assign(ui, values);
  draw();
}

export function openTab(tab) {
  change({ tab, dock: ui.dock === "closed" ? "open" : ui.dock });
}

// Sends an action, and shows the error if it is refused. Returns true if it was done.
/**
 * @template {keyof Actions} Name
 * @param {Name} action
 * @param {Actions[Name]} [body]
 * @param {string | null} [port]
 * @returns {Promise<boolean>}
 */
export async function attempt(action, body, port = null) {
  const error = await act(action, body);
  ui.refused = error ? { ...error, port } : null;
  if (error) say(`Refused: ${error.message}`);
  draw();
  return error === null;
}

// Makes a screen reader announce `text`.
export function say(text) {
  const place = document.getElementById("said");
  place.textContent = "";
  setTimeout(() => {
    place.textContent = text;
  }, 50);
}
