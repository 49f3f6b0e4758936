// SPDX-License-Identifier: Apache-2.0
// Plots of signals over the last seconds. Each unit has a plot; each signal is a band from its least to its greatest value.

import uPlot from "./vendor/uPlot.esm.js";
import { live, WINDOW } from "./live_events.js";

const HEIGHT = 180;
const LINE = 1.5; // pixels

// Each colour has a contrast of at least 3 to the light page and to the dark one (WCAG 2, 1.4.11). The next signals have the
// same colours with other dashes: EPG shows at most 32 signals.
const COLOURS = ["#2f7fe0", "#d4621a", "#2f9a54", "#9d63d6", "#a38a00", "#129aa1", "#e0508f", "#7f8896"];
const DASHES = [[], [7, 3], [2, 2], [7, 2, 2, 2]];

/** @type {Map<string, {plot: any, names: string}>} */
const plots = new Map(); // by unit

export const colour = (index) => COLOURS[index % COLOURS.length];

// The lengths of the dashes and gaps of a signal's line, in pixels.
export const dash = (index) => DASHES[Math.floor(index / COLOURS.length) % DASHES.length];

const LONGEST = 10; // ms after which the next plots wait for another drawing

let next = 0; // the plot that is drawn first

// Draws the signals `chosen`, indices into `signals`, into `place`: on a slow computer not all plots at once.
export function drawPlots(place, signals, chosen) {
  const units = [...new Set(chosen.map((index) => signals[index].unit))];
  for (const [unit, { plot }] of plots) {
    if (units.includes(unit) && place.contains(plot.root)) continue;
    plot.destroy();
    plots.delete(unit);
  }
  const begin = performance.now();
  for (const _ of units) {
    const unit = units[next++ % units.length];
    const indices = chosen.filter((index) => signals[index].unit === unit);
    drawPlot(place, unit, signals, indices);
    if (performance.now() - begin > LONGEST) return;
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
  const names = indices.map((index) => signals[index].name);
  const series = names.flatMap((name) => ["", ", least"].map((end) => ({ label: `${name}${end}`, paths: () => null })));
  const plot = newPlot(place, unit, series, {
    scales: {
      x: { time: false, range: (_, min, max) => [Math.max(min, max - WINDOW), Math.max(max, min + 1)] },
      y: { range: rangeOf },
    },
    hooks: { draw: [(drawn) => drawBands(drawn, indices)] },
  });
  plot.root.setAttribute("role", "img");
  plot.root.setAttribute("aria-label", `Plot${unit && ` in ${unit}`} of the last ${WINDOW} s: ${names.join(", ")}`);
  return plot;
}

// Draws the bands on the canvas itself. uPlot would make Path2D objects of all points for each picture. Firefox does not
// count their memory, and collects them only after gigabytes.
function drawBands(plot, indices) {
  const { ctx, bbox } = plot;
  const scale = window.devicePixelRatio;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.lineWidth = LINE * scale;
  ctx.lineJoin = "round";
  const xs = live.times.map((time) => plot.valToPos(time, "x", true));
  const { min, max } = plot.scales.y;
  const y = (value) => bbox.top + (bbox.height * (max - value)) / (max - min);
  for (const index of indices) {
    ctx.strokeStyle = colour(index);
    ctx.fillStyle = `${colour(index)}40`;
    ctx.setLineDash(dash(index).map((length) => length * scale));
    for (const [begin, end] of pieces(live.highs[index])) drawBand(ctx, xs, y, index, begin, end);
  }
  ctx.restore();
}

// The ranges [begin, end) of points that have a value.
function pieces(values) {
  const found = [];
  for (let begin = 0; begin < values.length; begin++) {
    if (values[begin] === null) continue;
    let end = begin + 1;
    while (end < values.length && values[end] !== null) end++;
    found.push([begin, end]);
    begin = end;
  }
  return found;
}

function drawBand(ctx, xs, y, index, begin, end) {
  const highs = live.highs[index];
  const lows = live.lows[index];
  const add = (values, n) => ctx.lineTo(xs[n], y(values[n]));
  ctx.beginPath();
  for (let n = begin; n < end; n++) add(highs, n);
  ctx.stroke();
  let wide = false;
  for (let n = begin; n < end && !wide; n++) wide = lows[n] !== highs[n];
  if (!wide) return;
  for (let n = end - 1; n >= begin; n--) add(lows, n);
  ctx.fill();
  ctx.beginPath();
  for (let n = begin; n < end; n++) add(lows, n);
  ctx.stroke();
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
    series: [{}, ...series.map((each) => ({ width: LINE, points: { show: false }, ...each }))],
    ...more,
  };
  return new uPlot(options, [[]], place);
}
