// SPDX-License-Identifier: Apache-2.0
// A button that copies a text.

import { h } from "./dom.js";
import { say } from "./ui.js";

/**
 * @param {string} title
 * @param {string} text
 */
export function copyButton(title, text) {
  return h(
    "button.quiet",
    { onclick: (event) => copy(text, title, event.target), "aria-label": `${title} ${text}` },
    title,
  );
}

/**
 * @param {string} text
 * @param {string} title
 * @param {HTMLElement} button
 */
async function copy(text, title, button) {
  await navigator.clipboard.writeText(text);
  say("Copied");
  button.textContent = "Copied";
  setTimeout(() => (button.textContent = title), 1500);
}
