// SPDX-License-Identifier: Apache-2.0
// What builds, simulations and other runs have in common: consent, progress, messages and log. Only one runs at a
// time; a build and a comparison may run beside a program.

import { copyButton } from "./copy.js";
import { openDialog } from "./dialog.js";
import { h, plural } from "./dom.js";
import { icon } from "./icons.js";
import { isError, problem } from "./problems.js";
import { current, getJson } from "./server.js";
import { attempt, draw, openTab, say, ui } from "./ui.js";

/**
 * @typedef {"build" | "simulation" | "program" | "flash" | "comparison"} Name
 * @typedef {{lines: string[], fetching: boolean, open: boolean}} Log
 */

/** @type {Name[]} */
const NAMES = ["comparison", "build", "simulation", "program", "flash"]; // keys of the state

/** @type {Record<Name, string>} */
const TABS = { build: "build", simulation: "simulation", program: "build", flash: "build", comparison: "live" };

/** @type {Record<string, Log>} */
const logs = Object.fromEntries(NAMES.map((name) => [name, { lines: [], fetching: false, open: false }]));
const last = Object.fromEntries(NAMES.map((name) => [name, "idle"])); // the last states
let since = null; // {seconds, at}: the age of what runs in the last state, and the time when that state arrived, in ms

/**
 * The name of what runs now in the state, or undefined.
 * @param {State} state
 */
export const running = (state) => NAMES.find((name) => state[name].state === "running");

/**
 * Starts `action`. Before the first time, the user sees the commands, and may agree to them.
 * @param {Name} name
 * @param {"generate" | "simulate" | "run" | "compare"} action
 * @param {object} body
 */
export async function begin(name, action, body) {
  openTab(TABS[name]);
  if (!(await attempt(action, body))) return;
  const ask = current()[name].ask;
  if (!ask) return;
  const wires = Object.keys(ask.wires).length;
  const title = ask.commands.length ? "Run these commands?" : `Connect ${plural(wires, "port")}?`;
  openDialog("run", title, () => question(name, action, body));
}

// The question with the commands that will run, and with proposed wires. Returns null, which closes the dialog, after
// the user has agreed.
function question(name, action, body) {
  const { ask } = current()[name];
  if (!ask) return null;
  const wires = Object.entries(ask.wires);
  return [
    wires.length && h("p", { key: "intro" }, "These ports are not connected yet. EPG connects them by their names:"),
    wires.length &&
      h(
        "ul",
        { key: "wires" },
        wires.map(([port, end]) => h("li", h("code", port), " – ", h("code", end))),
      ),
    ask.commands.length && commands(ask),
    h(
      "button",
      {
        key: "run",
        type: "button",
        class: "primary",
        onclick: () => attempt(action, { ...body, run: ask.key, ...(wires.length ? { accept: true } : {}) }),
      },
      wires.length ? "Connect and run" : "Run",
    ),
  ];
}

/** @param {Ask} ask */
function commands(ask) {
  return [
    h("p", { key: "folder" }, "These commands run in ", h("code", ask.folder), ":"),
    h("pre.commands", { key: "commands", tabindex: "0", "aria-label": "Commands" }, ask.commands.join("\n")),
    h(
      "p",
      { key: "programs" },
      `They start ${ask.programs.join(", ")}, and all programs that these start for the project. `,
      "They have your rights: run them only for a project that you trust. EPG asks once for each folder and program.",
    ),
  ];
}

// Must be called with every new state. Announces the end of what ran, and fetches new lines of an open log.
/**
 * @param {State} state
 * @param {Record<string, (state: State) => string>} outcomes  the texts about them
 */
export function followActivities(state, outcomes) {
  for (const name of NAMES) {
    const activity = state[name];
    if (activity.state === "running") since = { seconds: activity.seconds, at: performance.now() };
    if (activity.state !== last[name]) {
      if (activity.state === "running") {
        logs[name].lines = [];
        // Another tab or program can have started it. The buttons for a robot must not vanish for that.
        if (ui.tab !== "live" || !state.live?.target) ui.tab = TABS[name];
      }
      if (last[name] === "running") say(outcomes[name](state));
      last[name] = activity.state;
    }
    fetchLog(name);
  }
}

