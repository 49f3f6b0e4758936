// SPDX-License-Identifier: Apache-2.0
// "Compare with simulation": the simulated robot gets the same setpoints as the running target since it was enabled.

import { begin, failureText, logPart, messagesPart, outcomePart, running, stepText } from "./activity.js";
import { curvesPart } from "./curves.js";
import { h } from "./dom.js";
import { colour, dash } from "./plots.js";
import { pngButton } from "./save.js";
import { getJson } from "./server.js";
import { draw } from "./ui.js";

/**
 * @typedef {{name: string, rms: number | null, target: (number | null)[], simulation: (number | null)[]}} Compared
 */

const SIMULATED = [1, 3]; // the dashes of simulated signals

let of = null; // the result that was fetched
let compared = /** @type {{times: number[], signals: Compared[]} | null} */ (null);
let drawnFor = ""; // the signals in `shown`
let shown = /** @type {import("./curves.js").Curves | null} */ (null);

const compare = (anyway) => begin("comparison", "compare", { anyway });

/** @param {State} state */
export function comparisonOutcome({ comparison }) {
  return {
    idle: "Nothing has been compared yet.",
    running: comparison.step === "simulate" ? "Simulating" : stepText(comparison),
    done: "Done.",
    failed: failureText(comparison),
    cancelled: "Stopped.",
  }[comparison.state];
}

/**
 * The part of the tab Live with the last comparison. `chosen` are the indices of the signals in the plots.
 * @param {State} state
 * @param {number[]} chosen
 */
export function comparisonPart(state, chosen) {
  const { comparison } = state;
  const target = /** @type {LiveTarget} */ (state.live.target);
  if (!target.every || !target.matches) return null;
  fetchCompared(comparison.result);
  return h(
    "section.live-comparison",
    { key: "comparison", "aria-labelledby": "comparison-title" },
    h("h3", { id: "comparison-title" }, "Compare with the simulation"),
    h(
      "p.hint",
      { key: "hint" },
      "The simulated robot gets the setpoints that this page has sent since the target was enabled.",
    ),
    h(
      "button",
      { key: "compare", disabled: ![undefined, "program"].includes(running(state)), onclick: () => compare(false) },
      "Compare",
    ),
    comparison.state !== "idle" && outcomePart(comparison, comparisonOutcome(state)),
    messagesPart(comparison, "Messages of the comparison", () => compare(true)),
    comparison.result && compared && resultPart(target, comparison.result, chosen),
    comparison.state !== "idle" && logPart("comparison", comparison),
  );
}

// Fetches the curves of a new result.
async function fetchCompared(result) {
  if (result?.number === of) return;
  of = result?.number ?? null;
  compared = null;
  shown = null;
  if (!result) return;
  try {
    compared = await getJson("api/live/comparison");
    draw();
  } catch {
    // EPG has ended, or another comparison has begun, and the state says so
  }
}

function resultPart(target, { changed }, chosen) {
  const names = chosen.map((index) => target.signals[index].name);
  if (!shown || drawnFor !== names.join()) {
    drawnFor = names.join();
    shown = { times: compared.times, mark: false, curves: names.flatMap((name) => curvesOf(target, name)) };
  }
  const { curves } = shown;
  return h(
    "div.compared",
    { key: "result" },
    changed.length > 0 &&
      h(
        "p.form-note",
        { key: "changed" },
        `These parameters were changed in the target only: ${changed.join(", ")}. The simulation has those of the bindings.`,
      ),
    curvesPart(`Target and simulation: ${curves.map((each) => each.name).join(", ")}`, shown),
    h("p", { key: "save" }, pngButton(".compared", curves, `${target.name}-comparison.png`)),
  );
}

/** @returns {import("./curves.js").Curve[]} */
function curvesOf(target, name) {
  const found = compared.signals.find((each) => each.name === name);
  if (!found) return [];
  const index = target.signals.findIndex((each) => each.name === name);
  const { unit } = target.signals[index];
  const rms = found.rms === null ? "" : `, RMS difference ${Number(found.rms.toPrecision(3))} ${unit}`.trimEnd();
  return [
    { name, unit, colour: colour(index), dash: dash(index), values: found.target },
    { name: `${name} simulated${rms}`, unit, colour: colour(index), dash: SIMULATED, values: found.simulation },
  ];
}
