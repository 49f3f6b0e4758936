// SPDX-License-Identifier: Apache-2.0
// Notices above the page: a lost connection, edits by other programs, conflicts, refused actions.

import { h } from "./dom.js";
import { icon } from "./icons.js";
import { whyLocked } from "./key.js";
import { hasEnded, isLost } from "./server.js";
import { attempt, change, draw, ui } from "./ui.js";

let dismissed = null; // the note about an edit by another program that the user has dismissed

/** @param {State} state */
export function bars(state) {
  if (hasEnded()) return [];
  const list = [];
  if (whyLocked()) list.push(lockedBar());
  else if (isLost()) list.push(lostBar(state));
  if (state?.phase === "connect") list.push(...fileBars(state));
  const asked = state?.phase === "connect" ? state.ask : [];
  if (asked.length) {
    list.push(agreementBar(asked));
  } else if (ui.refused) {
    const dismiss = h("button.quiet", { onclick: () => change({ refused: null }) }, "Dismiss");
    list.push(bar("refused", "error", explained(ui.refused), dismiss));
  }
  return list;
}

function lockedBar() {
  const how = [" Open the address that ", h("code", "epg connect"), " printed last in its terminal."];
  return bar("locked", "error", [h("b", whyLocked()), how]);
}

/** @param {State} state */
function lostBar(state) {
  const folder = state?.project?.folder;
  return bar("lost", "error", [
    h("b", "The connection to EPG is lost. "),
    "If EPG has ended, start it again",
    folder ? [" in ", h("code", folder)] : null,
    " with ",
    h("code", "epg connect"),
    ". EPG then opens a new page, or prints its address. This page can be closed.",
    state?.draft?.changed ? " If EPG has ended, unsaved changes are lost; the tab Changes still shows them." : null,
  ]);
}

// Notices about the files of the target: edits by other programs, and why nothing can be edited here.
/** @param {State} state */
function fileBars({ draft: { conflict, external }, editable, why_not }) {
  const list = [];
  if (!external) dismissed = null;
  if (conflict) {
    list.push(
      bar(
        "conflict",
        "error",
        explained(conflict),
        h("button", { onclick: () => attempt("reload") }, "Load the file, discard my changes"),
        h("button", { onclick: () => attempt("save", { anyway: true }) }, "Overwrite the file with my changes"),
      ),
    );
  } else if (external && external !== dismissed) {
    const dismiss = () => {
      dismissed = external;
      draw();
    };
    list.push(bar("external", "note", external, h("button.quiet", { onclick: dismiss }, "Dismiss")));
  }
  if (!editable) list.push(bar("readonly", "warning", [h("b", "Connections cannot be changed here. "), why_not]));
  return list;
}

function agreementBar(asked) {
  return bar(
    "others",
    "error",
    [
      h("b", `Saving makes errors in other targets: ${asked.map(({ target }) => target).join(", ")}.`),
      asked.map(({ target, errors }) => errors.map(({ message }) => h("span.hint", `${target}: ${message}`))),
    ],
    h("button", { onclick: () => attempt("save", { agreed: true }) }, "Save with these errors"),
  );
}

const explained = ({ message, hint }) => [h("b", message), hint ? ` ${hint}` : null];

function bar(key, severity, text, ...buttons) {
  return h(
    "div",
    { class: `bar ${severity}`, key, role: severity === "note" ? "status" : "alert" },
    icon(severity),
    h("p", text),
    buttons,
  );
}