/** @param {Name} name */
async function fetchLog(name) {
  const log = logs[name];
  if (log.fetching || !log.open || log.lines.length >= current()[name].lines) return;
  log.fetching = true;
  const known = log.lines; // a new run begins with another list
  try {
    const answer = await getJson(`api/log?of=${name}&from=${known.length}`);
    known.push(...answer.lines);
  } catch {
    // The notice about the lost connection is shown already.
  }
  log.fetching = false;
  draw();
}

/**
 * The title of a tab.
 * @param {string} name
 * @param {Activity} activity
 */
export function activityTitle(name, activity) {
  const mark = { idle: "", running: " …", done: " ✓", failed: " ✕", cancelled: "" }[activity.state];
  return `${name}${mark}`;
}

/**
 * The text about a run, its progress, and the time.
 * @param {Activity} activity
 * @param {string} text
 */
export function outcomePart(activity, text) {
  const name = { done: "done", failed: "error", cancelled: "note" }[activity.state];
  const counts = activity.state === "running" && activity.step === "build" && activity.total;
  return h(
    "div",
    { class: `outcome ${activity.state}`, key: "outcome" },
    h(
      "p.outcome-text",
      name ? icon(name) : null,
      h("b", text),
      counts ? ` ${activity.done} of ${activity.total} steps` : null,
      h("span.muted.elapsed", elapsed(activity)),
    ),
    progress(activity, text),
  );
}

/** @param {Activity} activity */
function elapsed(activity) {
  const more = activity.state === "running" && since ? (performance.now() - since.at) / 1000 : 0;
  const seconds = Math.floor(activity.seconds + more);
  return seconds < 60 ? ` ${seconds} s` : ` ${Math.floor(seconds / 60)} min ${seconds % 60} s`;
}

setInterval(() => {
  if (current()?.phase === "connect" && running(current())) draw();
}, 1000);

// While the number of steps is unknown, the bar has no value: the browser then draws it moving.
/**
 * @param {Activity} activity
 * @param {string} text
 */
function progress(activity, text) {
  if (activity.state !== "running") return null;
  const known = activity.total > 0;
  return h("progress", {
    key: known ? "known" : "unknown",
    "aria-label": text,
    max: known ? activity.total : null,
    value: known ? activity.done : null,
  });
}

/**
 * The step of a build in words.
 * @param {Activity} activity
 */
export const stepText = (activity) =>
  ({ download: "Asking for a download", configure: "Configuring" })[activity.step] || "Building";

/** @param {Activity} activity */
export function failureText(activity) {
  const errors = activity.messages.filter(isError).length;
  return errors ? `Failed, with ${plural(errors, "error")}.` : "Failed.";
}

/**
 * The messages, with a button if `again` can try in spite of missing tools.
 * @param {Activity} activity
 * @param {string} name
 * @param {() => void} again
 */
export function messagesPart(activity, name, again) {
  return [
    activity.messages.length &&
      h("ul.problem-list", { key: "messages", "aria-label": name }, activity.messages.map(problem)),
    activity.can_try &&
      h(
        "p.try-anyway",
        { key: "anyway" },
        "Install these, and try again. ",
        h("button", { onclick: again }, "Build anyway"),
        h("span.hint", "if the CMake files of your project find them in other places."),
      ),
  ];
}

/**
 * The path of a file with a button that copies it, and other buttons.
 * @param {string} path
 */
export const pathPart = (path, ...buttons) =>
  h("p.product-path", h("code", path), copyButton("Copy path", path), buttons);

/**
 * @param {Name} name
 * @param {Activity} activity
 */
export function logPart(name, activity, title = "Log") {
  return h(
    "details",
    {
      key: "log",
      class: "log",
      ontoggle: (event) => {
        logs[name].open = event.target.open;
        fetchLog(name);
      },
    },
    h("summary", `${title}, ${plural(activity.lines, "line")}`),
    h("pre", { tabindex: "0", "aria-label": title, keep: true, shown: (place) => showLog(place, logs[name].lines) }),
  );
}

// Shows the log, and keeps its end visible unless the user has scrolled up.
function showLog(place, lines) {
  const text = lines.join("\n");
  if (place.textContent === text) return;
  const atEnd = place.scrollTop + place.clientHeight >= place.scrollHeight - 8;
  place.textContent = text;
  if (atEnd) place.scrollTop = place.scrollHeight;
}
