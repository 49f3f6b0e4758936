// SPDX-License-Identifier: Apache-2.0
// The head of the page: project and target, the count of problems, "saved" or not, and the buttons for actions.

import { running } from "./activity.js";
import { generate } from "./build.js";
import { chooseTarget } from "./chooser.js";
import { closeDialog, dialogButtons, openDialog } from "./dialog.js";
import { h, option } from "./dom.js";
import { icon } from "./icons.js";
import { counted, shortFile } from "./problems.js";
import { current } from "./server.js";
import { simulate } from "./simulation.js";
import { backToSystem } from "./system.js";
import { attempt, openTab } from "./ui.js";

const STOP = { build: "Cancel", simulation: "Stop", program: "End program", flash: "Cancel", comparison: "Cancel" };

/** @param {State} state */
export function header(state) {
  const brand = h("p.brand", { key: "brand" }, icon("target"), h("span", "EPG"));
  const close = h("button.quiet", { key: "close", onclick: () => askToClose(state) }, "Close EPG");
  if (state.phase === "choose") {
    return [brand, h("p.title", { key: "title" }, "New project"), h("span.space", { key: "space" }), close];
  }
  const space = h("span.space", { key: "space" });
  if (state.phase === "system") {
    const name = h("h1.title", { key: "title", title: state.project.folder }, `System ${state.project.name}`);
    return [brand, name, problemsButton(state), space, close];
  }
  const { draft } = state;
  return [
    brand,
    state.project.system && backButton(state.project.system),
    projectName(state),
    targetButton(state),
    problemsButton(state),
    space,
    h(
      "p",
      { class: `saved${draft.changed ? " unsaved" : ""}`, key: "saved", role: "status" },
      draft.changed ? "● Unsaved" : "Saved",
    ),
    h(
      "div.group",
      { key: "undo" },
      button("Undo", "Ctrl+Z", draft.can_undo, () => attempt("undo")),
      button("Redo", "Ctrl+Y", draft.can_redo, () => attempt("redo")),
    ),
    button("Save", "Ctrl+S", draft.changed && !draft.conflict, () => attempt("save")),
    runButtons(state),
    close,
  ];
}

// A build may run beside a program: only then it does not take the place of the button that ends what runs.
/** @param {State} state */
function runButtons(state) {
  const now = running(state);
  const end = (attributes) => h("button", { ...attributes, onclick: () => attempt("cancel") }, STOP[now]);
  if (now && now !== "program") return end({ key: "generate", class: "primary" });
  return [
    now
      ? end({ key: "simulate" })
      : h("button", { key: "simulate", title: "Run it on this computer", onclick: simulate }, "Simulate"),
    h("button", { key: "generate", class: "primary", title: "Build the firmware", onclick: generate }, "Generate"),
  ];
}

// Closes EPG. If there are unsaved changes, the user first decides about them.
/** @param {State} state */
function askToClose(state) {
  if (!state.draft?.changed) return attempt("done");
  const save = async () => {
    closeDialog();
    if (await attempt("save")) await attempt("done");
  };
  const discard = () => {
    closeDialog();
    attempt("done");
  };
  openDialog("close", "Close EPG", () => [
    h("p", "There are unsaved changes. The tab Changes shows them."),
    dialogButtons(
      "Save and close",
      { onclick: save, disabled: Boolean(current().draft.conflict) },
      h("button", { type: "button", onclick: discard }, "Close without saving"),
    ),
  ]);
}

function button(text, keys, enabled, onclick) {
  return h(
    "button",
    { key: text, onclick, disabled: !enabled, title: keys, "aria-keyshortcuts": keys.replace("Ctrl", "Control") },
    text,
  );
}

/** @param {string} system */
function backButton(system) {
  const label = `Back to the system ${system}`;
  return h("button.quiet", { key: "back", "aria-label": label, title: label, onclick: backToSystem }, `← ${system}`);
}

/** @param {State} state */
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
        onchoose: (value) => attempt("open", { target: value }),
      },
      targets.map((each) => option(each)),
    ),
  );
}

/** @param {State} state */
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

/** @param {State} state */
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
