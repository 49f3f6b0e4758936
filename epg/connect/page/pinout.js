// SPDX-License-Identifier: Apache-2.0
// The tab Pinout: the board's drawing, and the pins of the components' signals.
//
// The server makes the drawing and the list of pins of the same data. The drawing reacts to the pointer; the lists do the
// same by keyboard. The drawing is in a shadow tree, so that its style sheet does not apply to the page.

import { h, id, listField, option, plural } from "./dom.js";
import { icon } from "./icons.js";
import { pictureLink } from "./pictures.js";
import { act, current, getJson, getText } from "./server.js";
import { draw, say } from "./ui.js";

const FAR = 5; // pixels; a shorter movement is a click

let chosen = ""; // the chosen signal, as "component.signal"
/** @type {(Refusal & {pin: string}) | null} */
let refused = null; // the reason why the last pin was refused
let warning = "unseen"; // "unseen", "shown", "seen": the user must disconnect the motors before wires are changed
/** @type {{wanted: string, of: string, svg: string, options: PinOption[]}} */
let entry = { wanted: "", of: "", svg: "", options: [] }; // the drawing and the pins of the signal `of`

/** @param {State} state */
export function pinout(state) {
  const { signals, why_not: whyNot } = state.pins;
  if (!signals.some((each) => nameOf(each) === chosen)) chosen = "";
  const shown = newest(state);
  const wrong = refused ? refused.pin : "";
  return h(
    "div.pinout",
    { key: "pinout" },
    h("div.pin-tools", { key: "tools" }, tools(state, signals, whyNot, shown)),
    h("div.board", {
      key: "board",
      keep: true,
      tabindex: "0",
      role: "group",
      "aria-label": "Drawing of the board",
      onpointerdown: pressed,
      onpointermove: moved,
      onpointerup: released,
      onpointercancel: () => endDrag(),
      shown: (node) => show(node, shown.svg, wrong),
    }),
  );
}

const nameOf = ({ component, signal }) => `${component}.${signal}`;
const titleOf = ({ component, signal }) => `${component} ${signal}`;

// Splits "component.signal": neither name has a dot.
function partsOf(name) {
  const [component, signal] = name.split(".");
  return { component, signal };
}

/** @param {State} state */
function tools(state, signals, whyNot, shown) {
  const lacking = signals.filter((each) => !each.pin);
  if (!signals.length)
    return [pictureLink(state, "wiring"), h("p.muted", { key: "none" }, "No component needs a pin.")];
  return [
    pictureLink(state, "wiring"),
    warning === "shown" && motorWarning(),
    pinProblems(state),
    lacking.length > 0 &&
      h(
        "button.primary",
        { key: "all", disabled: Boolean(whyNot), onclick: () => changePins("first_pins", {}) },
        `Find pins for ${plural(lacking.length, "signal")} without one`,
      ),
    listField("pin-signal", "Signal", { value: chosen, onchange: (event) => choose(event.target.value) }, [
      option("", "– choose a signal –"),
      [...Map.groupBy(signals, (each) => each.component)].map(([component, all]) =>
        h("optgroup", { label: component, key: component }, all.map(signalOption)),
      ),
    ]),
    whyNot && h("p.muted", { key: "why-not" }, `Pins cannot be changed here: ${whyNot}.`),
    !chosen &&
      !whyNot &&
      h("p.muted", { key: "help" }, "Choose a signal here, or click or drag its end in the drawing."),
    refused &&
      h(
        "p.refusal",
        { key: "refused", role: "alert" },
        icon("error"),
        ` ${refused.message}. `,
        h("span.hint", refused.hint),
      ),
    chosen && pinsOf(partsOf(chosen), signals, whyNot, shown),
  ];
}

const signalOption = (each) => option(nameOf(each), `${titleOf(each)}: ${each.pin || "no pin"}`);

// The errors of pins in the files. A press chooses the signal, whose list then shows the pins that fit.
/** @param {State} state */
function pinProblems(state) {
  const { problems } = state.pins;
  return (
    problems.length > 0 &&
    h(
      "ul.pin-problems",
      { key: "problems" },
      problems.map((each, number) =>
        h(
          "li.error",
          { key: String(number) },
          icon("error"),
          h("span", `${titleOf(each)}: ${each.message}`),
          h("button", { "aria-label": `Choose ${titleOf(each)}`, onclick: () => choose(nameOf(each)) }, "Choose"),
        ),
      ),
    )
  );
}

function motorWarning() {
  return h(
    "div.motor-warning",
    { key: "motor", role: "status" },
    h("p", icon("warning"), " Disconnect the motor supply before you change wires on the bench."),
    h("button", { onclick: () => dismiss() }, "OK"),
  );
}

function dismiss() {
  warning = "seen";
  draw();
}

