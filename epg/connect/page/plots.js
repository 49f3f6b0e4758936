// SPDX-License-Identifier: Apache-2.0
// Plots of signals over the last seconds. Each unit has a plot; each signal is a band from its least to its greatest value.

import uPlot from "./vendor/uPlot.esm.js";
import { live, WINDOW } from "./live_events.js";

const HEIGHT = 180;
const COLOURS = ["#1668c1", "#c4501b", "#2a8a4a", "#8a3fb0", "#b08a00", "#0d8a91", "#c0307a", "#6b7280"];

/** @type {Map<string, {plot: any, names: string}>} */
const plots = new Map(); // by unit

export const colour = (index) => COLOURS[index % COLOURS.length];

// Draws the signals `chosen`, indices into `signals`, into `place`.
export function drawPlots(place, signals, chosen) {
  const units = [...new Set(chosen.map((index) => signals[index].unit))];
  for (const [unit, { plot }] of plots) {
    if (units.includes(unit) && place.contains(plot.root)) continue;
    plot.destroy();
    plots.delete(unit);
  }
  for (const unit of units) {
    const indices = chosen.filter((index) => signals[index].unit === unit);
    drawPlot(place, unit, signals, indices);
  }
}

function drawPlot(place, unit, signals, indices) {
  const names = indices.map((index) => signals[index].name).join();
  const known = plots.get(unit);
  if (known && known.names !== names) {
    known.plot.destroy();
    plots.delete(unit);
  }
  if (!plots.has(unit)) plots.set(unit, { plot: bands(place, unit, signals, indices), names });
  const { plot } = plots.get(unit);
  drawnAs(plot, place.clientWidth);
  plot.setData([live.times, ...indices.flatMap((index) => [live.highs[index], live.lows[index]])]);
}

// Draws a plot again if its place has another width now.
export function drawnAs(plot, width) {
  if (plot.width !== width) plot.setSize({ width, height: HEIGHT });
}

function bands(place, unit, signals, indices) {
  const series = indices.flatMap((index) =>
    ["", ", least"].map((end) => ({ label: `${signals[index].name}${end}`, stroke: colour(index) })),
  );
  return newPlot(place, unit, series, {
    scales: {
      x: { time: false, range: (_, min, max) => [Math.max(min, max - WINDOW), Math.max(max, min + 1)] },
      y: { range: rangeOf },
    },
    bands: indices.map((index, place) => ({ series: [1 + 2 * place, 2 + 2 * place], fill: `${colour(index)}40` })),
  });
}

// The range of an axis: a little more than the values. uPlot itself shows values that are all 0 on an axis from 0 to 100.
const rangeOf = (_, min, max) => (min === max ? [(min ?? 0) - 1, (max ?? 0) + 1] : uPlot.rangeNum(min, max, 0.1, true));

// A plot of values of one unit over the time. `series` and `more` are options of uPlot.
export function newPlot(place, unit, series, more) {
  const style = getComputedStyle(document.documentElement);
  const text = style.getPropertyValue("--muted").trim();
  const axis = { stroke: text, grid: { stroke: style.getPropertyValue("--line").trim(), width: 1 } };
  const options = {
    width: place.clientWidth,
    height: HEIGHT,
    legend: { show: false },
    cursor: { show: false },
    scales: { x: { time: false }, y: { range: rangeOf } },
    axes: [axis, { ...axis, label: unit, labelSize: unit ? 20 : 0, size: 60 }],
    series: [{}, ...series.map((each) => ({ width: 1.5, points: { show: false }, ...each }))],
    ...more,
  };
  return new uPlot(options, [[]], place);
}
