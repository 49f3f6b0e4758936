// SPDX-License-Identifier: Apache-2.0
// The dialog in which the user chooses another target for the project.

import { configurationCards } from "./configurations.js";
import { closeDialog, openDialog } from "./dialog.js";
import { h } from "./dom.js";
import { shortFile } from "./problems.js";
import { current } from "./server.js";
import { attempt, draw, ui } from "./ui.js";

// The check box that also lists the targets that this project cannot take. Each has its reason on its card.
function others(all, toggle) {
  const count = current().configurations.filter((each) => !each.possible).length;
  if (count === 0) return null;
  return h(
    "label.check",
    h("input", { type: "checkbox", checked: all, onchange: toggle }),
    `Also show ${count} that this project cannot use, with the reasons`,
  );
}

export function chooseTarget() {
  const inUse = current().configurations.find((each) => each.chosen);
  ui.chosen = inUse ? inUse.name : null;
  let all = false;
  openDialog("target", "Target", () => [
    others(all, () => {
      all = !all;
      draw();
    }),
    configurationCards(current(), "other", (each) => all || each.possible),
    h(
      "div.buttons.sticky",
      h("p.muted", `Changes 'extends' in ${shortFile(current().project?.files.tcf || "")}. You can undo this.`),
      h("span.space"),
      h("button", { type: "button", onclick: () => closeDialog("target") }, "Cancel"),
      h(
        "button",
        {
          type: "button",
          class: "primary",
          disabled: !ui.chosen || ui.chosen === current().configurations.find((each) => each.chosen)?.name,
          onclick: async () => {
            const configuration = ui.chosen;
            closeDialog("target");
            await attempt("choose", { configuration });
          },
        },
        "Use this target",
      ),
    ),
  ]);
}