function pinsOf(signal, signals, whyNot, shown) {
  const all = signals.filter((each) => each.component === signal.component);
  const options = shown.of === chosen ? shown.options : [];
  const fits = options.filter((each) => each.state === "fits");
  const others = options.filter((each) => each.state !== "fits" && each.state !== "current");
  const fit = (wanted) =>
    changePins("first_pins", { signals: wanted.map(({ component, signal: name }) => ({ component, signal: name })) });
  return [
    h(
      "div.buttons",
      { key: "fit" },
      h("button", { disabled: Boolean(whyNot), onclick: () => fit([signal]) }, "First that fits"),
      all.length > 1 &&
        h(
          "button",
          { disabled: Boolean(whyNot), onclick: () => fit(all) },
          `First that fit all of ${signal.component}`,
        ),
    ),
    h("h3", { key: "fits-title" }, options.length ? `Pins for ${titleOf(signal)}` : "…"),
    options.length > 0 && !fits.length && h("p.muted", { key: "none" }, "No other pin fits."),
    h(
      "ul.pins",
      { key: "fits" },
      fits.map((each) =>
        h(
          "li",
          { key: each.pin },
          h(
            "button",
            { id: id("pin", each.pin), disabled: Boolean(whyNot), onclick: () => setPin(each.pin) },
            [each.pin, each.printed].filter(Boolean).join(" "),
          ),
          h("span.muted", [each.contact && `contact ${each.contact}`, each.reason].filter(Boolean).join(", ")),
        ),
      ),
    ),
    others.length > 0 &&
      h(
        "details",
        { key: `others-${chosen}` },
        h("summary", `${plural(others.length, "pin")} that ${others.length === 1 ? "does" : "do"} not fit`),
        h(
          "ul.pin-reasons",
          others.map((each) => h("li", { key: each.pin }, h("strong", each.pin), ` ${each.state}: ${each.reason}`)),
        ),
      ),
  ];
}

function choose(name) {
  chosen = name;
  refused = null;
  draw();
}

function setPin(pin) {
  return changePins("choose_pin", { ...partsOf(chosen), pin });
}

/**
 * Sends a change of pins. The first one that is done warns of the motors.
 * @template {keyof Actions} Name
 * @param {Name} action
 * @param {Actions[Name]} body
 */
async function changePins(action, body) {
  const before = JSON.stringify(current()?.pins);
  const answer = await act(action, body);
  refused = answer && { ...answer, pin: "pin" in body ? String(body.pin) : "" };
  if (refused) say(`Refused: ${refused.message}. ${refused.hint}`);
  else if (before !== JSON.stringify(current()?.pins)) {
    if (warning === "unseen") warning = "shown";
    const now = current()?.pins.signals.find((each) => nameOf(each) === chosen);
    say(now ? `${titleOf(now)} has ${now.pin}` : "Pins have changed");
  }
  draw();
}

// The newest drawing and pins that were fetched. Starts to fetch those of this version of the state.
/** @param {State} state */
function newest(state) {
  const { component, signal } = partsOf(chosen);
  const query = `version=${state.version}&component=${encodeURIComponent(component)}&signal=${encodeURIComponent(signal || "")}`;
  if (entry.wanted !== query) {
    entry.wanted = query;
    fetchNewest(query, chosen);
  }
  return entry;
}

async function fetchNewest(query, of) {
  try {
    const [svg, options] = await Promise.all([
      getText(`picture/pinout.svg?${query}`),
      of ? getJson(`api/pins?${query}`) : [],
    ]);
    if (entry.wanted !== query) return;
    entry = { wanted: query, of, svg, options };
    draw();
  } catch {
    // other parts of the page report errors and a lost connection
  }
}

// Puts the drawing into the shadow tree of `node`, and marks the contact that was refused.
function show(node, svg, wrong) {
  if (!svg) return;
  if (node.epgSvg !== svg) place(node, svg);
  for (const each of node.shadowRoot.querySelectorAll("[data-pin]"))
    each.classList.toggle("refused", each.dataset.pin === wrong);
}

function place(node, svg) {
  node.epgSvg = svg;
  const root = node.shadowRoot || node.attachShadow({ mode: "open" });
  const picture = new DOMParser().parseFromString(svg, "image/svg+xml").documentElement;
  picture.setAttribute("width", "100%");
  picture.removeAttribute("height");
  picture.style.minWidth = "640px"; // a narrower window scrolls
  root.replaceChildren(document.importNode(picture, true));
}

/** @type {{x: number, y: number, from: string, moved: boolean, over: Element | null} | null} */
let drag = null;

// The contact or the terminal in the drawing at the position of a pointer event.
function at(event) {
  const found = event.currentTarget.shadowRoot?.elementFromPoint(event.clientX, event.clientY);
  return found?.closest("[data-pin], [data-signal]") || null;
}

// The signal at a contact or a terminal; empty if there is none.
function signalAt(place) {
  if (place?.dataset.signal) return place.dataset.signal;
  const user = current()?.pins.signals.find((each) => each.pin && each.pin === place?.dataset.pin);
  return user ? nameOf(user) : "";
}

function pressed(event) {
  if (event.button !== 0) return;
  drag = { x: event.clientX, y: event.clientY, from: signalAt(at(event)), moved: false, over: null };
}

function moved(event) {
  if (!drag?.from || current()?.pins.why_not) return;
  if (!drag.moved && Math.hypot(event.clientX - drag.x, event.clientY - drag.y) < FAR) return;
  if (!drag.moved) {
    drag.moved = true;
    event.currentTarget.setPointerCapture(event.pointerId);
    document.body.classList.add("dragging");
    if (chosen !== drag.from) choose(drag.from);
  }
  const over = at(event);
  if (over === drag.over) return;
  drag.over?.classList.remove("over");
  if (over?.dataset.pin) over.classList.add("over");
  drag.over = over;
}

function released(event) {
  const place = at(event);
  const wasDragged = drag?.moved;
  const from = drag?.from;
  endDrag();
  const pin = place?.dataset.pin;
  if (wasDragged) {
    if (pin) setPin(pin);
    return;
  }
  if (!place) return;
  if (pin && chosen && from !== chosen && !current()?.pins.why_not) setPin(pin);
  else if (from) choose(from);
}

function endDrag() {
  drag?.over?.classList.remove("over");
  drag = null;
  document.body.classList.remove("dragging");
}
