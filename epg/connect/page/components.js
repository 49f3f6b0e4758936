// SPDX-License-Identifier: Apache-2.0
// The columns of components: ports of one direction, with the component's pins, peripheral and topic.

import { addComponent } from "./component_dialogs.js";
import { h, id } from "./dom.js";
import { openField } from "./form.js";
import { componentLabel, handle, match } from "./handles.js";
import { icon } from "./icons.js";
import { inline } from "./problems.js";
import { unitMark } from "./wiring.js";

/**
 * @param {State} state
 * @param {Map<string, Message[]>} diagnostics
 * @param {Map<string, User[]>} users
 */
export function componentColumn(state, side, diagnostics, users) {
  const direction = side === "sources" ? "source" : "sink";
  const shown = state.components.filter((component) => component.ports.some((port) => port.direction === direction));
  // Components without ports, such as a motion guard, are last on the left, so that their messages have a place.
  const without = side === "sources" ? state.components.filter((component) => component.ports.length === 0) : [];
  return h(
    "section",
    { class: `components ${side}`, key: side, "aria-labelledby": `title-${side}` },
    h("h2", { id: `title-${side}` }, side === "sources" ? "From the target" : "To the target"),
    shown.length + without.length === 0 && h("p.empty", "No components."),
    [...shown, ...without].map((component) => card(state, side, component, direction, diagnostics, users)),
    side === "sources" &&
      h(
        "button.add-component",
        { key: "add", type: "button", disabled: Boolean(state.forms.locked), onclick: addComponent },
        icon("plus"),
        " Add a component",
      ),
  );
}

/**
 * @param {State} state
 * @param {Component} component
 * @param {Map<string, Message[]>} diagnostics
 * @param {Map<string, User[]>} users
 */
function card(state, side, component, direction, diagnostics, users) {
  const { name, kind, summary, where, peripheral, topic } = component;
  const ports = component.ports.filter((port) => port.direction === direction);
  const first = direction === "source" || component.ports.every((port) => port.direction === direction);
  const pins = where?.length ? where.map((pin) => [h("span.pin", pin), " "]) : null;
  const facts = [pins, peripheral, topic].filter(Boolean);
  return h(
    "article.component",
    { key: name, "aria-label": `component ${name}` },
    h(
      "div.component-head",
      h(
        "button.component-name",
        { type: "button", title: "Show its parameters", onclick: () => openField(["components", name]) },
        name,
      ),
      h("span.kind", { title: summary || null }, kind.replace(/_/g, " ")),
    ),
    facts.length &&
      (first || ports.length === 0) &&
      h(
        "ul.facts",
        facts.map((fact) => h("li", fact)),
      ),
    ports.length &&
      h(
        "ul.port-list",
        ports.map((port) => row(state, side, port, users.get(port.reference) || [])),
      ),
    ports.length === 0 || first ? inline(diagnostics.get(name) || []) : null,
  );
}

/**
 * @param {State} state
 * @param {ComponentPort} port
 * @param {User[]} users
 */
function row(state, side, port, users) {
  const { reference, name } = port;
  const converted = users.find((user) => user.end.from_tcf)?.end.from_tcf;
  return h(
    "li",
    {
      class: `port ${match(state, side, reference)}`,
      key: reference,
      "data-drop": "",
      "data-side": side,
      "data-name": reference,
      "data-wire-component": id("at", reference),
    },
    handle(side, reference, componentLabel(side, port, users), users.length > 0),
    h("span.port-name", { title: port.summary || null }, name),
    unitMark(port),
    converted && h("span.tcf-label", { key: "tcf", title: "The .tcf converts this value" }, ".tcf: ", converted),
  );
}
