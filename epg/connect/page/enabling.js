// SPDX-License-Identifier: Apache-2.0
// The button that enables a running target: it must be held, and works only while this page answers in time. Beside it
// stand the places where the robot will move, and the times of the answers.

import { h } from "./dom.js";
import { request } from "./live_commands.js";
import { isOld, live, page, stateOf } from "./live_events.js";
import { held } from "./press.js";
import { isEnabled } from "./robot.js";
import { ask } from "./server.js";

const HOLD = 500; // ms that the button must be pressed
const THIN = 125; // ms of an answer: half of the lease of 300 ms, less the 50 ms between two numbers

// Where enabling will move the robot: the values of the setpoints at that moment.
/** @param {LiveSetpoint[]} setpoints */
const goals = (setpoints) =>
  setpoints.flatMap(({ name, unit, follows, fresh, starts }) => {
    if (follows) return [`${name} stays where it is`];
    if (starts === null) return [];
    return [fresh ? `${name} begins at ${starts} ${unit}` : `will move to ${starts} ${unit} (${name})`];
  });

/** @param {LiveTarget} target */
export function goalsPart(target) {
  const found = goals(target.setpoints);
  if (isEnabled(target) || !found.length) return null;
  return h("p.hint", { key: "goals", id: "enable-goals" }, `Enable: ${found.join(", ")}.`);
}

/** @param {LiveTarget} target */
export function enablePart(target) {
  const begin = () => stateOf(target).stop ?? "";
  const enable = (after) => request("enable", { page, after });
  const blocked = isEnabled(target) || !target.matches || !live.inTime || isOld();
  return h(
    "button.hold",
    {
      key: "enable",
      disabled: blocked,
      "aria-describedby": "enable-goals enable-answers",
      onpointerenter: () => ask("look"),
      onfocus: () => ask("look"),
      ...held(begin, enable, HOLD),
    },
    "Enable (hold)",
  );
}

// The time that this page needs to answer, and what to close if the margin is thin.
/** @param {LiveTarget} target */
export function answersPart(target) {
  if (isEnabled(target) || !target.matches) return null;
  const ms = Math.round(1000 * (live.worst ?? 0));
  const close = "show fewer plots, close other tabs and windows, and end other programs";
  const text = isOld()
    ? "Enable waits for values of the target."
    : !live.inTime
      ? `Enable waits for 40 answers of this page in time${ms > THIN ? ` (up to ${ms} ms): ${close}` : ""}.`
      : ms > THIN
        ? `The margin is thin: answers of this page take up to ${ms} ms of the lease of 300 ms: ${close}.`
        : `Answers of this page take up to ${ms} ms of the lease of 300 ms.`;
  return h("p", { key: "answers", id: "enable-answers", class: ms > THIN ? "alarm" : "hint" }, text);
}
