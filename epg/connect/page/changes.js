// SPDX-License-Identifier: Apache-2.0
// The tab with the changes that saving would make in the files.

import { h } from "./dom.js";

/** @param {State} state */
export function changes(state) {
  const { diff } = state.draft;
  if (!diff) return h("p.empty", "There are no changes since the files were saved.");
  return h(
    "pre.diff",
    diff
      .replace(/\n$/, "")
      .split("\n")
      .map((line) => h("span", { class: kind(line) }, `${line}\n`)),
  );
}

function kind(line) {
  if (line.startsWith("+++") || line.startsWith("---")) return "file";
  return { "+": "added", "-": "removed", "@": "where" }[line[0]] || "same";
}
