// SPDX-License-Identifier: Apache-2.0
// The dialog in which the user chooses another target for the project.

import { configurationCards } from "./configurations.js";
import { closeDialog, openDialog } from "./dialog.js";
import { h } from "./dom.js";
import { shortFile } from "./problems.js";
import { current } from "./server.js";
import { attempt, ui } from "./ui.js";

export function chooseTarget() {
  const inUse = () => current().configurations.find((each) => each.chosen)?.name;
  ui.chosen = inUse();
  openDialog("target", "Target", () => [
    configurationCards(current(), (each) => each.possible),
    h(
      "div.buttons.sticky",
      h("p.muted", `Changes 'extends' in ${shortFile(current().project?.files.tcf || "")}. You can undo this.`),
      h("span.space"),
      h("button", { type: "button", onclick: closeDialog }, "Cancel"),
      h(
        "button",
        {
          type: "button",
          class: "primary",
          disabled: !ui.chosen || ui.chosen === inUse(),
          onclick: () => {
            closeDialog();
            attempt("choose", { configuration: ui.chosen });
          },
        },
        "Use this target",
      ),
    ),
  ]);
}
