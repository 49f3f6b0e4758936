// SPDX-License-Identifier: Apache-2.0
// The lower part of the page: tabs with problems, the build, pins, pictures and changes.

import { buildPanel, buildTitle } from "./build.js";
import { changes } from "./changes.js";
import { componentPanel } from "./component.js";
import { h } from "./dom.js";
import { hardware } from "./hardware.js";
import { icon } from "./icons.js";
import { picture } from "./pictures.js";
import { livePanel, liveTitle } from "./live.js";
import { pinout } from "./pinout.js";
import { problemList } from "./problems.js";
import { simulationPanel, simulationTitle } from "./simulation.js";
import { settingsPanel } from "./settings.js";
import { connectionTable } from "./system.js";
import { change, openTab, ui } from "./ui.js";

/** @param {State} state */
function tabs(state) {
  const { pictures, diagnostics } = state;
  const problems = {
    name: "problems",
    title: `Problems${diagnostics.length ? ` ${diagnostics.length}` : ""}`,
    content: problemList,
  };
  if (state.phase === "system") {
    const connections = { name: "connections", title: "Connections", content: connectionTable };
    return [problems, connections, { name: "system", title: "Picture", content: picture }];
  }
  return [
    problems,
    { name: "build", title: buildTitle(state), content: buildPanel },
    { name: "simulation", title: simulationTitle(state), content: simulationPanel },
    { name: "live", title: liveTitle(state), content: livePanel },
    { name: "component", title: "Component", content: componentPanel },
    { name: "settings", title: "Settings", content: settingsPanel },
    { name: "hardware", title: "Pins and peripherals", content: hardware },
    "wiring" in pictures && { name: "wiring", title: "Pinout", content: pinout },
    { name: "application", title: "Application", content: picture },
    { name: "schedule", title: "Schedule", content: picture },
    { name: "changes", title: state.draft.diff ? "Changes ●" : "Changes", content: changes },
  ].filter(Boolean);
}

/** @param {State} state */
export function dock(state) {
  const all = tabs(state);
  const shown = all.find((each) => each.name === ui.tab) || all[0];
  const isOpen = ui.dock !== "closed";
  return [
    h(
      "div.dock-head",
      { key: "head" },
      h(
        "div",
        { role: "tablist", "aria-label": "Details", onkeydown: (event) => arrow(event, all, shown) },
        all.map((each) => tab(each, each === shown)),
      ),
      h(
        "div.dock-size",
        ui.dock === "large" ? sizeButton("Smaller", "open", "smaller") : sizeButton("Larger", "large", "larger"),
        isOpen ? sizeButton("Hide details", "closed", "close") : sizeButton("Show details", "open", "larger"),
      ),
    ),
    h(
      "div",
      {
        class: `panel panel-${shown.name}`,
        key: `panel-${shown.name}`,
        role: "tabpanel",
        id: "panel",
        "aria-labelledby": `tab-${shown.name}`,
        tabindex: "0",
        hidden: !isOpen,
      },
      shown.content(state, shown.name),
    ),
  ];
}

function tab({ name, title }, selected) {
  return h(
    "button",
    {
      key: name,
      id: `tab-${name}`,
      role: "tab",
      "aria-selected": String(selected),
      "aria-controls": "panel",
      tabindex: selected ? "0" : "-1",
      onclick: () => openTab(name),
    },
    title,
  );
}

function arrow(event, all, shown) {
  const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
  if (!by) return;
  event.preventDefault();
  const next = all[(all.indexOf(shown) + by + all.length) % all.length];
  change({ tab: next.name });
  document.getElementById(`tab-${next.name}`).focus();
}

function sizeButton(label, size, picture) {
  return h(
    "button.quiet.icon-button",
    { "aria-label": label, title: label, onclick: () => change({ dock: size }) },
    icon(picture),
  );
}
