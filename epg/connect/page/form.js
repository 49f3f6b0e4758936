// SPDX-License-Identifier: Apache-2.0
// The fields of a form: one for each value that a .tcf can have, with its description, its place and its messages.

import { h, id, option } from "./dom.js";
import { inline, shortFile } from "./problems.js";
import { current } from "./server.js";
import { attempt, openTab, say, ui } from "./ui.js";

export const words = (name) => name.replaceAll("_", " ");

// The names of the model's parameters stay as they are in the model.
/** @param {Field} field */
const titleOf = (field) => (field.path[0] === "parameters" ? field.name : words(field.name));

// The model's parameters are in the bindings, which can be changed although the .tcf cannot.
/**
 * @param {State} state
 * @param {Field} field
 */
const isLocked = (state, field) => (field.path[0] === "parameters" ? !state.editable : Boolean(state.forms.locked));

/**
 * The fields of the values below `base`.
 * @param {State} state
 * @param {string[]} base
 * @param {Field[]} fields
 */
export function formFields(state, base, fields) {
  return fields.map((field) => (field.type === "group" ? group(state, base, field) : row(state, base, field)));
}

/**
 * @param {State} state
 * @param {string[]} base
 * @param {Field} field
 */
function row(state, base, field) {
  const path = [...base, ...field.path];
  const value = state.forms.values[path.join(".")];
  const messages = messagesAt(state, path);
  const name = id("field", ...path);
  return h(
    "div.field",
    { key: name, class: messages.length ? "field has-error" : "field" },
    label(name, field),
    control(field, value?.text || "", {
      id: name,
      disabled: isLocked(state, field) || value?.how === "call",
      "aria-describedby": `${name}-hint`,
      onchoose: (text) => fill(path, text.trim()),
    }),
    hint(name, field),
    place(state, path, field, value),
    inline(messages),
  );
}

/** The messages about exactly the value at `path`. */
const messagesAt = (state, path) => state.diagnostics.filter((each) => each.path?.join(".") === path.join("."));

/**
 * The fields of which a component must set one.
 * @param {KindForm} form
 */
export const oneOfNotes = (form) =>
  form.one_of.map(({ names, several }) =>
    h(
      "p.muted",
      { key: names.join() },
      `Set ${several ? "one or several" : "one"} of: ${names.map(words).join(", ")}.`,
    ),
  );

/**
 * Notes above a form: the reason why it cannot be changed, and the other targets that a change touches.
 * @param {State} state
 */
export function formNotes(state) {
  const { locked, shared } = state.forms;
  const file = shortFile(state.project.files.tcf);
  return [
    locked && h("p.form-note", { key: "locked" }, locked),
    shared.length > 0 &&
      h(
        "p.form-note",
        { key: "shared" },
        `A change of ${file} touches these targets, too: ${shared.join(", ")}. `,
        "Saving checks them first.",
      ),
  ];
}

/**
 * A group of values that belong together. If no value of it is required, a box switches all of them off and on.
 * @param {State} state
 * @param {string[]} base
 * @param {Field} field
 */
function group(state, base, field) {
  const path = [...base, ...field.path];
  const value = state.forms.values[path.join(".")];
  const always = field.name === "pins";
  const isOn = always || Boolean(value && !value.removed);
  const name = id("field", ...path);
  return h(
    "fieldset.field-group",
    { key: name, disabled: Boolean(state.forms.locked) },
    h("legend", always ? words(field.name) : groupSwitch(name, field, isOn, (on) => fill(path, on ? "{}" : ""))),
    hint(name, field),
    inline(messagesAt(state, path)),
    isOn && h("div.form-fields", formFields(state, base, field.fields)),
    !isOn && place(state, path, field, value),
  );
}

/** The box that switches a group of values on and off, with the group's name. */
export function groupSwitch(name, field, isOn, onswitch) {
  return h(
    "label.check",
    h("input", {
      type: "checkbox",
      id: name,
      checked: isOn,
      "aria-describedby": `${name}-hint`,
      onchange: (event) => onswitch(event.target.checked),
    }),
    words(field.name),
  );
}

