// SPDX-License-Identifier: Apache-2.0
// Modal dialogs. The browser's <dialog> keeps the focus inside, and restores it on closing. An open dialog is drawn
// again with every state; text that the user has typed stays.

import { h, render } from "./dom.js";
import { icon } from "./icons.js";

const open = new Map(); // name -> {element, title, content}

// Opens a dialog. `content` is called for each drawing: it returns the children, or null to close the dialog.
export function openDialog(name, title, content, attributes = {}) {
  closeDialog(name);
  const element = document.createElement("dialog");
  element.className = `dialog dialog-${name}`;
  element.setAttribute("aria-labelledby", `${name}-title`);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.addEventListener("close", () => {
    open.delete(name);
    element.remove();
  });
  document.body.append(element);
  open.set(name, { element, title, content });
  drawDialog(name);
  element.showModal();
}

export function closeDialog(name) {
  open.get(name)?.element.close();
}

export function drawDialogs() {
  for (const name of [...open.keys()]) drawDialog(name);
}

function drawDialog(name) {
  const { element, title, content } = open.get(name);
  const inside = content();
  if (inside === null) {
    element.close();
    return;
  }
  const head = h(
    "div.dialog-head",
    { key: "head" },
    h("h2", { id: `${name}-title` }, title),
    h(
      "button",
      { type: "button", class: "quiet icon-button", "aria-label": "Close", onclick: () => element.close() },
      icon("close"),
    ),
  );
  render(element, [head, h("div.dialog-body", { key: "body" }, inside)]);
}
