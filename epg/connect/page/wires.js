// SPDX-License-Identifier: Apache-2.0
// Draws the wires as curves between handles, in one SVG over the diagram.

import { editConversion } from "./conversion.js";
import { h, id, render } from "./dom.js";
import { isError } from "./problems.js";
import { current } from "./server.js";
import { ui } from "./ui.js";
import { ofModel } from "./wiring.js";

let pointer = null; // the position of a dragged end, in the diagram's coordinates

export function setPointer(place) {
  pointer = place;
  drawWires();
}

export function drawWires() {
  const svg = document.getElementById("wires");
  const state = current();
  if (!svg || state?.phase !== "connect" || !state.model) return;
  const diagram = svg.parentElement;
  const zero = diagram.getBoundingClientRect();
  const anchors = new Map();
  // All positions are read before anything is changed, so the browser computes the layout only once.
  for (const each of diagram.querySelectorAll("[data-wire-model], [data-wire-component]")) {
    const dot = each.querySelector("[data-handle], .tap");
    const box = dot.getBoundingClientRect();
    if (box.width === 0) continue;
    const key = each.dataset.wireModel || each.dataset.wireComponent;
    anchors.set(key, { x: box.left + box.width / 2 - zero.left, y: box.top + box.height / 2 - zero.top });
  }
  const size = { width: diagram.scrollWidth, height: diagram.scrollHeight };
  const bad = new Set(state.diagnostics.filter(isError).flatMap((each) => each.ports));
  const paths = [];
  for (const [port, ends] of Object.entries(state.wires)) {
    ends.forEach((end, n) => {
      const d = curve(anchors.get(id("at", end.reference)), anchors.get(id("wire", port, n)));
      if (d) paths.push(wire(port, n, d, bad.has(port)));
    });
  }
  for (const [port, reference] of Object.entries(state.proposals)) {
    const d = curve(anchors.get(id("at", reference)), anchors.get(id("wire", port, 0)));
    if (d) paths.push(h("path.wire.proposed", { key: `${port} ?`, d }));
  }
  const held = heldCurve(anchors, zero);
  if (held) paths.push(h("path.wire.held", { key: "held", d: held }));
  svg.setAttribute("width", String(size.width));
  svg.setAttribute("height", String(size.height));
  render(svg, paths);
}

function wire(port, n, d, isBad) {
  const name = `${port} ${n}`;
  return h(
    "g",
    {
      class: `wire-group${isBad ? " bad" : ""}`,
      key: name,
      onclick: () => editConversion(port, n),
    },
    h("path.wire-reach", { d }),
    h("path.wire", { d }),
  );
}

function heldCurve(anchors, zero) {
  if (ui.held === null) return null;
  const { side, name } = ui.held;
  const from = anchors.get(ofModel(side) ? id("wire", name, 0) : id("at", name));
  let to = pointer;
  if (ui.held.by === "keyboard") {
    const focused = document.activeElement?.closest("[data-handle]");
    if (!focused || focused.dataset.side === side) return null;
    const box = focused.getBoundingClientRect();
    to = { x: box.left + box.width / 2 - zero.left, y: box.top + box.height / 2 - zero.top };
  }
  return from && to ? curve(from, to) : null;
}

// The SVG path of a curve between two positions; it is horizontal at both ends.
function curve(from, to) {
  if (!from || !to) return null;
  const distance = to.x - from.x;
  const bend = Math.sign(distance || 1) * Math.max(Math.abs(distance) / 2, 40);
  const round = (value) => Math.round(value * 10) / 10;
  const places = [from.x, from.y, from.x + bend, from.y, to.x - bend, to.y, to.x, to.y].map(round);
  return `M${places.slice(0, 2).join(" ")}C${places.slice(2).join(" ")}`;
}
