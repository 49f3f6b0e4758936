// SPDX-License-Identifier: Apache-2.0
// Pictures that the server draws.

import { h } from "./dom.js";
import { getPicture } from "./server.js";
import { draw } from "./ui.js";

// The picture, or the last one before the errors that prevent a new one.
/** @param {State} state */
export function picture(state, name) {
  const isNew = state.pictures[name];
  const key = `${state.project.name} ${name}`;
  const shown = isNew ? newest(key, `picture/${name}.svg?version=${state.version}`) : pictures.get(key)?.shown;
  if (!shown && !isNew) return h("p.empty", { key: "none" }, "The picture is drawn when the errors are corrected.");
  return [
    h("a", { key: "open", href: shown, target: "_blank", rel: "noopener" }, "Open in a new tab"),
    !isNew && h("p.muted", { key: "old" }, "The files have errors. This is the picture before them."),
    h(isNew ? "img.picture" : "img.picture.old", { key: name, alt: description(name), src: shown }),
  ];
}

// The picture at `address`, or an older one until it is fetched.
/**
 * @param {string} key
 * @param {string} address
 * @param {string} name
 * @param {string} alt
 */
export function pictureAt(key, address, name, alt) {
  const shown = newest(key, address);
  if (!shown) return null;
  return [
    h("a", { key: "open", href: shown, target: "_blank", rel: "noopener" }, "Open in a new tab"),
    h("img.picture", { key: name, alt, src: shown }),
  ];
}

// A link that opens the picture alone, to print it. Null until it is fetched.
/** @param {State} state */
export function pictureLink(state, name) {
  const shown = newest(`${state.project.name} ${name}`, `picture/${name}.svg?version=${state.version}`);
  return shown && h("a", { key: "open", href: shown, target: "_blank", rel: "noopener" }, "Open in a new tab");
}

const pictures = new Map(); // project and name -> {wanted, shown}: the address to fetch, and the local address of the shown version

// Returns the local address of the newest fetched version of a picture, null before the first one. Starts to fetch the
// version `wanted`; the old version stays visible until then.
function newest(key, wanted) {
  const entry = pictures.get(key) || { wanted: "", shown: null };
  pictures.set(key, entry);
  if (entry.wanted !== wanted) {
    entry.wanted = wanted;
    fetchNewest(entry, wanted);
  }
  return entry.shown;
}

async function fetchNewest(entry, wanted) {
  let address;
  try {
    address = await getPicture(wanted);
  } catch {
    return; // other parts of the page report errors and a lost connection
  }
  const old = entry.wanted === wanted ? entry.shown : address;
  if (entry.wanted === wanted) entry.shown = address;
  draw();
  if (old) URL.revokeObjectURL(old);
}

const wirings = new Map(); // configuration -> promise of the local address of its picture

// An <img> of a configuration's wiring. The picture is fetched when the image becomes visible.
export function wiringPicture(configuration, attributes) {
  return h("img", {
    ...attributes,
    shown: (image) => {
      if (image.epgWiring === configuration) return;
      image.epgWiring = configuration;
      sight.unobserve(image);
      sight.observe(image);
    },
  });
}

const sight = new IntersectionObserver((entries) => {
  for (const { target, isIntersecting } of entries) if (isIntersecting) fetchWiring(target);
});

async function fetchWiring(image) {
  sight.unobserve(image);
  const name = image.epgWiring;
  const address = `picture/wiring.svg?configuration=${encodeURIComponent(name)}`;
  if (!wirings.has(name)) wirings.set(name, getPicture(address));
  try {
    const shown = await wirings.get(name);
    if (image.epgWiring === name) image.src = shown;
  } catch {
    wirings.delete(name);
  }
}

function description(name) {
  if (name === "system") return "The targets and their connections. The tab Connections contains the same as a table.";
  if (name === "application")
    return "Topics, components, conversions and ports of the application. The lists of ports contain the same.";
  return "One control cycle: the work between two ticks, in order.";
}
