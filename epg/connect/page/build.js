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
  stepText,
} from "./activity.js";
import { h } from "./dom.js";
import { isError } from "./problems.js";
import { current } from "./server.js";
import { attempt, openTab } from "./ui.js";

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
    build.products.length && h("ul.products", { key: "products" }, build.products.map(product)),
    messagesPart(build, "Messages of the build", () => start(true)),
    logPart("build", build),
  ];
}

/** @param {Build["products"][number]} made */
function product({ path, what }) {
  return h("li", h("p", what), pathPart(path));
}
