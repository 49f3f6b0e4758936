// SPDX-License-Identifier: Apache-2.0
// The model in the middle of the page: its inputs with their sources, and its outputs with their sinks.

import { editConversion } from "./conversion.js";
import { h, id, option, plural } from "./dom.js";
import { handle, match, modelLabel } from "./handles.js";
import { icon } from "./icons.js";
import { inline, isError } from "./problems.js";
import { current } from "./server.js";
import { attempt, change, say, ui } from "./ui.js";
import { portValue } from "./live_values.js";
import { disconnect, endsOf, fits, isUnconnected, replaceEnd, setEnds, unitMark } from "./wiring.js";

/** @param {State} state */
export function modelHead(state) {
  const { model, proposals, unused } = state;
  const count = Object.keys(proposals).length;
  return h(
    "div.model-head",
    { key: "model-head" },
    h("h2", model.name),
    h("p.muted", stepText(model.step), model.origin ? ` · ${model.origin}` : ""),
    count > 0 &&
      state.editable &&
      h(
        "button.accept-all",
        { onclick: acceptAll },
        count === 1 ? "Accept 1 proposal" : `Accept all ${count} proposals`,
      ),
    unused.length > 0 &&
      h(
        "button.leave-out",
        { key: "unused", onclick: leaveOut, title: unused.join(", "), disabled: Boolean(state.draft.conflict) },
        `Leave out ${plural(unused.length, "part")} of the robot that no port uses`,
      ),
  );
}

// The buttons for proposals disappear when they are pressed, and the focus would be lost. The next useful element
// gets it.
async function acceptAll() {
  if (await attempt("accept")) document.getElementById("main").focus();
}

async function leaveOut() {
  const count = current().unused.length;
  if (await attempt("leave_out")) {
    say(`${plural(count, "part")} left out. The tab Changes shows the lines of the .tcf.`);
    document.getElementById("main").focus();
  }
}

async function accept(name) {
  if (await attempt("accept", { ports: [name] })) document.getElementById(id("ends", name, 0))?.focus();
}

function stepText(step) {
  if (!step) return "no fixed step";
  return step < 0.001
    ? `step ${Number((step * 1e6).toPrecision(6))} µs`
    : `step ${Number((step * 1e3).toPrecision(6))} ms`;
}

/**
 * @param {State} state
 * @param {Map<string, Message[]>} diagnostics
 */
export function modelPorts(state, side, diagnostics) {
  const ports = state.model[side];
  const title = side === "inputs" ? "Inputs" : "Outputs";
  return h(
    "section",
    { class: `ports ${side}`, key: side, "aria-labelledby": `title-${side}` },
    h("h3", { id: `title-${side}` }, title, h("span.count", ` ${ports.length}`)),
    ports.length === 0 && h("p.empty", `The model has no ${side}.`),
    h(
      "ul.port-list",
      ports.map((port) => row(state, side, port, diagnostics.get(port.name) || [])),
    ),
  );
}

/**
 * @param {State} state
 * @param {Port} port
 * @param {Message[]} diagnostics
 */
function row(state, side, port, diagnostics) {
  const { name } = port;
  const ends = endsOf(state, name);
  const proposal = name in state.wires ? null : state.proposals[name];
  const worst = diagnostics.some(isError) ? " has-error" : "";
  const shown = ui.adding === name || ends.length === 0 ? [...ends, null] : ends;
  return h(
    "li",
    {
      class: `port ${match(state, side, name)}${worst}`,
      key: name,
      "data-drop": "",
      "data-side": side,
      "data-name": name,
    },
    h(
      "div.port-head",
      h(
        name in state.by_system ? "span.port-name" : "label.port-name",
        { key: "name", for: name in state.by_system ? null : id("ends", name, 0), title: port.description || null },
        name,
      ),
      unitMark(port),
      portValue(state, side, name),
    ),
    name in state.by_system
      ? h("p.muted", { key: "system" }, "By the system: topic ", h("code", state.by_system[name]))
      : shown.map((end, n) => field(state, side, port, end, n)),
    proposal &&
      h(
        "button.proposal",
        {
          key: "proposal",
          onclick: () => accept(name),
          "aria-label": `Accept ${proposal} for ${name}`,
          title: "The names match",
          disabled: !state.editable,
        },
        h("span", "Accept "),
        h("b", proposal),
      ),
    inline(ui.refused?.port === name ? [{ severity: "error", ...ui.refused }, ...diagnostics] : diagnostics),
  );
}

