// SPDX-License-Identifier: Apache-2.0
// The table of the pins and peripherals that are assigned to the components.

import { h } from "./dom.js";

const COLUMNS = [
  ["component", "Component"],
  ["claim", "For"],
  ["resource", "Peripheral"],
  ["pins", "Pins"],
  ["frequency", "Frequency"],
  ["remark", "Remark"],
];

export function hardware(state) {
  if (state.hardware.length === 0) return h("p.empty", "The target uses no pins or peripherals.");
  const columns = COLUMNS.filter(([name]) => state.hardware.some((row) => row[name]));
  return h(
    "table",
    h("caption.unseen", "Pins and peripherals"),
    h(
      "thead",
      h(
        "tr",
        columns.map(([name, title]) => h("th", { key: name, scope: "col" }, title)),
      ),
    ),
    h(
      "tbody",
      state.hardware.map((row, n) =>
        h(
          "tr",
          { key: n },
          columns.map(([name], column) =>
            h(
              column === 0 ? "th" : "td",
              { key: name, scope: column === 0 ? "row" : null, class: `column-${name}` },
              row[name],
            ),
          ),
        ),
      ),
    ),
  );
}
