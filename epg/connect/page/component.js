// SPDX-License-Identifier: Apache-2.0
// The tab with the parameters of one component, and the buttons that add, copy, rename and remove components.

import { addComponent, copyComponent, removeComponent, renameComponent } from "./component_dialogs.js";
import { h, id, option } from "./dom.js";
import { formFields, formNotes, oneOfNotes } from "./form.js";
import { inline, shortFile } from "./problems.js";
import { attempt, change, say, ui } from "./ui.js";

/** @param {State} state */
export function componentPanel(state) {
  const { forms } = state;
  const names = componentNames(state);
  const name = names.includes(ui.component) ? ui.component : names[0];
  const kind = forms.values[`components.${name}.kind`]?.text;
  const locked = Boolean(forms.locked);
  const button = (text, action, enabled = true) =>
    h("button", { key: text, type: "button", disabled: locked || !enabled, onclick: () => action(name) }, text);
  return h("div.form", [
    h(
      "div.form-head",
      { key: "head" },
      names.length > 0 && [
        h("label", { key: "label", for: "component-choice" }, "Component"),
        h(
          "select",
          {
            key: "choice",
            id: "component-choice",
            value: name,
            onchange: (event) => change({ component: event.target.value }),
          },
          names.map((each) => option(each)),
        ),
      ],
      button("Copy", copyComponent, names.length > 0),
      button("Rename", renameComponent, names.length > 0),
      button("Remove", removeComponent, names.length > 0),
      h("span.space", { key: "space" }),
      button("Add a component", addComponent),
    ),
    formNotes(state),
    names.length === 0 && h("p.empty", { key: "none" }, "This target has no components yet."),
    names.length > 0 && parameters(state, name, kind),
    forms.left_out.length > 0 &&
      h(
        "p.form-note",
        { key: "left-out" },
        `Left out in ${shortFile(state.project.files.tcf)}: `,
        forms.left_out.map((each) => [
          h(
            "button.quiet",
            { key: each, type: "button", disabled: locked, onclick: () => bringBack(each) },
            `Bring ${each} back`,
          ),
          " ",
        ]),
      ),
  ]);
}

/** @param {State} state */
const componentNames = (state) =>
  Object.keys(state.forms.values)
    .filter((path) => path.startsWith("components.") && path.split(".").length === 2)
    .map((path) => path.split(".")[1]);

/** @param {State} state */
function parameters(state, name, kind) {
  const form = state.forms.kinds[kind];
  const base = ["components", name];
  if (!form)
    return h("div", { key: name }, inline(others(state, base, [])), h("p.empty", "EPG does not know its kind."));
  const first = form.fields.filter((field) => !field.section);
  const rest = form.fields.filter((field) => field.section);
  const section = `conversion-of-${name}`;
  return h(
    "section",
    { key: id("form", name), "aria-label": `Parameters of ${name}` },
    h("p.form-summary", h("b", name), ` (${kind}): ${form.summary}`),
    inline(others(state, base, form.fields)),
    oneOfNotes(form),
    h("div.form-fields", formFields(state, base, first)),
    rest.length > 0 &&
      h(
        "details",
        { key: section },
        h("summary", rest[0].section),
        h("div.form-fields", formFields(state, base, rest)),
      ),
  );
}

/**
 * The messages about a component that belong to none of its fields.
 * @param {State} state
 * @param {string[]} base
 * @param {Field[]} fields
 */
function others(state, base, fields) {
  const known = new Set();
  const visit = (/** @type {Field} */ field) => {
    known.add(field.path.join("."));
    field.fields?.forEach(visit);
  };
  fields.forEach(visit);
  const isBelow = (/** @type {Message} */ { path }) => path?.length >= 2 && path[0] === base[0] && path[1] === base[1];
  return state.diagnostics.filter((each) => isBelow(each) && !known.has(each.path.slice(2).join(".")));
}

async function bringBack(name) {
  if (!(await attempt("unset", { paths: [["components", name]] }))) return;
  change({ component: name });
  say(`${name} is back`);
  document.getElementById("component-choice")?.focus();
}
