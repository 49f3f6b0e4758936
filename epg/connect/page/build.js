// SPDX-License-Identifier: Apache-2.0
// The build after "Generate": its progress, messages, products and log.

import {
  activityTitle,
  begin,
  failureText,
  logPart,
  messagesPart,
  outcomePart,
  pathPart,
  running,
  stepText,
} from "./activity.js";
import { h } from "./dom.js";
import { flashButton, flashPart } from "./flash.js";
import { isError } from "./problems.js";
import { saveFrom } from "./save.js";
import { current } from "./server.js";
import { attempt, change, openTab } from "./ui.js";

export function generate() {
  return start(false);
}

// Builds; with `anyway` also if tools are missing that the project may still find.
function start(anyway) {
  if (!current().diagnostics.some(isError)) return begin("build", "generate", { anyway });
  openTab("problems");
  return attempt("generate");
}

/** @param {State} state */
export const buildTitle = (state) => activityTitle("Build", state.build);

/** @param {State} state */
export function buildOutcome({ build }) {
  return {
    idle: "Nothing has been generated yet.",
    running: stepText(build),
    done: build.products.length ? "Done. The firmware is ready." : "Done.",
    failed: failureText(build),
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
    outcomePart(build, buildOutcome(state)),
    flashButton(state),
    flashPart(state),
    programPart(state),
    build.products.length &&
      h(
        "ul.products",
        { key: "products" },
        build.products.map((made) => product(state, made)),
      ),
    messagesPart(build, "Messages of the build", () => start(true)),
    logPart("build", build),
  ];
}

/**
 * A product, with the ways to use it.
 * @param {State} state
 * @param {Product} made
 */
function product(state, { path, what, runs }) {
  const name = path.split(/[\\/]/).pop();
  return h(
    "li",
    h("p", what),
    pathPart(
      path,
      runs &&
        h(
          "button",
          { disabled: Boolean(running(state)), onclick: () => begin("program", "run", { path }) },
          `Run ${name} in real time`,
        ),
      h("button", { onclick: () => download(path, name) }, `Download ${name}`),
    ),
  );
}

// Saves a product on the computer of the browser.
async function download(path, name) {
  const problem = await saveFrom(`api/product?path=${encodeURIComponent(path)}`, name);
  if (problem) change({ refused: { ...problem, port: null } });
}

/** @param {State} state */
export function programOutcome({ program }) {
  const name = program.program.split(/[\\/]/).pop();
  return {
    idle: "Nothing has run yet.",
    running: `${name} runs in real time. It is not enabled from here.`,
    done: `${name} has ended.`,
    failed: failureText(program),
    cancelled: `${name} was stopped.`,
  }[program.state];
}

/** @param {State} state */
function programPart(state) {
  const { program } = state;
  if (program.state === "idle") return null;
  return h(
    "section",
    { key: "program", "aria-label": "Program" },
    outcomePart(program, programOutcome(state)),
    messagesPart(program, "Messages of the program", () => {}),
    logPart("program", program, "Output"),
  );
}
