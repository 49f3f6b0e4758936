// SPDX-License-Identifier: Apache-2.0
// Notices above the page: a lost connection, edits by other programs, conflicts, refused actions.

import { h } from "./dom.js";
import { icon } from "./icons.js";
import { whyLocked } from "./key.js";
import { hasEnded, isLost } from "./server.js";
import { attempt, draw, ui } from "./ui.js";

let dismissed = null; // the note about an edit by another program that the user has dismissed

export function bars(state) {
  if (hasEnded()) return [];
  const list = [];
  if (whyLocked()) {
    list.push(
      bar("locked", "error", [
        h("b", whyLocked()),
        " Open the address that ",
        h("code", "epg connect"),
        " printed last in its terminal.",
      ]),
    );
  } else if (isLost()) {
    const folder = state?.project?.folder;
    list.push(
      bar("lost", "error", [
        h("b", "The connection to EPG is lost. "),
        "Start EPG again",
        folder ? [" in ", h("code", folder)] : null,
        " with ",
        h("code", "epg connect"),
        ", and open the address that it prints.",
        state?.draft?.changed ? " If EPG has ended, unsaved changes are lost; the tab Changes still shows them." : null,
      ]),
    );
  }
  if (!state) return list;
  const { draft } = state;
  if (!draft.external) dismissed = null;
  if (state.phase === "connect" && draft.conflict) {
    list.push(
      bar(
        "conflict",
        "error",
        [h("b", draft.conflict.message), draft.conflict.hint ? ` ${draft.conflict.hint}` : null],
        h("button", { onclick: () => attempt("reload") }, "Load the file, discard my changes"),
        h("button", { onclick: () => attempt("save", { anyway: true }) }, "Overwrite the file with my changes"),
      ),
    );
  } else if (state.phase === "connect" && draft.external && draft.external !== dismissed) {
    list.push(
      bar(
        "external",
        "note",
        draft.external,
        dismiss(() => (dismissed = draft.external)),
      ),
    );
  }
  if (state.phase === "connect" && !state.editable) {
    list.push(bar("readonly", "warning", [h("b", "Connections cannot be changed here. "), state.why_not]));
  }
  if (ui.refused) {
    list.push(
      bar(
        "refused",
        "error",
        [h("b", ui.refused.message), ui.refused.hint ? ` ${ui.refused.hint}` : null],
        dismiss(() => (ui.refused = null)),
      ),
    );
  }
  return list;
}

function dismiss(forget) {
  return h(
    "button.quiet",
    {
      onclick: () => {
        forget();
        draw();
      },
    },
    "Dismiss",
  );
}

function bar(key, severity, text, ...buttons) {
  return h(
    "div",
    { class: `bar ${severity}`, key, role: severity === "note" ? "status" : "alert" },
    icon(severity),
    h("p", text),
    buttons,
  );
}
