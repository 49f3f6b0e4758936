// SPDX-License-Identifier: Apache-2.0
// The timing of the control loop of a running target, from the console's command `stats`.

import { h } from "./dom.js";
import { ask } from "./server.js";
import { draw } from "./ui.js";

const PERIOD = 2000; // ms between two questions while the part is open

let shown = /** @type {Record<string, string>} */ ({}); // the words of the last answer
let timer = 0;

/**
 * The part of the tab Live about the control loop. It asks the target only while it is open.
 * @param {LiveTarget} target
 */
export const timingPart = (target) =>
  h(
    "details.live-timing",
    { key: "timing", ontoggle: (event) => follow(event.target) },
    h("summary", "Loop timing"),
    "cycles" in shown ? table(target.period * 1e9) : h("p.hint", { key: "none" }, "The target is being asked."),
  );

function follow(part) {
  window.clearTimeout(timer);
  if (part.open) ask("command", { line: "stats" }).then(({ answer }) => take(part, answer ?? []));
}

function take(part, lines) {
  const words = lines.flatMap((line) => line.split(" ")).filter((word) => word.includes("="));
  shown = Object.fromEntries(words.map((word) => word.split("=")));
  draw();
  if (part.isConnected) timer = window.setTimeout(() => follow(part), PERIOD);
}

function table(period) {
  const times = { lateness_max: "Latest start after a tick" };
  for (const [name, text] of [
    ["min", "Shortest cycle"],
    ["mean", "Mean cycle"],
    ["max", "Longest cycle"],
  ]) {
    times[`computation_${name}`] = text;
  }
  const rows = Object.entries(times).map(([name, text]) => {
    const ns = Number(shown[`${name}_ns`]);
    const share = `${Number(((100 * ns) / period).toPrecision(2))} %`;
    const label = `${text}: ${share} of the control period`;
    const bar = h("meter", { "aria-label": label, min: 0, max: period, high: period * 0.8, value: ns });
    return [text, `${Number((ns / 1000).toPrecision(4))} µs`, share, bar];
  });
  const counts = {
    cycles: "Cycles",
    overruns: "Cycles that ended after the next tick",
    missed: "Ticks without a cycle",
  };
  for (const [name, text] of Object.entries(counts)) rows.push([text, shown[name], "", ""]);
  return h(
    "table.results",
    { key: "table" },
    h("caption", `Since the start of the target; the control period is ${period / 1e6} ms`),
    h(
      "tbody",
      rows.map(([text, ...cells]) =>
        h(
          "tr",
          { key: text },
          h("th", { scope: "row" }, text),
          cells.map((cell) => h("td", cell)),
        ),
      ),
    ),
  );
}
