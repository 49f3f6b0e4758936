// SPDX-License-Identifier: Apache-2.0
// Curves that do not move: a recording around a trigger, a comparison. Each unit has a plot.

import { h } from "./dom.js";
import { drawnAs, newPlot } from "./plots.js";

/**
 * @typedef {{name: string, unit: string, colour: string, dash?: number[], values: (number | null)[]}} Curve
 * @typedef {{times: number[], mark: boolean, curves: Curve[]}} Curves  `mark` draws a line at the time 0
 */

/** @type {WeakMap<Element, {shown: Curves, plots: any[]}>} */
const drawn = new WeakMap();

/**
 * Draws curves into `place`.
 * @param {HTMLElement} place
 * @param {Curves} shown
 */
function drawCurves(place, shown) {
  if (!place.clientWidth) return;
  const known = drawn.get(place);
  if (known?.shown === shown) {
    for (const plot of known.plots) drawnAs(plot, place.clientWidth);
    return;
  }
  for (const plot of known?.plots ?? []) plot.destroy();
  const units = [...new Set(shown.curves.map((each) => each.unit))];
  drawn.set(place, { shown, plots: units.map((unit) => plotOf(place, unit, shown)) });
}

/** @param {Curves} shown */
function plotOf(place, unit, shown) {
  const { times, mark, curves } = shown;
  const found = curves.filter((each) => each.unit === unit);
  const plot = newPlot(
    place,
    unit,
    found.map(({ name, colour, dash }) => ({ label: name, stroke: colour, dash })),
    { hooks: mark ? { draw: [drawMark] } : {} },
  );
  plot.setData([times, ...found.map((each) => each.values)]);
  return plot;
}

function drawMark(plot) {
  const x = Math.round(plot.valToPos(0, "x", true));
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.strokeStyle = getComputedStyle(document.documentElement).getPropertyValue("--error");
  ctx.lineWidth = 2;
  ctx.beginPath();
  ctx.moveTo(x, bbox.top);
  ctx.lineTo(x, bbox.top + bbox.height);
  ctx.stroke();
  ctx.restore();
}

/**
 * Curves, and their names with their colours.
 * @param {Curves} shown
 */
export const curvesPart = (label, shown) => [
  h(
    "ul.legend",
    shown.curves.map(({ name, colour, dash }) => h("li", { key: name }, swatch(colour, dash), ` ${name}`)),
  ),
  h("div.curves", {
    key: "curves",
    keep: true,
    role: "img",
    "aria-label": label,
    shown: (place) => drawCurves(place, shown),
  }),
];

// A piece of the line of a curve.
export const swatch = (colour, dash = []) =>
  h(
    "svg",
    { class: "swatch", viewBox: "0 0 22 8", "aria-hidden": "true" },
    h("path", {
      d: "M0 4H22",
      fill: "none",
      stroke: colour,
      "stroke-width": "4",
      "stroke-dasharray": dash.join(" ") || null,
    }),
  );
