// SPDX-License-Identifier: Apache-2.0
// Files for the user's computer, which can be another one than that of EPG.

import { getPicture } from "./server.js";

const LINE = 20; // pixels of a line of a picture's legend

// Saves the answer of an address. A link cannot send the page's secret. Throws an Error if there is no such file.
export async function saveFrom(address, name) {
  offer(await getPicture(address), name);
}

// Saves the plots in `place` as a picture, with the names of their curves: [{name, colour}].
export async function savePng(place, curves, name) {
  const plots = [...place.querySelectorAll("canvas")];
  const scale = window.devicePixelRatio;
  const canvas = document.createElement("canvas");
  canvas.width = Math.max(...plots.map((plot) => plot.width));
  canvas.height = curves.length * LINE * scale + plots.reduce((sum, plot) => sum + plot.height, 0);
  const context = canvas.getContext("2d");
  const style = getComputedStyle(document.documentElement);
  context.fillStyle = style.getPropertyValue("--surface");
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.font = `${13 * scale}px sans-serif`;
  context.textBaseline = "middle";
  curves.forEach((curve, line) => {
    context.fillStyle = curve.colour;
    context.fillText(curve.name, 8 * scale, (line + 0.5) * LINE * scale);
  });
  let top = curves.length * LINE * scale;
  for (const plot of plots) {
    context.drawImage(plot, 0, top);
    top += plot.height;
  }
  const picture = await new Promise((done) => canvas.toBlob(done, "image/png"));
  offer(URL.createObjectURL(picture), name);
}

function offer(address, name) {
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 60_000);
}
