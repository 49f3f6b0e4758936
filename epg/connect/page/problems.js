// SPDX-License-Identifier: Apache-2.0
// Messages, at their port or component and as a list. Their text is the same as on the command line.

import { copyButton } from "./copy.js";
import { h, id, plural } from "./dom.js";
import { openField } from "./form.js";
import { icon } from "./icons.js";
import { current } from "./server.js";
import { showSource } from "./source.js";
import { attempt, change, ui } from "./ui.js";

/** @param {Message} message */
export const isError = (message) => message.severity === "error";

/** @param {Message[]} diagnostics */
export function counted(diagnostics) {
  const errors = diagnostics.filter(isError).length;
  const warnings = diagnostics.filter((each) => each.severity === "warning").length;
  const parts = [errors && plural(errors, "error"), warnings && plural(warnings, "warning")].filter(Boolean);
  return { errors, warnings, text: parts.join(", ") || "No problems" };
}

// Messages whose hints only repeat the list of component ports, which is shown beside them.
const LISTED = new Set(["unbound-input", "unbound-output"]);

// The messages about a port or component, below its name.
/** @param {Partial<Message>[]} diagnostics */
export function inline(diagnostics) {
  if (diagnostics.length === 0) return null;
  return h(
    "ul.inline-problems",
    { key: "problems" },
    diagnostics.map((each) =>
      h(
        "li",
        { class: each.severity },
        icon(each.severity),
        h(
          "span",
          h("span.unseen", `${each.severity}: `),
          each.message,
          each.hint && !LISTED.has(each.id) && h("span.hint", each.hint),
        ),
      ),
    ),
  );
}

/** @param {State} state */
export function problemList(state) {
  if (state.diagnostics.length === 0) {
    const right = state.phase === "system" ? "All targets and connections are right." : "The target can be generated.";
    return h("p.empty", icon("done"), `No problems. ${right}`);
  }
  return h("ul.problem-list", state.diagnostics.map(problem));
}

const placeText = (file, line, column = null) => [file, line, column].filter(Boolean).join(":");

// A short name of a file: relative to the project's folder, else the last two parts of its path.
export function shortFile(file) {
  const folder = current()?.project?.folder;
  if (folder && file.startsWith(folder)) return file.slice(folder.length).replace(/^[\\/]/, "");
  const parts = file.split(/[\\/]/);
  return parts.length > 3 ? `…/${parts.slice(-2).join("/")}` : file;
}

// A message about a value that the page can change.
/** @param {Message} message */
const leadsToField = (message) => message.path?.length > 0 && !current().forms?.locked;

// One message as a button. A click leads to its port or field, or else shows its line.
/** @param {Message} message */
export function problem(message) {
  const full = placeText(message.file, message.line, message.column);
  const place = placeText(shortFile(message.file), message.line, message.column);
  const [, command] = /^get it: (?!install it)(.+)$/.exec(message.hint) || [];
  return h(
    "li",
    { class: message.severity },
    h(
      "button.problem",
      { onclick: () => goTo(message) },
      icon(message.severity),
      h(
        "span.problem-text",
        h("span.unseen", `${message.severity}: `),
        h("span.message", message.message),
        message.hint && h("span.hint", message.hint),
        h("span.place", { title: full }, message.port ? `port ${message.port}` : place),
      ),
    ),
    (message.port || leadsToField(message)) &&
      message.file &&
      h(
        "button.quiet",
        { onclick: () => showSource(message), "aria-label": `Show ${place}`, title: full },
        placeText(message.file.split(/[\\/]/).pop(), message.line),
      ),
    command && copyButton("Copy command", command),
    applyButtons(message),
    message.targets?.map((target) =>
      h("button.quiet", { key: target, onclick: () => attempt("open", { target }) }, `Open ${target}`),
    ),
  );
}

// A button for each edit of a message. If there are several, each is named by its sentence.
/** @param {Message} message */
function applyButtons({ edits = [] }) {
  return edits.map((edit) => {
    const { file, line, column, old, sentence } = edit;
    const isWord = old !== "" && !/[\r\n]/.test(old + edit.new);
    return h(
      "button",
      {
        key: sentence,
        onclick: () => attempt("apply", { file, line, column, new: edit.new }),
        "aria-label": `Apply: ${isWord ? `replace ${old} by ${edit.new}` : sentence}`,
        title: isWord ? `${old} → ${edit.new}` : edit.new.trim(),
      },
      edits.length > 1 ? `Apply: ${sentence}` : "Apply",
    );
  });
}

/** @param {Message} message */
function goTo(message) {
  if (message.port && focusPort(message.port)) return;
  if (leadsToField(message) && openField(message.path)) return;
  if (message.file) showSource(message);
}

function focusPort(port) {
  if (ui.dock === "large") change({ dock: "open" });
  const field = document.getElementById(id("ends", port, 0));
  if (!field) return false;
  field.scrollIntoView({ block: "center" });
  field.focus();
  return true;
}
