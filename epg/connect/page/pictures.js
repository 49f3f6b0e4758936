// Pictures that the server draws, to look at and to zoom into.

import { h } from "./dom.js";
import { draw, ui } from "./ui.js";

const STEPS = [0.25, 0.5, 0.75, 1, 1.5, 2, 3, 4];

export function picture(state, name) {
  const zoom = ui.zoom[name] || 0; // 0: as wide and high as there is room
  return [
    h(
      "div",
      { class: "zoom", key: "zoom", role: "group", "aria-label": "Zoom" },
      button("Fit", () => change(name, 0), zoom === 0),
      button("−", () => change(name, step(zoom, -1)), false, "Zoom out"),
      h("span", { class: "zoom-value", role: "status" }, zoom ? `${zoom * 100} %` : "fit"),
      button("+", () => change(name, step(zoom, 1)), false, "Zoom in"),
      h("a", { href: address(name, state.version), target: "_blank", rel: "noopener" }, "Open by itself"),
    ),
    h(
      "div",
      {
        class: zoom ? "picture" : "picture fit",
        key: "picture",
        tabindex: "0",
        role: "region",
        "aria-label": "Picture, scrollable",
      },
      h("img", {
        key: name,
        alt: description(state, name),
        shown: (image) => load(image, address(name, state.version), zoom),
      }),
    ),
  ];
}

const address = (name, version) => `picture/${name}.svg?version=${version}`;

// A new version is loaded aside, so that the old one stays until it is there.
function load(image, wanted, zoom) {
  const size = () => {
    image.style.width = zoom ? `${image.naturalWidth * zoom}px` : "";
  };
  if (image.epgWanted === wanted) {
    size();
    return;
  }
  image.epgWanted = wanted;
  const next = new Image();
  next.onload = () => {
    if (image.epgWanted !== wanted) return;
    image.onload = size;
    image.src = wanted;
  };
  next.src = wanted;
}

function description(state, name) {
  if (name === "application")
    return "The application: topics, components, conversions and ports. The lists of ports say the same.";
  if (name === "schedule") return "One control cycle: what the target does between two ticks, in order.";
  const wires = state.components
    .filter((each) => each.where?.length)
    .map((each) => `${each.name}: ${each.where.join(", ")}`);
  return `The board seen from above, with what is connected to its contacts. ${wires.join("; ")}.`;
}

function step(zoom, by) {
  const now = STEPS.indexOf(zoom || 1);
  return STEPS[Math.max(0, Math.min(STEPS.length - 1, now + by))];
}

function change(name, zoom) {
  ui.zoom[name] = zoom;
  draw();
}

function button(text, onclick, pressed, label = null) {
  return h("button", { onclick, "aria-label": label, "aria-pressed": label ? null : String(pressed) }, text);
}
