// SPDX-License-Identifier: Apache-2.0
// "Flash": writes the firmware to a board, after the user has confirmed the board and the file.

import { failureText, logPart, messagesPart, outcomePart, running } from "./activity.js";
import { dialogButtons, openDialog } from "./dialog.js";
import { h } from "./dom.js";
import { shortFile } from "./problems.js";
import { current } from "./server.js";
import { attempt, draw } from "./ui.js";

let chosen = ""; // the id of the chosen board

/** @param {State} state */
export function flashButton(state) {
  const { products } = state.build;
  if (!products.length || products.some((each) => each.runs)) return null;
  return h(
    "p.flash-row",
    { key: "flash" },
    h("button.primary", { disabled: Boolean(running(state)), onclick: () => look(false) }, "Flash …"),
    h("span.muted", "writes the firmware to a board that is connected to this computer"),
  );
}

// Looks for boards, and asks for a confirmation. With `replace`, the program of another target is overwritten.
async function look(replace) {
  chosen = "";
  if (await attempt("flash")) openDialog("flash", "Write the firmware to a board?", () => question(replace));
}

function question(replace) {
  const { boards } = current().flash;
  if (!boards) return null;
  const again = h("button", { type: "button", onclick: () => attempt("flash") }, "Look again");
  if (!boards.found.length) {
    const problem = `${boards.problem[0].toUpperCase()}${boards.problem.slice(1)}.`;
    return [
      h("p", { key: "problem" }, h("b", problem), h("span.hint", boards.hint)),
      h("div.buttons", { key: "buttons" }, h("span.space"), again),
    ];
  }
  const only = boards.found.length === 1 ? boards.found[0] : null;
  const board = boards.found.find((each) => each.id === chosen) || only;
  return [
    only ? h("p", { key: "board" }, "Board: ", h("b", only.shown)) : choice(boards.found),
    board && h("p", { key: "file" }, "File: ", h("code", { title: board.file }, shortFile(board.file))),
    current().draft.changed &&
      h(
        "p",
        { key: "stale" },
        h("b", "It does not have your unsaved changes. "),
        "To write them, press Generate first.",
      ),
    h(
      "p",
      { key: "safety" },
      "The program that is on the board now is overwritten. Disconnect the supply of the motors first. ",
      "Flash does not enable the target: after its start it is as enable_at_start in the .tcf says.",
    ),
    dialogButtons(
      replace ? "Replace the other program" : "Write to this board",
      { disabled: !board, onclick: () => attempt("flash", { board: board.id, replace }) },
      again,
    ),
  ];
}

/** @param {FlashRun["boards"]["found"]} found */
function choice(found) {
  const pick = (event) => {
    chosen = event.target.value;
    draw();
  };
  return h(
    "fieldset",
    { key: "board" },
    h("legend", `${found.length} boards are connected. Which one?`),
    found.map((each) =>
      h(
        "label.which",
        { key: each.id },
        h("input", { type: "radio", name: "board", value: each.id, checked: each.id === chosen, onchange: pick }),
        each.shown,
      ),
    ),
  );
}

/** @param {State} state */
export function flashOutcome({ flash }) {
  const what = `${flash.file.split(/[\\/]/).pop()} to ${flash.board}`;
  return {
    idle: "Nothing has been written yet.",
    running: flash.step === "find" ? `Looking at ${flash.board}` : `Writing ${what}`,
    done: `Wrote ${what}. The board has restarted.`,
    failed: failureText(flash),
    cancelled: "Cancelled. The board may have no complete program: flash it again.",
  }[flash.state];
}

/** @param {State} state */
export function flashPart(state) {
  const { flash } = state;
  if (flash.state === "idle") return null;
  return h(
    "section",
    { key: "flashing", "aria-label": "Flash" },
    outcomePart(flash, flashOutcome(state)),
    messagesPart(flash, "Messages about the board", () => look(false)),
    flash.can_replace &&
      h("p.flash-row", { key: "replace" }, h("button", { onclick: () => look(true) }, "Replace the other program …")),
    logPart("flash", flash, "Output"),
  );
}
