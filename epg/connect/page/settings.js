// SPDX-License-Identifier: Apache-2.0
// The tab with the settings of the target: control loop, communication, node, clocks.

import { h, id } from "./dom.js";
import { formFields, formNotes } from "./form.js";

/** @param {State} state */
export function settingsPanel(state) {
  const { settings } = state.forms;
  return h("div.form", [
    formNotes(state),
    settings.length === 0 &&
      h("p.empty", { key: "none" }, "The .tcf cannot be read. The tab Problems shows the reason."),
    settings.map(({ title, fields }) =>
      h(
        "section",
        { key: title, "aria-labelledby": id("settings", title) },
        h("h3", { id: id("settings", title) }, title),
        h("div.form-fields", formFields(state, [], fields)),
      ),
    ),
  ]);
}
