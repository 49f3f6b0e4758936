// SPDX-License-Identifier: Apache-2.0
// Files for the user's computer, which can be another one than that of EPG.

import { h } from "./dom.js";
import { getPicture } from "./server.js";

const LINE = 20; // pixels of a line of a picture's legend

const UNSAVED = "epg-unsaved"; // the name of a file that is being made, in the storage of this tab

let leaving = false; // the page is being left, which ends its requests

window.addEventListener("beforeunload", () => {
  leaving = true;
  setTimeout(() => {
    leaving = false; // the user stays
  }, 1000);
});

// Saves the answer of an address. A link cannot send the page's secret. Returns null, or the reason why there is no file.
/** @returns {Promise<Refusal | null>} */
export async function saveFrom(address, name) {
  note(name);
  try {
    offer(await getPicture(address), name);
    return null;
  } catch (error) {
    return reasonOf(/** @type {Error} */ (error), name);
  } finally {
    if (!leaving) note(null);
  }
}

/** @returns {Refusal} */
function reasonOf(error, name) {
  try {
    return JSON.parse(error.message).error;
  } catch {
    return { message: `EPG has ended while it made ${name}, or does not answer`, hint: "start EPG again" };
  }
}

// The reason why a file is missing that was being made when the page was loaded again; null if there was none.
/** @returns {Refusal | null} */
export function interrupted() {
  try {
    const name = sessionStorage.getItem(UNSAVED);
    note(null);
    return name ? { message: `The page was loaded again before ${name} was complete`, hint: "save it again" } : null;
  } catch {
    return null; // storage is not allowed
  }
}

function note(name) {
  try {
    if (name) sessionStorage.setItem(UNSAVED, name);
    else sessionStorage.removeItem(UNSAVED);
  } catch {
    // storage is not allowed, as above
  }
}

// A button that saves the plots in the element `place` as a picture, with the names and lines of their curves:
// [{name, colour, dash}].
export const pngButton = (place, curves, name, attributes = {}) =>
  h("button", { ...attributes, onclick: () => savePng(`${place} canvas`, curves, name) }, "Save as PNG");

async function savePng(selector, curves, name) {
  const plots = /** @type {HTMLCanvasElement[]} */ ([...document.querySelectorAll(selector)]);
  const scale = window.devicePixelRatio;
  const canvas = document.createElement("canvas");
  canvas.width = Math.max(...plots.map((plot) => plot.width));
  canvas.height = curves.length * LINE * scale + plots.reduce((sum, plot) => sum + plot.height, 0);
  const context = canvas.getContext("2d");
  const style = getComputedStyle(document.documentElement);
  context.fillStyle = style.getPropertyValue("--surface");
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.fillStyle = style.getPropertyValue("--text");
  context.font = `${13 * scale}px sans-serif`;
  context.textBaseline = "middle";
  curves.forEach((curve, line) => {
    const middle = (line + 0.5) * LINE * scale;
    context.strokeStyle = curve.colour;
    context.lineWidth = 3 * scale;
    context.setLineDash((curve.dash ?? []).map((length) => length * scale));
    context.beginPath();
    context.moveTo(8 * scale, middle);
    context.lineTo(36 * scale, middle);
    context.stroke();
    context.fillText(curve.name, 44 * scale, middle);
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