// One end of a port: its handle, the list of component ports, and the conversion of its wire. `end` is null for an end
// without a wire; `n` is the number of the end, from 0.
/**
 * @param {State} state
 * @param {Port} port
 * @param {End | null} end
 */
function field(state, side, port, end, n) {
  const { name } = port;
  const ends = endsOf(state, name);
  const mayAdd = side === "outputs" && end !== null && n === ends.length - 1 && ui.adding !== name;
  return h(
    "div.end",
    { key: `end-${n}`, "data-wire-model": id("wire", name, n) },
    n === 0 ? handle(side, name, modelLabel(state, side, port), ends.length > 0) : h("span.tap", { key: "handle" }),
    h(
      "select",
      {
        id: id("ends", name, n),
        key: "select",
        "aria-label": n === 0 ? null : `${name}, end ${n + 1}`,
        value: end ? `:${end.reference}` : isUnconnected(state, name) ? "unconnected" : "",
        disabled: !state.editable,
        onchoose: (value) => choose(side, name, n, value),
      },
      options(state, side, port, end, n),
    ),
    mayAdd &&
      h(
        "button.quiet.icon-button",
        {
          key: "add",
          "aria-label": `Connect ${name} to another component`,
          title: "Connect to another component",
          disabled: !state.editable,
          onclick: () => {
            change({ adding: name });
            document.getElementById(id("ends", name, ends.length))?.focus();
          },
        },
        icon("plus"),
      ),
    end ? conversionButton(port, side, end, n) : null,
  );
}

/**
 * @param {State} state
 * @param {Port} port
 * @param {End | null} end
 */
function options(state, side, port, end, n) {
  const { name } = port;
  const more = n > 0 && end === null;
  const list = [option("", more ? "(choose another)" : n > 0 ? "(remove)" : "(not connected)")];
  if (side === "outputs" && n === 0) list.push(option("unconnected", "unconnected on purpose"));
  const references = [...(state.candidates[name] || [])];
  if (end && !references.includes(end.reference)) references.push(end.reference);
  const named = (reference) => option(`:${reference}`, reference);
  const good = references.filter((reference) => fits(state, side, name, reference));
  const others = references.filter((reference) => !good.includes(reference));
  list.push(...good.map(named));
  if (others.length) list.push(h("optgroup", { key: "others", label: "different unit or type" }, others.map(named)));
  return list;
}

function choose(side, name, n, value) {
  if (value === "unconnected") return setEnds(name, []);
  if (value === "") {
    ui.adding = null;
    return n === 0 && side === "inputs" ? disconnect(name) : removeEnd(name, n);
  }
  return replaceEnd(name, n, value.slice(1));
}

// The list of the last end disappears, and the one before it gets the focus.
async function removeEnd(name, n) {
  await replaceEnd(name, n, null);
  if (!document.getElementById(id("ends", name, n))) document.getElementById(id("ends", name, n - 1))?.focus();
}

/**
 * @param {Port} port
 * @param {End} end
 */
function conversionButton(port, side, end, n) {
  const words = side === "inputs" ? `${end.reference} to ${port.name}` : `${port.name} to ${end.reference}`;
  return h(
    "button",
    {
      class: end.text ? "wire-label" : "wire-label bare",
      key: "conversion",
      id: id("conversion", port.name, n),
      "aria-label": `Conversion from ${words}: ${end.text || "none"}`,
      title: end.text || "Conversion on this wire",
      onclick: () => editConversion(port.name, n),
    },
    end.text ? steps(end.text) : icon("conversion"),
  );
}

// Lets a long conversion wrap between its steps: scale, offset, limits.
function steps(text) {
  const parts = text.split(/ (?=[×+-]|in )/);
  return parts.map((part, n) => [n > 0 ? " " : null, h("span.conversion-step", part)]);
}
