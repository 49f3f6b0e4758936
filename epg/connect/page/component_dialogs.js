// SPDX-License-Identifier: Apache-2.0
// The dialogs that add, copy, rename and remove a component.

import { closeDialog, dialogButtons, openDialog } from "./dialog.js";
import { h, id, refusalPart, textField } from "./dom.js";
import { control, groupSwitch, hint, label, oneOfNotes, words } from "./form.js";
import { act, current } from "./server.js";
import { draw, openTab, say, ui } from "./ui.js";

/** The titles of the groups of kinds, in the order of the list. A kind of another group is among the others. */
const GROUPS = {
  motion: "Motion",
  input: "Inputs",
  output: "Outputs",
  communication: "Communication",
  safety: "Safety",
  "": "Others",
};

/** First a list of the kinds, then the name and the required parameters of one. */
export function addComponent() {
  let chosen = null; // the kind
  let typed = {}; // the texts of the fields
  let error = null;

  const choose = (kind) => {
    chosen = kind;
    typed = { name: freeName(kind.split("_").at(-1)) };
    error = null;
    draw();
    document.getElementById("add-name")?.focus();
  };

  const apply = async (event) => {
    event.preventDefault();
    const form = current().forms.kinds[chosen];
    error = missing(form, typed);
    if (!error) {
      const { name, ...values } = typed;
      error = await act("add", { kind: chosen, name, values });
      if (!error) return added(name);
    }
    draw();
    document.getElementById("add-refusal")?.focus();
  };

  openDialog("add", "Add a component", () => {
    const { kinds } = current().forms;
    if (!chosen) return kindList(kinds, choose);
    const form = kinds[chosen];
    const isPins = (field) => field.name === "pins";
    const asked = form.fields.filter((field) => !isPins(field) && field.required && !oneOf(form).has(field.name));
    const alternatives = form.fields.filter((field) => oneOf(form).has(field.name));
    const ask = (field) => (field.type === "group" ? askedGroup(field, typed) : asker(field, typed));
    return h(
      "form",
      { key: chosen, onsubmit: apply, autocomplete: "off", novalidate: true },
      h("p", h("b", words(chosen)), `: ${form.summary}`),
      textField("add-name", "Name", {
        initial: typed.name,
        oninput: ({ target }) => (typed.name = target.value.trim()),
      }),
      asked.map(ask),
      oneOfNotes(form),
      alternatives.map(ask),
      form.fields.filter(isPins).map(ask),
      refusalPart(error, { id: "add-refusal", tabindex: "-1" }),
      h("p.muted", "All other parameters have defaults. You can change them afterwards."),
      dialogButtons("Add", {}, h("button", { type: "button", onclick: () => back() }, "Other kind")),
    );
  });

  const back = () => {
    const kind = chosen;
    chosen = null;
    draw();
    document.getElementById(id("kind", kind))?.focus();
  };
}

const oneOf = (form) => new Set(form.one_of.flatMap(({ names }) => names));

function kindList(kinds, choose) {
  const all = Object.entries(kinds);
  return Object.entries(GROUPS).map(([group, title]) => {
    const own = all.filter(([, form]) => (form.group in GROUPS ? form.group : "") === group);
    return (
      own.length > 0 &&
      h(
        "section",
        { key: group || "others", "aria-labelledby": id("group", title) },
        h("h3", { id: id("group", title) }, title),
        h(
          "ul.kind-list",
          own.map(([kind, form]) =>
            h(
              "li",
              { key: kind },
              h(
                "button.kind-choice",
                { id: id("kind", kind), type: "button", disabled: Boolean(form.unusable), onclick: () => choose(kind) },
                h("b", words(kind)),
                h("span.hint", form.summary),
                form.unusable && h("span.hint", form.unusable),
              ),
            ),
          ),
        ),
      )
    );
  });
}

function askedGroup(field, typed) {
  const pins = field.name === "pins";
  const name = id("add", ...field.path);
  const isOn = pins || field.required || field.name in typed;
  return h(
    "fieldset.field-group",
    { key: name },
    h(
      "legend",
      pins || field.required
        ? words(field.name)
        : groupSwitch(name, field, isOn, (on) => {
            for (const key of Object.keys(typed)) if (key.startsWith(`${field.name}.`)) delete typed[key];
            if (on) typed[field.name] = "{}";
            else delete typed[field.name];
            draw();
          }),
    ),
    pins
      ? h("span.hint", { id: `${name}-hint` }, "Empty: the first free pins that fit. You can move them afterwards.")
      : hint(name, field),
    isOn &&
      h(
        "div.form-fields",
        field.fields.map((each) => asker(pins ? { ...each, required: false } : each, typed)),
      ),
  );
}

