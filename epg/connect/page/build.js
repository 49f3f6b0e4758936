// SPDX-License-Identifier: Apache-2.0
// The build after "Generate": its progress, messages, products and log.

import { copyButton } from "./copy.js";
import { openDialog } from "./dialog.js";
import { h, plural } from "./dom.js";
import { icon } from "./icons.js";
import { isError, problem } from "./problems.js";
import { current, getJson } from "./server.js";
import { attempt, draw, openTab, say, ui } from "./ui.js";

let log = []; // the fetched lines
let fetching = false;
let since = null; // {seconds, at}: the build's age in the last state, and the time when that state arrived, in ms
let last = "idle"; // the last state of the build
let anyway = false; // true if the user wants to build although tools are missing

export async function generate(_event, although = false) {
  log = [];
  anyway = although;
  openTab(current().diagnostics.some(isError) ? "problems" : "build");
  if ((await attempt("generate", { anyway })) && current().build.ask)
    openDialog("run", "Run these commands?", question);
}

// The question before the first build in a folder, with the commands that will run. Returns null, which closes the
// dialog, after the user has agreed.
function question() {
  const { ask } = current().build;
  if (!ask) return null;
  return [
    h("p", { key: "folder" }, "These commands build the project in ", h("code", ask.folder), ":"),
    h("pre", { key: "commands", tabindex: "0", "aria-label": "Commands" }, ask.commands.join("\n")),
    h(
      "p",
      { key: "programs" },
      `They start ${ask.programs.join(", ")}, and all programs that the project's CMake files start. `,
      "They have your rights: run them only for a project that you trust. EPG asks once per folder.",
    ),
    h(
      "button",
      { key: "run", type: "button", class: "primary", onclick: () => attempt("generate", { run: ask.key, anyway }) },
      "Run",
    ),
  ];
}

/** @param {State} state */
export function buildTitle(state) {
  return { idle: "Build", running: "Build …", done: "Build ✓", failed: "Build ✕", cancelled: "Build" }[
    state.build.state
  ];
}

// Must be called with every new state. Announces the end of a build, and fetches new lines of the log.
/** @param {State} state */
export function followBuild(state) {
  const { build } = state;
  since = { seconds: build.seconds, at: performance.now() };
  if (build.state !== last) {
    if (build.state === "running") {
      log = [];
      ui.tab = "build";
    }
    if (last === "running") say(outcome(state));
    last = build.state;
  }
  fetchLog();
}

async function fetchLog() {
  const { build } = current();
  if (fetching || !ui.logOpen || log.length >= build.lines) return;
  fetching = true;
  const known = log; // a new build begins with another list
  try {
    const answer = await getJson(`api/log?from=${known.length}`);
    known.push(...answer.lines);
  } catch {
    // The notice about the lost connection is shown already.
  }
  fetching = false;
  draw();
}

/** @param {State} state */
function outcome(state) {
  const { build } = state;
  const errors = build.messages.filter(isError).length;
  return {
    idle: "Nothing has been generated yet.",
    running: { download: "Asking for a download", configure: "Configuring" }[build.step] || "Building",
    done: build.products.length ? "Done. The firmware is ready." : "Done.",
    failed: errors ? `Failed, with ${plural(errors, "error")}.` : "Failed.",
    cancelled: "Cancelled.",
  }[build.state];
}

/** @param {State} state */
export function buildPanel(state) {
  const { build } = state;
  if (build.state === "idle") {
    return h("p.empty", "Generate saves, configures and builds the firmware. Its progress and messages appear here.");
  }
  return [
    h("div", { class: `outcome ${build.state}`, key: "outcome" }, status(state), progress(build)),
    build.products.length && h("ul.products", { key: "products" }, build.products.map(product)),
    build.messages.length &&
      h("ul.problem-list", { key: "messages", "aria-label": "Messages of the build" }, build.messages.map(problem)),
    build.can_try && tryAnyway(),
    logPart(build),
  ];
}

// After messages about missing tools, which EPG searches before it starts CMake.
function tryAnyway() {
  return h(
    "p.try-anyway",
    { key: "anyway" },
    "Install these, and press Generate again. ",
    h("button", { onclick: (event) => generate(event, true) }, "Build anyway"),
    h("span.hint", "if the CMake files of your project find them in other places."),
  );
}

/** @param {State} state */
function status(state) {
  const { build } = state;
  const name = { done: "done", failed: "error", cancelled: "note" }[build.state];
  return h(
    "p.outcome-text",
    name ? icon(name) : null,
    h("b", outcome(state)),
    build.state === "running" && build.step === "build" && build.total
      ? ` ${build.done} of ${build.total} steps`
      : null,
    h("span.muted.elapsed", elapsed(build)),
  );
}

/** @param {Build} build */
function elapsed(build) {
  const more = build.state === "running" && since ? (performance.now() - since.at) / 1000 : 0;
  const seconds = Math.floor(build.seconds + more);
  return seconds < 60 ? ` ${seconds} s` : ` ${Math.floor(seconds / 60)} min ${seconds % 60} s`;
}

setInterval(() => {
  if (current()?.build.state === "running") draw();
}, 1000);

// While the number of steps is unknown, the bar has no value: the browser then draws it moving.
/** @param {Build} build */
function progress(build) {
  if (build.state !== "running") return null;
  const known = build.total > 0;
  return h("progress", {
    key: known ? "known" : "unknown",
    "aria-label": build.step === "configure" ? "Configuring" : "Building",
    max: known ? build.total : null,
    value: known ? build.done : null,
  });
}

/** @param {Build["products"][number]} made */
function product({ path, what }) {
  return h("li", h("p", what), h("p.product-path", h("code", path), copyButton("Copy path", path)));
}

/** @param {Build} build */
function logPart(build) {
  return h(
    "details",
    {
      key: "log",
      class: "log",
      ontoggle: (event) => {
        ui.logOpen = event.target.open;
        fetchLog();
      },
    },
    h("summary", `Log, ${plural(build.lines, "line")}`),
    h("pre", { tabindex: "0", "aria-label": "Log", keep: true, shown: showLog }),
  );
}

// Shows the log, and keeps its end visible unless the user has scrolled up.
function showLog(place) {
  const text = log.join("\n");
  if (place.textContent === text) return;
  const atEnd = place.scrollTop + place.clientHeight >= place.scrollHeight - 8;
  place.textContent = text;
  if (atEnd) place.scrollTop = place.scrollHeight;
}
