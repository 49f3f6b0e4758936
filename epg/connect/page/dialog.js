// SPDX-License-Identifier: Apache-2.0
// Modal dialogs. The browser's <dialog> keeps the focus inside, and restores it on closing. An open dialog is drawn
// again with every state; text that the user has typed stays.

import { h, render } from "./dom.js";
import { icon } from "./icons.js";

let open = null; // {element, title, content}

// Opens a dialog in place of the open one. `content` is called for each drawing: it returns the children, or null to
// close the dialog.
export function openDialog(name, title, content) {
  closeDialog();
  const element = document.createElement("dialog");
  element.className = `dialog dialog-${name}`;
  element.setAttribute("aria-labelledby", "dialog-title");
  element.addEventListener("close", () => {
    if (open?.element === element) open = null;
    element.remove();
  });
  document.body.append(element);
  open = { element, title, content };
  drawDialog();
  element.showModal();
}

export function closeDialog() {
  open?.element.close();
}

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
