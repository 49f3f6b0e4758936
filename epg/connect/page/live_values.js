// SPDX-License-Identifier: Apache-2.0
// The newest values of the signals of a running target, in the tab Live and at the ports of the drawing.

import { h } from "./dom.js";
import { live } from "./live_events.js";

function text(index, unit) {
  const value = live.highs[index]?.at(-1) ?? null;
  const number = value === null ? "–" : String(Number(value.toPrecision(5)));
  return unit ? `${number} ${unit}` : number;
}

// The value of the signal with this index, with `unit` behind it.
export const value = (index, unit = "") =>
  h("span.value", { key: "value", "data-signal": index, "data-unit": unit }, text(index, unit));

/**
 * The value of a port of the model, while the target that was built last is connected; else null.
 * @param {State} state
 */
export function portValue({ live: { target } }, side, name) {
  const index = target?.matches ? target.signals.findIndex((each) => each.name === `${side}.${name}`) : -1;
  return index >= 0 && value(index);
}

// Shows the newest values without drawing the page again.
export function drawValues() {
  for (const place of document.querySelectorAll("[data-signal]")) {
    const newest = text(Number(place.getAttribute("data-signal")), place.getAttribute("data-unit"));
    if (place.firstChild && place.textContent !== newest) place.firstChild.nodeValue = newest;
  }
}
