// SPDX-License-Identifier: Apache-2.0
// "Simulate": the controller runs on this computer, in simulated time, and moves a simulated robot by a scenario.

import {
  activityTitle,
  begin,
  failureText,
  logPart,
  messagesPart,
  outcomePart,
  pathPart,
  stepText,
} from "./activity.js";
import { h, option, table } from "./dom.js";
import { icon } from "./icons.js";
import { pictureAt } from "./pictures.js";
import { isError, shortFile } from "./problems.js";
import { current } from "./server.js";
import { attempt, draw, openTab } from "./ui.js";

let chosen = ""; // the name of the chosen scenario; empty for the first one

export function simulate() {
  return start(false);
}

// With `anyway` also if tools are missing that the project may still find. Ports without a wire are no obstacle if EPG
// has a proposal for each: the question shows them.
function start(anyway) {
  const { diagnostics, proposals, simulations } = current();
  const body = { anyway, simulation: simulations?.found.some((each) => each.name === chosen) ? chosen : "" };
  const errors = diagnostics.filter(isError);
  if (errors.every((each) => each.id === "unbound-input" && each.port in proposals)) {
    return begin("simulation", "simulate", body);
  }
  openTab("problems");
  return attempt("simulate");
}

/** @param {State} state */
export const simulationTitle = (state) => activityTitle("Simulation", state.simulation);

/** @param {State} state */
export function simulationOutcome({ simulation }) {
  const { result } = simulation;
  return {
    idle: "Nothing has been simulated yet.",
    running: simulation.step === "simulate" ? "Simulating" : stepText(simulation),
    done: result?.passed
      ? "Done. The robot has moved as the scenario expects."
      : "Done. The scenario's expectations do not hold.",
    failed: failureText(simulation),
    cancelled: "Stopped.",
  }[simulation.state];
}

/** @param {State} state */
export function simulationPanel(state) {
  const { simulation } = state;
  return [
    choice(state),
    simulation.state !== "idle" && outcomePart(simulation, simulationOutcome(state)),
    messagesPart(simulation, "Messages of the simulation", () => start(true)),
    simulation.result && resultPart(state, simulation.result),
    simulation.state !== "idle" && logPart("simulation", simulation),
  ];
}

// Which scenario runs, or the reason why none can.
function choice({ simulations, simulation }) {
  const idle = simulation.state === "idle";
  if (!simulations) return idle && h("p.empty", { key: "choice" }, "EPG is looking for a scenario.");
  const { found, problem, hint } = simulations;
  if (!found.length) {
    return h("p.empty", { key: "choice" }, `There is no simulation: ${problem}. `, h("span.hint", hint));
  }
  const shown = found.find((each) => each.name === chosen) || found[0];
  const file = h("code", { title: shown.scenario }, shortFile(shown.scenario));
  return [
    idle &&
      h(
        "p.empty",
        { key: "choice" },
        "Simulate builds the controller for this computer, enables it in simulated time, and moves it by ",
        file,
        ". Nothing is sent to a board.",
      ),
    found.length > 1 &&
      h(
        "p",
        { key: "scenarios" },
        h("label", { for: "scenario" }, "Scenario "),
        h(
          "select",
          {
            id: "scenario",
            value: shown.name,
            onchange: (event) => {
              chosen = event.target.value;
              draw();
            },
          },
          found.map((each) => option(each.name, shortFile(each.scenario))),
        ),
      ),
  ];
}

/**
 * @param {State} state
 * @param {SimulationResult} result
 */
function resultPart(state, result) {
  const { checks, windows, problem, hint } = result;
  return [
    problem && h("p.failed-end", { key: "problem" }, icon("error"), h("b", problem), h("span.hint", hint)),
    pictureAt(
      `${state.project.name} simulation`,
      `picture/simulation.svg?version=${result.picture}`,
      "simulation",
      describe(result),
    ),
    checks.length > 0 && results("Limits of the scenario", ["Limit", "Value", "At most", ""], checks.map(check)),
    windows.length > 0 &&
      results("Errors: position - setpoint", ["Axis", "Time", "RMS error", "Largest error"], windows.map(errors)),
    h("p.muted", { key: "files" }, "The values of each cycle are in ", h("code", "trace.csv"), ":"),
    h("div", { key: "folder" }, pathPart(result.folder)),
  ];
}

const number = (value, unit) => (value === null ? "no value" : `${Number(value.toPrecision(3))} ${unit}`.trim());

const check = (each) => [
  each.text,
  number(each.value, each.unit),
  number(each.limit, each.unit),
  h(
    "span",
    { class: each.passed ? "held" : "not-held" },
    icon(each.passed ? "done" : "error"),
    each.passed ? "holds" : "does not hold",
  ),
];

const errors = (each) => [
  each.axis,
  `${each.start} s to ${each.end} s`,
  number(each.rms, each.unit),
  number(each.largest, each.unit),
];

const results = (caption, head, rows) => table({ key: caption, class: "results" }, h("caption", caption), head, rows);

/** @param {SimulationResult} result */
function describe({ windows, duration }) {
  const each = windows.map((window) => `${window.axis}: largest error ${number(window.largest, window.unit)}`);
  return `Setpoint and position of each axis over ${duration} s, with the error below. ${each.join("; ")}.`;
}