function asker(field, typed) {
  const key = field.path.join(".");
  const name = id("add", ...field.path);
  const take = ({ target }) => {
    typed[key] = target.value.trim();
    if (target.localName === "select") draw();
  };
  const none = field.type === "reference" && field.choices.length === 0;
  return h(
    "div.field",
    { key: name },
    label(name, field),
    control(field, typed[key] || "", { id: name, "aria-describedby": `${name}-hint`, oninput: take }),
    hint(name, field),
    none && h("p.refusal", "No component fits yet: add that one first."),
  );
}

// The refusal of a form in which a required text is empty.
function missing(form, typed) {
  const given = (name) => Boolean(typed[name]);
  const empty = form.fields.find((field) => field.required && field.name !== "pins" && !given(field.name));
  if (empty) return { message: `'${words(empty.name)}' is empty`, hint: empty.description };
  for (const field of form.fields) {
    const lacks = given(field.name) && field.fields?.find((each) => each.required && !given(each.path.join(".")));
    if (lacks) return { message: `'${words(lacks.name)}' of '${words(field.name)}' is empty`, hint: lacks.description };
  }
  const none = form.one_of.find(({ names }) => !names.some(given));
  return none ? { message: `one of these must be set: ${none.names.map(words).join(", ")}`, hint: "" } : null;
}

function freeName(wanted) {
  const taken = new Set(Object.keys(current().forms.values).map((path) => path.split(".")[1]?.toLowerCase()));
  if (!taken.has(wanted)) return wanted;
  let number = 2;
  while (taken.has(`${wanted}_${number}`)) number++;
  return `${wanted}_${number}`;
}

function added(name) {
  ui.refused = null;
  closeDialog();
  ui.component = name;
  openTab("component");
  document.getElementById("component-choice")?.focus();
  const { values } = current().forms;
  const pins = Object.keys(values).filter((path) => path.startsWith(`components.${name}.pins.`));
  const where = pins.map((path) => `${path.split(".").at(-1)} ${values[path].text}`).join(", ");
  say(where ? `${name} is added with the pins ${where}` : `${name} is added`);
}

export function copyComponent(component) {
  nameDialog("copy", `Copy ${component}`, "Copy", freeName(`${component}_2`), component, [
    "The copy has the same parameters, and the first free pins that fit.",
  ]);
}

export function renameComponent(component) {
  const files = current().users[component]?.files || [];
  nameDialog("rename", `Rename ${component}`, "Rename", component, component, [
    "Wires, and the components and settings that name it, follow.",
    files.length > 0 && `These files name it, too; change them in an editor: ${files.join(", ")}.`,
  ]);
}

function nameDialog(action, title, submit, proposed, component, notes) {
  let name = proposed;
  let error = null;
  const apply = async (event) => {
    event.preventDefault();
    error = await act(action, { component, name });
    if (!error) return added(name);
    draw();
  };
  openDialog(action, title, () =>
    h(
      "form",
      { onsubmit: apply, autocomplete: "off", novalidate: true },
      textField("new-name", "Name", {
        initial: proposed,
        autofocus: true,
        oninput: ({ target }) => {
          name = target.value.trim();
        },
      }),
      notes.filter(Boolean).map((note) => h("p.muted", note)),
      refusalPart(error),
      dialogButtons(submit),
    ),
  );
}

export function removeComponent(component) {
  let error = null;
  const apply = async () => {
    error = await act("remove", { component });
    if (error) return draw();
    ui.refused = null;
    closeDialog();
    say(`${component} is removed. Undo brings it back.`);
    document.getElementById("component-choice")?.focus();
  };
  openDialog("remove", `Remove ${component}`, () => {
    const { ports = [], components = [], settings = [], files = [] } = current().users[component] || {};
    const lines = [
      ports.length && `Wires of these ports: ${ports.join(", ")}.`,
      components.length &&
        `Its name in these components, or all of a component that needs it: ${components.join(", ")}.`,
      settings.length && `These settings: ${settings.join(", ")}.`,
    ].filter(Boolean);
    return [
      lines.length ? h("p", "This also removes:") : h("p", "Nothing else uses it."),
      h(
        "ul.uses",
        lines.map((line) => h("li", line)),
      ),
      files.length > 0 && h("p", `These files name it, too, and are not changed: ${files.join(", ")}.`),
      h("p.muted", "One step of Undo brings everything back."),
      refusalPart(error),
      dialogButtons("Remove", { autofocus: true, onclick: apply }),
    ];
  });
}
