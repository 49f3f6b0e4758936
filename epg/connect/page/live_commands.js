// SPDX-License-Identifier: Apache-2.0
// Commands to a running target, with the error of the last one.

import { closeDialog, openDialog } from "./dialog.js";
import { h } from "./dom.js";
import { page, stateOf, tell } from "./live_events.js";
import { interrupted, saveFrom } from "./save.js";
import { ask, current } from "./server.js";
import { draw, say } from "./ui.js";

const SHOWN = 500; // ms after an answer until the page has also got the new state

let unanswered = 0;
let refused = interrupted();
let made = ""; // the form of the file that is being made

// True while the target has not answered a command that may have enabled it.
export const isUnanswered = () => unanswered > 0;

export const refusal = () => refused;

// "csv" or "mcap" while such a file is being made, else empty.
export const isMade = () => made;

// Saves a file with the newest rows (`what` is "stream") or with the last recording ("capture").
export async function save(what, form, name) {
  refused = null;
  made = form;
  draw();
  refused = await saveFrom(`api/live/save?what=${what}&as=${form}`, name);
  made = "";
  if (refused) say(`${refused.message}. ${refused.hint}`);
  draw();
}

export async function request(action, body) {
  const moves = action === "enable" || /^\s*(enable|jog)\b/.test(body?.line ?? "") ? 1 : 0;
  unanswered += moves;
  const answer = await ask(action, body);
  setTimeout(() => {
    unanswered -= moves;
  }, SHOWN);
  refused = answer.error ?? null;
  if (refused) say(`Refused: ${refused.message}`);
  draw();
  return answer;
}

const UNATTENDED =
  "The robot stays enabled if this page, this computer or the cable fails. Then only its supply stops it.";
const MUCH = 10; // times the generated value of a parameter that has no limits

// Sends a line of the console, and returns true if the target has done it. `enable` is on a lease. The user must agree
// before a robot is enabled without one, and before a parameter gets a value far above the one of the bindings.
export async function command(line) {
  const unattended = /^\s*enable\s+unattended\s*$/.test(line);
  const much = tooMuch(line);
  if (unattended && !(await agrees("Enable unattended?", "Enable unattended", [UNATTENDED]))) return false;
  if (much.length && !(await agrees("Set these parameters?", "Set", much))) return false;
  const target = current().live.target;
  if (!target) return false; // the connection has ended while the user decided
  const after = stateOf(target).stop ?? "";
  const { answer, error } = await request("command", { page, line, after, unattended });
  tell([`> ${line}`, ...(answer ?? [`error ${error.message}`])]);
  draw();
  return !error;
}

// Sentences about the parameters of a command `set` that get a value far above the generated one, and have no limit there.
function tooMuch(line) {
  const [first, ...words] = line.trim().split(/\s+/);
  if (first !== "set") return [];
  const { parameters } = current().live.target;
  return words.flatMap((word) => {
    const at = word.lastIndexOf("=");
    const found = parameters.find((each) => each.name === word.slice(0, at));
    const value = Number(word.slice(at + 1));
    if (!found || !(Math.abs(value) > MUCH * Math.abs(found.generated))) return [];
    if ((value > 0 ? found.high : found.low) !== null) return [];
    return [
      `${found.name} becomes ${value} ${found.unit}`.trimEnd() +
        `; the firmware was generated with ${found.generated}.`,
    ];
  });
}

// Asks the user. The answer is true when the user agrees, and never comes when the dialog is closed.
function agrees(title, yes, sentences) {
  return new Promise((answer) => {
    const agree = () => {
      closeDialog();
      answer(true);
    };
    openDialog("agree", title, () => [
      sentences.map((each) => h("p", each)),
      h(
        "div.buttons",
        h("button", { type: "button", onclick: closeDialog }, "Cancel"),
        h("button", { type: "button", class: "primary", onclick: agree }, yes),
      ),
    ]);
  });
}
