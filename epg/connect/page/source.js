// SPDX-License-Identifier: Apache-2.0
// The dialog with the lines of a file around the position of a message, and around those of its notes.

import { openDialog } from "./dialog.js";
import { h } from "./dom.js";
import { getJson } from "./server.js";

/** @param {Message} message */
export async function showSource(message) {
  const notes = message.notes || [];
  const places = [message, ...notes];
  const excerpts = await Promise.all(places.map((place) => excerpt(place)));
  openDialog("source", message.message, () => [
    message.hint && h("p.hint", message.hint),
    excerpts.map((lines, n) => [
      n > 0 && h("h3", notes[n - 1].message),
      h("p.place", `${places[n].file}:${places[n].line}`),
      lines,
    ]),
  ]);
}

async function excerpt(place) {
  let data;
  try {
    data = await getJson(`api/source?file=${encodeURIComponent(place.file)}&line=${place.line}`);
  } catch {
    return h("p.empty", "The file cannot be shown here.");
  }
  const column = place.column || 0;
  return h(
    "pre.excerpt",
    { tabindex: "0", "aria-label": `Lines ${data.first} and following` },
    data.lines.map((text, n) => line(text, data.first + n, data.first + n === data.line ? column : -1)),
  );
}

function line(text, number, column) {
  const here = column >= 0;
  const marker = here && column > 0 ? `\n${" ".repeat(7)}${text.slice(0, column - 1).replace(/[^\t]/g, " ")}^` : "";
  return h(
    "span",
    { class: here ? "line here" : "line" },
    h("span.number", `${here ? ">" : " "}${String(number).padStart(4)}  `),
    text,
    marker,
    "\n",
  );
}
