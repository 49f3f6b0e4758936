// SPDX-License-Identifier: Apache-2.0
// The head of the page: project and target, the count of problems, "saved" or not, and the buttons for actions.

import { generate } from "./build.js";
import { chooseTarget } from "./chooser.js";
import { h } from "./dom.js";
import { icon } from "./icons.js";
import { counted, shortFile } from "./problems.js";
import { attempt, openTab } from "./ui.js";

export function header(state) {
  const brand = h("p.brand", { key: "brand" }, icon("target"), h("span", "EPG"));
  const close = h("button.quiet", { key: "close", onclick: () => attempt("done") }, "Close EPG");
  if (state.phase === "choose") {
    return [brand, h("p.title", { key: "title" }, "New project"), h("span.space", { key: "space" }), close];
  }
  const { draft, build } = state;
  const running = build.state === "running";
  return [
    brand,
    projectName(state),
    targetButton(state),
    problemsButton(state),
    h("span.space", { key: "space" }),
    h(
      "p",
      { class: `saved${draft.changed ? " unsaved" : ""}`, key: "saved", role: "status" },
      draft.changed ? "● Unsaved changes" : "Saved",
    ),
    h(
      "div.group",
      { key: "undo" },
      button("Undo", "Ctrl+Z", draft.can_undo, () => attempt("undo")),
      button("Redo", "Ctrl+Y", draft.can_redo, () => attempt("redo")),
    ),
    button("Save", "Ctrl+S", draft.changed && !draft.conflict, () => attempt("save")),
    running
      ? h("button", { key: "generate", class: "primary", onclick: () => attempt("cancel") }, "Cancel")
      : h("button", { key: "generate", class: "primary", onclick: generate }, "Generate"),
    close,
  ];
}

function button(text, keys, enabled, onclick) {
  return h(
    "button",
    { key: text, onclick, disabled: !enabled, title: keys, "aria-keyshortcuts": keys.replace("Ctrl", "Control") },
    text,
  );
}

function projectName(state) {
  const { name, folder, targets } = state.project;
  if (targets.length < 2) return h("h1.title", { key: "title", title: folder }, name);
  return h(
    "div.title",
    { key: "title" },
    h("h1.unseen", name),
    h(
      "select",
      {
        "aria-label": "Project",
        title: folder,
        value: name,
        onchange: (event) => attempt("open", { target: event.target.value }),
      },
      targets.map((each) => h("option", { key: each, value: each }, each)),
    ),
  );
}

function targetButton(state) {
  const chosen = state.configurations.find((each) => each.chosen);
  const name = chosen ? chosen.name : shortFile(state.project.files.tcf);
  return h(
    "button.target",
    { key: "target", onclick: chooseTarget, disabled: state.configurations.length === 0 || !state.editable },
    h("span.muted", "Target "),
    name,
  );
}

function problemsButton(state) {
  const { errors, warnings, text } = counted(state.diagnostics);
  return h(
    "button",
    {
      class: `quiet problems-count ${errors ? "error" : warnings ? "warning" : "done"}`,
      key: "problems",
      onclick: () => {
        openTab("problems");
        document.getElementById("tab-problems").focus();
      },
    },
    icon(errors ? "error" : warnings ? "warning" : "done"),
    text,
  );
}
