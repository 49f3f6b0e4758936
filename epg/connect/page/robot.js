// SPDX-License-Identifier: Apache-2.0
// The bar of a connected robot, above everything else on the page: its state, and the button that stops it. While the
// robot may move, space and Escape stop it, too, wherever the focus is. While it is enabled they do nothing else. While the
// page does not know its state, they also do what they do on the element that has the focus.

import { h } from "./dom.js";
import { icon } from "./icons.js";
import { isUnanswered } from "./live_commands.js";
import { age, isOld, stateOf } from "./live_events.js";
import { isPressed } from "./press.js";
import { askRepeatedly, current } from "./server.js";
import { draw } from "./ui.js";

const AGAIN = 500; // ms after which a Stop without a confirmation is sent again, and the user is warned

const order = askRepeatedly("stop", 2);

let trying = 0; // the timer of a Stop that is not confirmed
let late = false; // it has not been confirmed for AGAIN

// Disables the target. It has a connection of its own (see server.js), and is never behind other requests.
function stop() {
  send();
  if (trying) return;
  trying = window.setInterval(() => {
    late = true;
    send();
    draw();
  }, AGAIN);
}

async function send() {
  const answer = await order();
  if (answer && !answer.error) end();
}

function end() {
  window.clearInterval(trying);
  trying = 0;
  late = false;
  draw();
}

/** @param {LiveTarget} target */
export const isEnabled = (target) => stateOf(target).enabled === "1";

// True if the target is enabled without a lease, so that it stays enabled without this page.
/** @param {LiveTarget} target */
export const isUnattended = (target) => isEnabled(target) && stateOf(target).leased !== "1";

// True if the robot is enabled by the newest news of it, or if the user is just enabling or moving it.
function isActive() {
  const { target, lost } = current()?.live ?? {};
  if (target) return isEnabled(target) || isPressed() || isUnanswered();
  return lost?.state.enabled === "1";
}

// True if the robot may move, as far as the page knows.
const mayMove = () => isActive() || trying > 0 || (Boolean(current()?.live?.target) && isOld());

/** @param {State} state */
export function robotBar(state) {
  const { target, lost } = state.live ?? {};
  if (!target && !lost) {
    if (trying) end(); // the user has left the target
    return null;
  }
  const unknown = !target || isOld();
  const moves = mayMove();
  return [
    h(
      "button",
      { key: "stop", class: "stop", title: "Space bar or Escape", onpointerdown: stop, onclick: stop },
      "Stop robot",
    ),
    h(
      "p",
      {
        key: "state",
        class: unknown || (target && isUnattended(target)) ? "alarm" : moves ? "live-enabled" : "",
        role: "status",
      },
      h("b", (target ?? lost).name),
      ` ${target ? stateText(target) : lostText(lost.state)}`,
    ),
    late &&
      h(
        "p.alarm",
        { key: "late", role: "alert" },
        icon("error"),
        h("b", "Stop was NOT confirmed: switch the supply off."),
        " The page goes on trying.",
      ),
  ];
}

/** @param {LiveTarget} target */
function stateText(target) {
  const { by } = stateOf(target);
  const state = isUnattended(target)
    ? "enabled unattended: it stays enabled without this page"
    : isEnabled(target)
      ? "enabled"
      : `disabled${by ? `, stopped by ${by}` : ""}`;
  if (!isOld()) return state;
  return `values are old: no news for ${Math.floor(age())} s. It was ${state}`;
}

/** @param {Record<string, string>} words */
function lostText(words) {
  if (words.enabled !== "1") return "is not connected any more";
  return words.leased === "1"
    ? "is not connected any more. It was enabled on a lease, which has ended if the target works"
    : "is not connected any more. It was enabled unattended, and can still move";
}

const held = new Set(); // the keys whose press stops the robot and does nothing else

for (const type of ["keydown", "keyup"]) window.addEventListener(type, stopKey, { capture: true });

// While the robot is enabled, the keys do nothing but stop it, also until they are released.
function stopKey(event) {
  const { key, code, repeat, type } = event;
  if (key !== " " && code !== "Space" && key !== "Escape") return;
  if (type === "keydown" && !repeat) {
    held.delete(code);
    if (isActive()) held.add(code);
    if (mayMove()) stop();
  }
  if (!held.has(code)) return;
  event.preventDefault();
  event.stopImmediatePropagation();
  if (type === "keyup") held.delete(code);
}
