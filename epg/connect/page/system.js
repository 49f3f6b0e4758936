// SPDX-License-Identifier: Apache-2.0
// A system: its targets as boxes, and the connections between them. A box opens its target.

import { h, id, plural, render, rowHead, table } from "./dom.js";
import { icon } from "./icons.js";
import { counted } from "./problems.js";
import { current } from "./server.js";
import { attempt } from "./ui.js";

const COLOURS = 6;
const BESIDE = 22; // the distance of the first lane from the boxes
const LANE = 13;

const full = ({ target, port }) => `${target}/${port}`;
const row = ({ target, component }, side) => id(side, target, component);

/** @param {State} state */
export function systemPage(state) {
  const { system } = state;
  if (!system) {
    return h("p.empty", { key: "none" }, "The file of the system cannot be read. The tab Problems shows the reason.");
  }
  return h(
    "div.overview",
    { id: "overview", key: "overview", shown: (node) => sizes.observe(node) },
    system.plant && plantBox(system),
    h(
      "section.boxes",
      { key: "boxes", "aria-label": "Targets" },
      system.targets.map((target) => box(system, target)),
    ),
    h("svg", { id: "lanes", key: "lanes", keep: true, "aria-hidden": "true" }),
  );
}

async function openTarget(target) {
  if (await attempt("open", { target })) document.getElementById("main").focus();
}

export async function backToSystem() {
  const left = current().project.name;
  if (await attempt("overview")) document.getElementById(id("open", left))?.focus();
}

/** @param {System} system */
function plantBox({ plant, targets }) {
  const bound = targets.filter(({ name }) => plant.wires[name]);
  return h(
    "section.plant",
    { key: "plant", "aria-label": "Plant" },
    h("h2", plant.name),
    h("p.muted", ["plant, simulated", plant.step].filter(Boolean).join(", ")),
    h(
      "ul",
      bound.map(({ name }) => h("li", { key: name }, h("span.muted", `${name}: `), plural(plant.wires[name], "wire"))),
    ),
  );
}

/** @param {System} system */
function box(system, target) {
  const { name, model, middleware, period } = target;
  const title = id("box", name);
  const { errors, warnings, text } = counted(messagesOf(name));
  const received = system.connections.filter(({ to }) => to.target === name);
  const sent = system.connections.filter(({ from }) => from.target === name);
  const world = system.world.filter((end) => end.target === name);
  return h(
    "article.box",
    { key: name, id: title, "aria-labelledby": id("name", name) },
    h(
      "div.box-head",
      h("h2", { id: id("name", name) }, name),
      errors + warnings > 0 &&
        h("span", { class: `box-problems ${errors ? "error" : "warning"}` }, icon(errors ? "error" : "warning"), text),
      h("button", { id: id("open", name), "aria-label": `Open ${name}`, onclick: () => openTarget(name) }, "Open"),
    ),
    h("p.muted", [target.target, period, middleware, model && `model ${model}`].filter(Boolean).join(", ")),
    ends("Receives", [
      ...world.map((end) => [end, `from other programs, topic ${end.topic}`, "in"]),
      ...received.map((each) => [each.to, ["from ", full(each.from)], "in"]),
    ]),
    ends(
      "Sends",
      grouped(sent).map(([end, list]) => [end, receivers(list), "out"]),
    ),
    system.plant?.wires[name] &&
      h("p.muted", { key: "plant" }, `${plural(system.plant.wires[name], "wire")} to the plant`),
  );
}

const messagesOf = (name) => current().diagnostics.filter((each) => each.targets.includes(name));

// The connections of each sender, as [end, list].
const grouped = (connections) =>
  [...Map.groupBy(connections, ({ from }) => full(from)).values()].map((list) => [list[0].from, list]);

function receivers(list) {
  const { unit, sent } = list[0];
  return [`to ${list.map(({ to }) => full(to)).join(", ")}`, ...[unit, sent].filter(Boolean)].join(", ");
}

// The ends of connections in one direction: [end, text, "in" or "out"].
function ends(title, list) {
  if (list.length === 0) return null;
  return h(
    "div",
    { key: title },
    h("h3", title),
    h(
      "ul.box-ends",
      list.map(([end, text, side]) =>
        h(
          "li",
          { key: full(end), "data-row": row(end, side) },
          h("span.port-name", end.port),
          " ",
          h("span.muted", text),
        ),
      ),
    ),
  );
}

// The table of all connections, with the age of their values.
/** @param {State} state */
export function connectionTable(state) {
  const { connections, loops } = state.system ?? { connections: [], loops: [] };
  if (connections.length === 0) return h("p.empty", "The targets are not connected with each other.");
  const head = ["From", "To", "Topic", "Message", "Unit", "Sent", "Oldest value"];
  return [
    table(
      { key: "table" },
      h("caption.unseen", "Connections"),
      head,
      connections.map(({ from, to, topic, message, unit, sent, age }) => [
        rowHead(full(from)),
        ...[full(to), topic, message, unit, sent, age],
      ]),
    ),
    h(
      "ul.loops",
      { key: "loops" },
      loops.map((text) => h("li", text)),
    ),
  ];
}

const sizes = new ResizeObserver(() => drawLanes());

// Draws a line from each sender to its receivers, in a separate lane beside the boxes, and one from the plant to each of
// its targets. The boxes name the other ends, too: in narrow windows there is no space for lines.
export function drawLanes() {
  const svg = document.getElementById("lanes");
  const system = current()?.system;
  if (!svg || !system) return;
  const diagram = svg.parentElement;
  const zero = diagram.getBoundingClientRect();
  const rows = new Map();
  for (const each of diagram.querySelectorAll("[data-row]")) {
    const { top, height } = each.getBoundingClientRect();
    rows.set(each.dataset.row, top + height / 2 - zero.top);
  }
  const boxes = diagram.querySelector(".boxes").getBoundingClientRect();
  const size = { width: diagram.clientWidth, height: diagram.clientHeight };
  const edge = boxes.right - zero.left;
  const senders = grouped(system.connections);
  const step = Math.min(LANE, (size.width - edge - BESIDE - 4) / Math.max(senders.length, 1));
  const paths = senders.flatMap(([from, list], n) => {
    const lane = edge + BESIDE + n * step;
    const start = rows.get(row(from, "out"));
    return list.map(({ to }) => {
      const end = rows.get(row(to, "in"));
      const key = `${full(from)} ${full(to)}`;
      return h(
        "g",
        { key, class: `lane lane-${n % COLOURS}` },
        h("path", { d: `M${edge} ${start}H${lane}V${end}H${edge}` }),
        h("path.arrow", { d: `M${edge + 7} ${end - 4}L${edge + 1} ${end}L${edge + 7} ${end + 4}` }),
      );
    });
  });
  svg.setAttribute("width", String(size.width));
  svg.setAttribute("height", String(size.height));
  render(svg, [...paths, ...plantLines(diagram, zero, boxes.left - zero.left)]);
}

function plantLines(diagram, zero, edge) {
  const { plant, targets } = current().system;
  const place = diagram.querySelector(".plant")?.getBoundingClientRect();
  if (!place || place.right > edge + zero.left) return [];
  return targets
    .filter(({ name }) => plant.wires[name])
    .map(({ name }) => {
      const top = document.getElementById(id("box", name)).getBoundingClientRect().top - zero.top + 22;
      return h("path.to-plant", { key: `plant ${name}`, d: `M${place.right - zero.left} ${top}H${edge}` });
    });
}
