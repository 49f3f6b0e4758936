// SPDX-License-Identifier: Apache-2.0
// The handles: dots where wires begin and end, for the pointer and for the keyboard. The Tab key reaches one handle of
// each side; the arrow keys move to the others.

import { h, id } from "./dom.js";
import { current } from "./server.js";
import { draw, say, ui } from "./ui.js";
import { OPPOSITE, disconnect, endsOf, fits, isUnconnected, join, modelPort, ofModel, unitText } from "./wiring.js";

const stops = {}; // side -> name of the handle that the Tab key reaches

const handleId = (side, name) => id("handle", side, name);

export function handle(side, name, label, connected) {
  const held = ui.held !== null && ui.held.side === side && ui.held.name === name;
  return h("span", {
    class: `handle${connected ? " connected" : ""}${held ? " held" : ""}`,
    id: handleId(side, name),
    key: "handle",
    role: "button",
    "aria-label": label,
    "aria-pressed": String(held),
    "aria-describedby": "handle-help",
    "data-side": side,
    "data-name": name,
    "data-handle": "",
  });
}

// The CSS class that marks a port while the user holds an end of a wire: "fits" or "other", "is-held" for that end.
/** @param {State} state */
export function match(state, side, name) {
  if (ui.held === null) return "";
  if (ui.held.side === side) return ui.held.name === name ? "is-held" : "";
  if (OPPOSITE[ui.held.side] !== side) return "other";
  return fits(state, side, name, ui.held.name) ? "fits" : "other";
}

const all = (side) => [...document.querySelectorAll(`[data-handle][data-side="${side}"]`)];

// Makes exactly one handle of each side reachable with Tab. Must be called after each drawing.
export function drawStops() {
  for (const side of Object.keys(OPPOSITE)) {
    const handles = all(side);
    if (!handles.some((each) => each.dataset.name === stops[side])) stops[side] = handles[0]?.dataset.name;
    for (const each of handles) each.tabIndex = each.dataset.name === stops[side] ? 0 : -1;
  }
}

function focus(element) {
  stops[element.dataset.side] = element.dataset.name;
  drawStops();
  element.scrollIntoView({ block: "nearest" });
  element.focus();
}

export function listenForPresses(root) {
  root.addEventListener("keydown", (event) => {
    const here = event.target.closest?.("[data-handle]");
    if (!here) return;
    const { side, name } = here.dataset;
    const keys = {
      Enter: () => press(side, name),
      " ": () => press(side, name),
      Escape: () => ui.held && putBack(),
      ArrowDown: () => move(here, 1),
      ArrowUp: () => move(here, -1),
      Home: () => move(here, -Infinity),
      End: () => move(here, Infinity),
      Delete: () => ofModel(side) && current().wires[name] && disconnect(name),
    };
    if (!(event.key in keys)) return;
    event.preventDefault();
    keys[event.key]();
  });
  // A click on a handle is the same as Enter, for screen readers and for users who cannot drag. A click elsewhere puts
  // the held end back.
  root.addEventListener("click", (event) => {
    const here = event.target.closest?.("[data-handle]");
    if (here && !ui.dragged) press(here.dataset.side, here.dataset.name);
    else if (!here && ui.held?.by === "keyboard") putBack();
  });
  root.addEventListener("focusout", (event) => {
    // Moving the focus away with Tab puts the held end back.
    const to = event.relatedTarget;
    if (ui.held?.by === "keyboard" && to && !to.closest?.("[data-handle]")) {
      ui.held = null;
      draw();
    }
  });
}

function press(side, name) {
  if (!current().editable) return;
  if (ui.held === null) {
    ui.held = { side, name, by: "keyboard" };
    draw();
    say(`${name} is picked up. Arrow keys choose the other end, Enter connects, Escape cancels.`);
  } else if (OPPOSITE[ui.held.side] === side) {
    const held = ui.held;
    ui.held = null;
    focus(document.getElementById(handleId(held.side, held.name)));
    join(held.side, held.name, name);
    draw();
  } else {
    putBack();
  }
}

function putBack() {
  const held = ui.held;
  ui.held = null;
  draw();
  focus(document.getElementById(handleId(held.side, held.name)));
  say(`${held.name} put back`);
}

function move(here, by) {
  const { side } = here.dataset;
  const away = ui.held !== null && ui.held.side === side;
  const handles = all(away ? OPPOSITE[side] : side);
  if (handles.length === 0) return;
  let next;
  if (away) {
    const state = current();
    next = handles.find((each) => fits(state, each.dataset.side, each.dataset.name, ui.held.name)) || handles[0];
  } else {
    const n = handles.indexOf(here) + by;
    next = handles[Math.max(0, Math.min(handles.length - 1, n))];
  }
  focus(next);
  if (ui.held !== null) {
    const fit = fits(current(), next.dataset.side, next.dataset.name, ui.held.name);
    say(`${next.getAttribute("aria-label")}: ${fit ? "fits" : "does not fit"}`);
    draw();
  }
}

/**
 * @param {State} state
 * @param {Port} port
 */
export function modelLabel(state, side, port) {
  const ends = endsOf(state, port.name).map((end) => end.reference);
  const how = isUnconnected(state, port.name) ? "unconnected on purpose" : ends.join(" and ") || "not connected";
  return `${side === "inputs" ? "input" : "output"} ${port.name}, ${unitText(port)}, ${how}`;
}

/**
 * @param {ComponentPort} port
 * @param {User[]} users
 */
export function componentLabel(side, port, users) {
  const ports = users.map((user) => user.port).join(" and ");
  const how = ports ? `connected with ${ports}` : "not connected";
  return `${side === "sources" ? "source" : "sink"} ${port.reference}, ${unitText(port)}, ${how}`;
}

/** @param {State} state */
export const isKnown = (state) =>
  ui.held === null ||
  (ofModel(ui.held.side)
    ? modelPort(state, ui.held.name) !== null
    : state.components.some((component) => component.ports.some((port) => port.reference === ui.held.name)));
