// SPDX-License-Identifier: Apache-2.0
// The newest values of the signals of a running target, in the tab Live and at the ports of the drawing.

import { h } from "./dom.js";
import { live } from "./live_events.js";

function text(index, unit, digits) {
  const value = live.highs[index]?.at(-1) ?? null;
  const number = value === null ? "–" : String(Number(value.toPrecision(digits)));
  return unit ? `${number} ${unit}` : number;
}

// The value of the signal with this index, with `unit` behind it.
export const value = (index, unit = "", digits = 5) =>
  h(
    "span.value",
    { key: "value", "data-signal": index, "data-unit": unit, "data-digits": digits },
    text(index, unit, digits),
  );

/**
 * The value of a port of the model, while the target that was built last is connected; else null.
 * @param {State} state
 */
export function portValue({ live: { target } }, side, name) {
  const index = target?.matches ? target.signals.findIndex((each) => each.name === `${side}.${name}`) : -1;
  return index >= 0 && value(index, "", 3);
}

// Shows the newest values without drawing the page again.
export function drawValues() {
  for (const place of document.querySelectorAll("[data-signal]")) {
    const { signal, unit, digits } = /** @type {HTMLElement} */ (place).dataset;
    const newest = text(Number(signal), unit, Number(digits));
    if (place.firstChild && place.textContent !== newest) place.firstChild.nodeValue = newest;
  }
}
