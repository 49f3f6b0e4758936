// SPDX-License-Identifier: Apache-2.0
// Drawing and moving wires with a pointer: it is pressed on a handle. Released on a port of the other side, it connects
// both. Released on a port of the same side, it moves the wires of the first port there.

import { current } from "./server.js";
import { draw, ui } from "./ui.js";
import { setPointer } from "./wires.js";
import { OPPOSITE, isConnected, join, move } from "./wiring.js";

const START = 4; // a press becomes a drag after this movement, in pixels
const EDGE = 40; // a drag so close to the upper or lower edge scrolls the diagram, in pixels
const SPEED = 14; // speed of that scrolling, in pixels per frame

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
  let last = start; // the latest event of the pointer
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
  // A pointer that rests at an edge gives no events, but the diagram must go on scrolling.
  const keepScrolling = () => {
    if (scroll(last.clientY)) show(last);
    frame = requestAnimationFrame(keepScrolling);
  };
  const show = (event) => {
    const diagram = document.getElementById("diagram").getBoundingClientRect();
    setPointer({ x: event.clientX - diagram.left, y: event.clientY - diagram.top });
    hover(portAt(event, side, name));
  };
  const hover = (port) => {
    if (port === over) return;
    over?.classList.remove("over");
    over = port;
    over?.classList.add("over");
  };
  const released = (event) => {
    const port = dragging && event.type === "pointerup" ? portAt(event, side, name) : null;
    finish();
    if (port) (port.dataset.side === side ? move : join)(side, name, port.dataset.name);
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
    listening.abort();
    setPointer(null);
    draw();
  };
  const listeners = { pointermove: moved, pointerup: released, pointercancel: released, keydown: pressed };
  const listening = new AbortController();
  for (const [name, listener] of Object.entries(listeners)) {
    window.addEventListener(name, listener, { capture: true, signal: listening.signal });
  }
}

// The port under the pointer at which the end can be dropped, or null.
function portAt(event, side, name) {
  const port = document.elementFromPoint(event.clientX, event.clientY)?.closest("[data-drop]") ?? null;
  if (port === null || port.dataset.side === OPPOSITE[side]) return port;
  const other = port.dataset.side === side && port.dataset.name !== name;
  return other && isConnected(current(), side, name) ? port : null;
}

function scroll(y) {
  const area = document.getElementById("main");
  const box = area.getBoundingClientRect();
  const before = area.scrollTop;
  if (y < box.top + EDGE) area.scrollTop -= SPEED;
  else if (y > box.bottom - EDGE) area.scrollTop += SPEED;
  return area.scrollTop !== before;
}
