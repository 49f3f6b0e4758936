// SPDX-License-Identifier: Apache-2.0
// Dialogs. While one is open, nothing else on the page can be used but the button that stops a robot: so it is not one of
// the browser's modal dialogs, which cover all other elements. An open dialog is drawn again with every state; text that
// the user has typed stays.

import { h, render } from "./dom.js";
import { icon } from "./icons.js";

const OTHERS = "body > :not(#robot, #said, dialog)";

let open = null; // {element, title, content}

// Opens a dialog in place of the open one. `content` is called for each drawing: it returns the children, or null to
// close the dialog.
export function openDialog(name, title, content) {
  closeDialog();
  const element = document.createElement("dialog");
  element.className = `dialog dialog-${name}`;
  element.setAttribute("aria-labelledby", "dialog-title");
  document.body.append(element);
  open = { element, title, content };
  drawDialog();
  element.show();
  setOthers(true);
}

document.addEventListener("keydown", (event) => {
  if (event.key === "Escape") closeDialog();
});

export function closeDialog() {
  if (!open) return;
  const { element } = open;
  open = null;
  setOthers(false);
  element.close(); // gives the focus back
  element.remove();
  if (document.activeElement === document.body) (document.getElementById("panel") ?? main()).focus();
}

const main = () => document.getElementById("main");

function setOthers(inert) {
  for (const each of document.querySelectorAll(OTHERS)) /** @type {HTMLElement} */ (each).inert = inert;
}

// The buttons at the end of a dialog: `before`, and on the right "Cancel" and the button that acts.
export const dialogButtons = (text, attributes = {}, ...before) =>
  h(
    "div.buttons",
    { key: "buttons" },
    before,
    h("span.space"),
    h("button", { type: "button", onclick: closeDialog }, "Cancel"),
    h("button", { type: attributes.onclick ? "button" : "submit", class: "primary", ...attributes }, text),
  );

export function drawDialog() {
  const inside = open?.content() ?? null;
  if (inside === null) {
    closeDialog();
    return;
  }
  const head = h(
    "div.dialog-head",
    { key: "head" },
    h("h2", { id: "dialog-title" }, open.title),
    h("button.quiet.icon-button", { "aria-label": "Close", onclick: closeDialog }, icon("close")),
  );
  render(open.element, [head, h("div.dialog-body", { key: "body" }, inside)]);
}
