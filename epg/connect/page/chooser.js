// The dialog that gives the project another target.

import { configurationCards } from "./configurations.js";
import { closeDialog, openDialog } from "./dialog.js";
import { h } from "./dom.js";
import { current } from "./server.js";
import { attempt, ui } from "./ui.js";

export function chooseTarget() {
  const inUse = current().configurations.find((each) => each.chosen);
  ui.chosen = inUse ? inUse.name : null;
  openDialog("target", "Target", () => [
    configurationCards(current(), "other"),
    h(
      "div",
      { class: "buttons sticky" },
      h("p", { class: "muted" }, `Changes 'extends' in ${current().project?.files.tcf}, and can be undone.`),
      h("span", { class: "space" }),
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
