// SPDX-License-Identifier: Apache-2.0
// The timing of the control loop of a running target: the numbers of the console's command `stats`, and histograms of
// the rows that were streamed since the connection.

import { h, id, rowHead, table } from "./dom.js";
import { ask } from "./server.js";
import { draw } from "./ui.js";

const PERIOD = 2000; // ms between two questions while the part is open
const BINS = 4; // per octave, as in epg/live/durations.py

const TITLES = { "loop.lateness": "Start of a cycle after its tick", "loop.computation": "Computation of a cycle" };

/** @typedef {{rows: number, median: number, most: number, bins: number[][]}} Histogram */

let shown = /** @type {Record<string, string>} */ ({}); // the words of the last answer
let histograms = /** @type {Record<string, Histogram>} */ ({});
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
    "cycles" in shown ? numbers(target.period * 1e9) : h("p.hint", { key: "none" }, "The target is being asked."),
    h(
      "div.histograms",
      { key: "histograms" },
      Object.entries(histograms).map(([name, found]) => found.rows > 0 && histogram(TITLES[name], found)),
    ),
  );

async function follow(part) {
  window.clearTimeout(timer);
  if (!part.open) return;
  const { answer } = await ask("command", { line: "stats" });
  histograms = (await ask("durations")).durations ?? {};
  take(part, answer ?? []);
}

function take(part, lines) {
  const words = lines.flatMap((line) => line.split(" ")).filter((word) => word.includes("="));
  shown = Object.fromEntries(words.map((word) => word.split("=")));
  draw();
  if (part.isConnected) timer = window.setTimeout(() => follow(part), PERIOD);
}

const TIMES = {
  lateness_max: "Latest start after a tick",
  computation_min: "Shortest cycle",
  computation_mean: "Mean cycle",
  computation_max: "Longest cycle",
};
const COUNTS = {
  cycles: "Cycles",
  overruns: "Cycles that ended after the next tick",
  missed: "Ticks without a cycle",
};

function numbers(period) {
  const rows = Object.entries(TIMES).map(([name, text]) => {
    const ns = Number(shown[`${name}_ns`]);
    const share = `${Number(((100 * ns) / period).toPrecision(2))} %`;
    const valuetext = `${share} of the control period`;
    const bar = h("meter", {
      "aria-label": text,
      "aria-valuetext": valuetext,
      min: 0,
      max: period,
      high: period * 0.8,
      value: ns,
    });
    return [rowHead(text), `${Number((ns / 1000).toPrecision(4))} µs`, share, bar];
  });
  for (const [name, text] of Object.entries(COUNTS)) rows.push([rowHead(text), shown[name], "", ""]);
  const caption = h("caption", `Since the start of the target; the control period is ${period / 1e6} ms`);
  return table({ key: "table", class: "results" }, caption, [], rows);
}

// Bars of equal width for the bins. Their heights are logarithmic, so that one late cycle among millions is seen.
/**
 * @param {string} title
 * @param {Histogram} found
 */
function histogram(title, found) {
  const { rows, median, most, bins } = found;
  const first = bins[0][0];
  const counts = Array(bins[bins.length - 1][0] - first + 1).fill(0);
  for (const [number, count] of bins) counts[number - first] = count;
  const highest = Math.log(1 + Math.max(...counts));
  const text = `${rows.toLocaleString("en")} cycles, median ${duration(median)}, longest ${duration(most)}`;
  return h(
    "figure",
    { key: title },
    h("figcaption", h("b", title), h("span", { id: id("durations", title) }, ` ${text}`)),
    h(
      "svg.bars",
      {
        role: "img",
        "aria-label": `Histogram: ${title}`,
        "aria-describedby": id("durations", title),
        viewBox: `0 0 ${counts.length} 1`,
        preserveAspectRatio: "none",
      },
      counts.map((count, index) => {
        const height = Math.log(1 + count) / highest;
        return h("rect", { key: String(index), x: index + 0.05, y: 1 - height, width: 0.9, height });
      }),
    ),
    h("p.hint.ends", h("span", duration(begin(first))), h("span", duration(begin(first + counts.length)))),
  );
}

const begin = (bin) => 2 ** (bin / BINS);
const duration = (ns) =>
  ns < 1e6 ? `${Number((ns / 1000).toPrecision(3))} µs` : `${Number((ns / 1e6).toPrecision(3))} ms`;