/** @param {Field} field */
export function label(name, field) {
  const marks = field.required ? h("span.muted", " (required)") : null;
  return h("label", { for: name }, titleOf(field), marks);
}

/** @param {Field} field */
export function hint(name, field) {
  const unit = field.units ? `${field.units.slice(0, -1).join(", ")} or ${field.units.at(-1)}` : "";
  const parts = [
    field.type !== "pin" && field.description,
    field.limits,
    unit && `a number with ${unit}`,
    field.example && `for example ${field.example}`,
  ];
  return h("span.hint", { id: `${name}-hint` }, parts.filter(Boolean).join("; "));
}

/**
 * The input of one value. An empty text means the default. `onchoose` is called with a text that is complete.
 * @param {Field} field
 * @param {Record<string, any>} attributes
 */
export function control(field, text, attributes) {
  const choices = field.type === "boolean" ? ["true", "false"] : field.choices;
  if (!choices) {
    const placeholder = field.default ? `default: ${field.default}` : null;
    return h("input", {
      type: "text",
      key: "control",
      spellcheck: "false",
      autocomplete: "off",
      initial: text,
      placeholder,
      onchange: ({ target }) => attributes.onchoose?.(target.value),
      ...attributes,
    });
  }
  const none = field.default ? `default: ${field.default}` : field.required ? "(choose)" : "(none)";
  const listed = text && !choices.includes(text) ? [text, ...choices] : choices;
  return h("select", { key: "control", value: text, ...attributes }, [
    option("", none),
    listed.map((each) => option(each)),
  ]);
}

/**
 * The file of a value, and the way back to the value that holds without the project's own file.
 * @param {State} state
 * @param {string[]} path
 * @param {Field} field
 * @param {Value | undefined} value
 */
function place(state, path, field, value) {
  if (!value) return null;
  const { back } = value;
  const text = { own: "in", file: "from", epg: "from EPG's", call: "set in" }[value.how];
  const nameOf = ({ how, file }) => (how === "epg" ? file.split(/[\\/]/).pop() : shortFile(file));
  const where = `${text} ${nameOf(value)}, line ${value.line}`;
  const to = back ? `${back.text} (${nameOf(back)})` : field.default ? `default ${field.default}` : "no value";
  return h(
    "p.origin",
    { key: "origin" },
    h("span", { title: value.file }, value.removed ? `left out ${where}` : where),
    value.own &&
      (back || !field.required) &&
      h(
        "button.quiet",
        {
          key: "back",
          type: "button",
          disabled: isLocked(state, field),
          "aria-label": `Take ${titleOf(field)} back to ${to}`,
          onclick: () => takeBack(path),
        },
        `Back to ${to}`,
      ),
  );
}

async function fill(path, text) {
  if (await attempt("fill", { changes: [{ path, text }] })) report(path);
}

async function takeBack(path) {
  if (!(await attempt("take_back", { path }))) return;
  report(path);
  document.getElementById(id("field", ...path))?.focus();
}

// Tells a screen reader the value in the files, and the first message about it.
function report(path) {
  const state = current();
  const value = state.forms.values[path.join(".")];
  const [message] = messagesAt(state, path);
  const shown = value && !value.removed ? value.text : "default";
  say(message ? `${message.severity}: ${message.message}` : `${words(path.at(-1))}: ${shown}`);
}

/**
 * Shows the field of the value at `path`. Returns false if there is none.
 * @param {string[]} path
 */
export function openField(path) {
  const ofComponent = path[0] === "components" && path.length > 1;
  if (ofComponent) ui.component = path[1];
  openTab(ofComponent ? "component" : "settings");
  for (let length = path.length; length > 0; length--) {
    const field = document.getElementById(id("field", ...path.slice(0, length)));
    if (!field) continue;
    field.scrollIntoView({ block: "center" });
    field.focus();
    return true;
  }
  if (ofComponent) document.getElementById("component-choice")?.focus();
  return ofComponent;
}
