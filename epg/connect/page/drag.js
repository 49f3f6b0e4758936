// SPDX-License-Identifier: Apache-2.0
// Wires by pointer: pressed on a handle, released on a port of the other side.

import { current } from "./server.js";
import { draw, ui } from "./ui.js";
import { setPointer } from "./wires.js";
import { OPPOSITE, join } from "./wiring.js";

const START = 4; // pixels a pointer may shake before a press becomes a drag
const EDGE = 40; // pixels from the upper and lower edge where the diagram scrolls
const SPEED = 14; // pixels per frame that it scrolls there

export function listenForDrags(root) {
  root.addEventListener("pointerdown", (event) => {
    const handle = event.target.closest("[data-handle]");
    if (!handle || event.button !== 0 || !current()?.editable) return;
    event.preventDefault();
    handle.focus({ preventScroll: true });
    follow(event, handle);
  });
}

function follow(start, handle) {
  const { side, name } = handle.dataset;
  let dragging = false;
  let over = null;
  let last = start; // newest event of the pointer
  let frame = 0;

  const moved = (event) => {
    last = event;
    if (!dragging) {
      if (Math.hypot(event.clientX - start.clientX, event.clientY - start.clientY) < START) return;
      dragging = true;
      ui.held = { side, name, by: "pointer" };
      document.documentElement.classList.add("dragging");
      draw();
      frame = requestAnimationFrame(keepScrolling);
    }
    show(event);
  };
  // At an edge the diagram goes on moving under a pointer that rests.
  const keepScrolling = () => {
    if (scroll(last.clientY)) show(last);
    frame = requestAnimationFrame(keepScrolling);
  };
  const show = (event) => {
    const diagram = document.getElementById("diagram").getBoundingClientRect();
    setPointer({ x: event.clientX - diagram.left, y: event.clientY - diagram.top });
    hover(portAt(event, side));
  };
  const hover = (port) => {
    if (port === over) return;
    over?.classList.remove("over");
    over = port;
    over?.classList.add("over");
  };
  const released = (event) => {
    const port = dragging && event.type === "pointerup" ? portAt(event, side) : null;
    finish();
    if (port) join(side, name, port.dataset.name);
  };
  const pressed = (event) => {
    if (event.key === "Escape") finish();
  };
  const finish = () => {
    hover(null);
    cancelAnimationFrame(frame);
    if (dragging) {
      ui.held = null;
      ui.dragged = true;
      setTimeout(() => (ui.dragged = false));
    }
    dragging = false;
    document.documentElement.classList.remove("dragging");
    for (const [name, listener] of Object.entries(listeners)) window.removeEventListener(name, listener, true);
    setPointer(null);
    draw();
  };
  const listeners = { pointermove: moved, pointerup: released, pointercancel: released, keydown: pressed };
  for (const [name, listener] of Object.entries(listeners)) window.addEventListener(name, listener, true);
}

function portAt(event, side) {
  const port = document.elementFromPoint(event.clientX, event.clientY)?.closest("[data-drop]");
  return port?.dataset.side === OPPOSITE[side] ? port : null;
}

function scroll(y) {
  const area = document.getElementById("main");
  const box = area.getBoundingClientRect();
  const before = area.scrollTop;
  if (y < box.top + EDGE) area.scrollTop -= SPEED;
  else if (y > box.bottom - EDGE) area.scrollTop += SPEED;
  return area.scrollTop !== before;
}
