// SPDX-License-Identifier: Apache-2.0
// The table of the pins and peripherals that are assigned to the components.

import { h, rowHead, table } from "./dom.js";

const COLUMNS = [
  ["component", "Component"],
  ["claim", "For"],
  ["resource", "Peripheral"],
  ["pins", "Pins"],
  ["frequency", "Frequency"],
  ["remark", "Remark"],
];

/** @param {State} state */
export function hardware(state) {
  if (state.hardware.length === 0) return h("p.empty", "The target uses no pins or peripherals.");
  const columns = COLUMNS.filter(([name]) => state.hardware.some((row) => row[name]));
  const head = columns.map(([, title]) => title);
  const [[first], ...others] = columns;
  const cells = (row) => others.map(([name]) => h("td", { class: `column-${name}` }, row[name]));
  const rows = state.hardware.map((row) => [rowHead(row[first]), ...cells(row)]);
  return table({}, h("caption.unseen", "Pins and peripherals"), head, rows);
}
