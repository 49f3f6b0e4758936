// SPDX-License-Identifier: Apache-2.0
// Small pictures beside a text. A button with an icon alone needs an aria-label.

import { h } from "./dom.js";

const PATHS = {
  error: "M5 5l6 6M11 5l-6 6",
  warning: "M8 4v5M8 11.4v.6",
  note: "M8 7.4V12M8 4.2v.6",
  done: "M4 8.5l2.8 2.8L12 5.5",
  conversion: "M2 5h5M11 5h3M2 11h2M8 11h6M7 3v4h4V3zM4 9v4h4V9z",
  target: "M8 1.5v3M8 11.5v3M1.5 8h3M11.5 8h3M4.5 4.5h7v7h-7z",
  close: "M4 4l8 8M12 4l-8 8",
  plus: "M8 3v10M3 8h10",
  larger: "M3 10l5-5 5 5",
  smaller: "M3 6l5 5 5-5",
};

export function icon(name) {
  return h(
    "svg",
    { class: `icon icon-${name}`, viewBox: "0 0 16 16", "aria-hidden": "true", focusable: "false" },
    h("path", { d: PATHS[name] }),
  );
}
