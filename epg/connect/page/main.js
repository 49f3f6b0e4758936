// SPDX-License-Identifier: Apache-2.0
// Draws the page for every new state of the session, and handles the keys and events of the whole page.
//
// The state from the server (server.js) is the only data about the project; ui.js has the state of the view. An action
// is sent to the server, which answers with a new state. After each change of either state the whole page is described
// again with h(), and render() changes only the differences (dom.js).

import { bars } from "./bars.js";
import { followActivities } from "./activity.js";
import { buildOutcome, programOutcome } from "./build.js";
import { comparisonOutcome } from "./comparison.js";
import { componentColumn } from "./components.js";
import { drawDialog } from "./dialog.js";
import { dock } from "./dock.js";
import { h, render } from "./dom.js";
import { listenForDrags } from "./drag.js";
import { flashOutcome } from "./flash.js";
import { drawStops, isKnown, listenForPresses } from "./handles.js";
import { header } from "./header.js";
import { modelHead, modelPorts } from "./ports.js";
import { followLive } from "./live.js";
import { isOld } from "./live_events.js";
import { current, follow, hasEnded } from "./server.js";
import { simulationOutcome } from "./simulation.js";
import { robotBar } from "./robot.js";
import { startPage } from "./start.js";
import { drawLanes, systemPage } from "./system.js";
import { attempt, draw, ui, whenDrawn } from "./ui.js";
import { drawWires } from "./wires.js";

const part = (name) => document.getElementById(name);

function drawPage() {
  const state = current();
  render(part("bars"), bars(state));
  if (hasEnded()) {
    for (const name of ["robot", "header", "dock"]) part(name).hidden = true;
    render(part("main"), [h("p.ended", { key: "ended" }, "EPG has ended. This window can be closed.")]);
    return;
  }
  if (!state) return;
  if (!isKnown(state)) ui.held = null;
  const started = state.phase !== "choose";
  document.title = started ? `${state.draft.changed ? "● " : ""}${state.project.name} – EPG` : "New project – EPG";
  document.body.className = `${state.phase} dock-${started ? ui.dock : "closed"}${ui.held ? " holding" : ""}`;
  drawRobot(state);
  render(part("header"), header(state));
  render(part("main"), MAIN[state.phase](state));
  part("dock").hidden = !started;
  if (started) render(part("dock"), dock(state));
  drawStops();
  drawDialog();
  drawWires();
  drawLanes();
}

/** @param {State} state */
function drawRobot(state) {
  const bar = robotBar(state);
  part("robot").hidden = !bar;
  document.body.classList.toggle("old", Boolean(bar) && isOld());
  render(part("robot"), bar ?? []);
  measureRobot();
}

// The browser scrolls an element that gets the focus to a place below the bar (see style.css).
function measureRobot() {
  document.documentElement.style.setProperty("--robot", `${part("robot").offsetHeight}px`);
}

new ResizeObserver(measureRobot).observe(part("robot"));

const MAIN = { choose: startPage, connect: diagram, system: systemPage };

/** @param {State} state */
function diagram(state) {
  if (!state.model) {
    return [h("p.empty", { key: "none" }, "The model cannot be read. The tab Problems shows the reason.")];
  }
  const byPort = new Map();
  for (const each of state.diagnostics) {
    for (const port of each.ports) {
      const shown = port === each.port ? each : { ...each, message: `${each.port}: ${each.message}` };
      byPort.set(port, [...(byPort.get(port) || []), shown]);
    }
  }
  const byComponent = Map.groupBy(
    state.diagnostics.filter((each) => each.port === null),
    (each) => each.component,
  );
  const wires = Object.entries(state.wires).flatMap(([port, ends]) => ends.map((end) => ({ port, end })));
  const users = Map.groupBy(wires, ({ end }) => end.reference);
  return [
    h(
      "div.diagram",
      { id: "diagram", key: "diagram", shown: (node) => sizes.observe(node) },
      componentColumn(state, "sources", byComponent, users),
      modelHead(state),
      modelPorts(state, "inputs", byPort),
      modelPorts(state, "outputs", byPort),
      componentColumn(state, "sinks", byComponent, users),
      h("svg", { id: "wires", key: "wires", keep: true, "aria-hidden": "true" }),
      h("p.unseen", { id: "handle-help", key: "help" }, "Press Enter or click to pick up the end of a wire"),
    ),
  ];
}

const sizes = new ResizeObserver(() => drawWires());

whenDrawn(drawPage);

document.addEventListener("keydown", (event) => {
  const state = current();
  if (!(event.ctrlKey || event.metaKey) || event.altKey || state?.phase !== "connect") return;
  const key = event.key.toLowerCase();
  if (key === "s") {
    event.preventDefault();
    if (state.draft.changed) attempt("save");
  } else if ((key === "z" || key === "y") && !isWriting(event.target)) {
    event.preventDefault();
    const redo = key === "y" || event.shiftKey;
    if (redo ? state.draft.can_redo : state.draft.can_undo) attempt(redo ? "redo" : "undo");
  }
});

// The browser itself undoes typed text.
const isWriting = (target) =>
  document.querySelector("dialog[open]") ||
  (target instanceof Element && target.matches("input[type=text], input[type=search], textarea"));

// Firefox does not scroll if a line of the element that gets the focus is in the window, although something covers it.
document.addEventListener("focusin", ({ target }) => {
  const reached = "a, button, input, select, summary, [data-handle]";
  if (target instanceof Element && target.matches(reached) && target.matches(":focus-visible")) {
    target.scrollIntoView({ block: "nearest" });
  }
});

window.addEventListener("beforeunload", (event) => {
  if (current()?.draft?.changed && !hasEnded()) event.preventDefault();
});

listenForDrags(part("main"));
listenForPresses(part("main"));
const OUTCOMES = {
  build: buildOutcome,
  simulation: simulationOutcome,
  program: programOutcome,
  flash: flashOutcome,
  comparison: comparisonOutcome,
};
let begun = false;
follow(() => {
  if (current() && !hasEnded()) {
    followActivities(current(), OUTCOMES);
    followLive(current());
    if (!begun) begin(current());
    begun = true;
  }
  draw();
});

// While a robot is connected, the page begins at it, also after it was loaded again, and while a program runs.
/** @param {State} state */
function begin({ live }) {
  if (!live?.opens && !live?.target) return;
  Object.assign(ui, { tab: "live", dock: "large" });
  draw();
  part("dock").scrollIntoView(); // in a low or narrow window the whole page scrolls
}
