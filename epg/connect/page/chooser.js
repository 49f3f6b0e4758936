// SPDX-License-Identifier: Apache-2.0
// The dialog in which the user moves the project to another target: first the choice, then the list of all changes.

import { configurationCards } from "./configurations.js";
import { closeDialog, dialogButtons, openDialog } from "./dialog.js";
import { h } from "./dom.js";
import { icon } from "./icons.js";
import { shortFile } from "./problems.js";
import { current, getAnswer } from "./server.js";
import { attempt, draw, ui } from "./ui.js";

/** @type {Move | null} */
let move = null; // the changes for ui.chosen, null before they were asked for
/** @type {Refusal | null} */
let refused = null; // the reason why there are none
let waiting = false;

export function chooseTarget() {
  move = refused = null;
  waiting = false;
  ui.chosen = inUse();
  openDialog("target", "Target", () => (move || refused ? changes() : choice()));
}

const inUse = () => current().configurations.find((each) => each.chosen)?.name;

function choice() {
  return [
    configurationCards(current(), (each) => each.possible),
    dialogButtons(
      waiting ? "Comparing…" : "Show changes",
      { disabled: !ui.chosen || ui.chosen === inUse() || waiting, onclick: ask },
      h("p.muted", "The next step shows what changes, and what stays."),
    ),
  ];
}

async function ask() {
  waiting = true;
  draw();
  const answer = await getAnswer(`api/move?configuration=${encodeURIComponent(ui.chosen)}`);
  if (answer.message) refused = answer;
  else move = answer;
  waiting = false;
  draw();
  document.getElementById("move-title")?.focus();
}

function back() {
  move = refused = null;
  draw();
}

function changes() {
  return [
    h("h3", { id: "move-title", key: "title", tabindex: "-1" }, `From ${inUse()} to ${ui.chosen}`),
    refused
      ? h(
          "p.refusal",
          { key: "refused", role: "alert" },
          icon("error"),
          refused.message,
          refused.hint && ` ${refused.hint}`,
        )
      : listed(move),
    dialogButtons(
      "Change target",
      { disabled: Boolean(refused), onclick: change },
      h("button", { type: "button", onclick: back }, "Back"),
      h("p.muted", "One step, which you can undo. Files are written when you save."),
    ),
  ];
}

function change() {
  closeDialog();
  attempt("choose", { configuration: ui.chosen });
}

/** @param {Move} move */
function listed({ items, files }) {
  const of = (what) => items.filter((each) => each.what === what);
  const written = (files || []).filter((each) => each.what === "written");
  const asked = (files || []).filter((each) => each.what === "asked");
  const removed = (files || []).filter((each) => each.what === "removed");
  const isWired = of("changed").some((each) => each.key.includes(".pins."));
  return h(
    "div.move",
    { key: "move" },
    isWired &&
      h("p.caution", icon("warning"), "Disconnect the motor supply before you wire the new board: its pins differ."),
    group("To do by you", "error", [
      ...of("asked").map((each) => [each.key, each.reason]),
      files === null && ["project", "EPG has no files of a project for this platform: docs/cmake.md shows them"],
      ...asked.map((each) => [
        each.name,
        [
          "You have changed this file. EPG leaves it. Make these changes in it:",
          h("pre.diff", { tabindex: "0" }, each.lines),
        ],
      ]),
    ]),
    group("Changed", "note", [
      ...of("changed").map((each) => [
        each.key,
        [each.before && `${each.before} → `, h("b", each.after), reason(each)],
      ]),
      ...written.map((each) => [each.name, each.new ? "new file" : "new text: you have not changed this file"]),
    ]),
    group("Dropped", "warning", [
      ...of("dropped").map((each) => [each.key, [each.before, reason(each)]]),
      ...removed.map((each) => [each.name, "the new target does not need this file, and you have not changed it"]),
    ]),
    group("Kept", "done", [
      ...of("kept").map((each) => [each.key, each.before]),
      ["bindings", "all wires between the model and the components"],
    ]),
  );
}

const reason = (each) => (each.reason ? h("span.hint", each.reason) : null);

// A list of changes: [name, text] each. Nothing if it is empty.
function group(title, severity, rows) {
  const shown = rows.filter(Boolean);
  if (shown.length === 0) return null;
  return h(
    "section",
    { key: title, "aria-label": title },
    h("h4", icon(severity), `${title} `, h("span.count", String(shown.length))),
    h(
      "dl.move-list",
      shown.map(([name, text]) => [h("dt", breakable(name)), h("dd", text)]),
    ),
  );
}

const breakable = (name) =>
  shortFile(name)
    .split(".")
    .flatMap((part, n) => (n ? [h("wbr"), `.${part}`] : part));
