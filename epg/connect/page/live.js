// SPDX-License-Identifier: Apache-2.0
// "Live": a running target. Plots of its signals, its parameters, and the buttons that enable, move and stop it.

import { comparisonPart } from "./comparison.js";
import { swatch } from "./curves.js";
import { h, id, option } from "./dom.js";
import { enablePart, answersPart, goalsPart } from "./enabling.js";
import { icon } from "./icons.js";
import { command, isMade, refusal, request, save } from "./live_commands.js";
import { age, followTarget, isOld, live } from "./live_events.js";
import { keyPart } from "./live_key.js";
import { drawValues, value } from "./live_values.js";
import { actuatorsPart, moveOn } from "./move_by_hand.js";
import { colour, dash, drawPlots } from "./plots.js";
import { recordingPart } from "./recording.js";
import { isEnabled, isUnattended } from "./robot.js";
import { pngButton } from "./save.js";
import { current } from "./server.js";
import { timingPart } from "./timing.js";
import { attempt, draw } from "./ui.js";

let chosen = /** @type {Set<string> | null} */ (null); // the names of the signals in the plots; null: the first ones
let port = ""; // the port in the field
let drawing = false;

/** @param {State} state */
export const liveTitle = ({ live: { target } }) =>
  target ? `Live ${isOld() ? "? old" : TITLES[Number(isEnabled(target)) + Number(isUnattended(target))]}` : "Live";

const TITLES = ["○ disabled", "● enabled", "● enabled, unattended"];

/** @param {State} state */
export function livePanel(state) {
  const { target } = state.live;
  if (!target) {
    typed.clear();
    sent.clear();
    const key = keyPart(state.live.locked, (body) => request("connect", body));
    return [problemPart(state.live.problem), problemPart(refusal()), key, portsPart(state.live)];
  }
  const ported = shownSignals(target).filter((index) => !target.signals[index].loop);
  return [
    headPart(target),
    problemPart(refusal()),
    isOld() && h("p.alarm", { key: "old" }, `The values are old: no news for ${Math.floor(age())} s.`),
    signalsPart(target),
    h("div.plots", { key: "plots", keep: true, shown: (place) => drawPlotsNow(place, target) }),
    h(
      "div.live-columns",
      { key: "columns" },
      setpointsPart(target),
      parametersPart(target),
      actuatorsPart(target),
      linesPart(),
    ),
    savePart(target),
    recordingPart(target, ported, command),
    comparisonPart(state, ported),
    timingPart(target),
  ];
}

const problemPart = (problem) =>
  problem &&
  h("p.failed-end", { key: "problem" }, icon("error"), h("b", problem.message), h("span.hint", problem.hint));

// Before a connection

const WITHOUT_CONSOLE = `This target has no console, so the page cannot watch or enable it. Behind an agent there are
 its topics, diagnostics and parameters of ROS 2, and the topic ~/enable, which disables it. 'console: true' in
 'communication' adds a console, if the target has a second port.`;

function portsPart({ ports, console }) {
  const list = h(
    "datalist",
    { id: "live-ports" },
    ports.map(({ path }) => option(path, "")),
  );
  const shown = port || ports[0]?.path || "";
  return h(
    "form",
    {
      key: "ports",
      onsubmit: (event) => {
        event.preventDefault();
        request("connect", { path: port || shown });
      },
    },
    h(
      "p.empty",
      console
        ? "Watch and tune a running target: a board with the console on a serial port, or a program on this computer or on another one (udp:HOST:PORT)."
        : WITHOUT_CONSOLE,
    ),
    h("label", { for: "live-port" }, "Port "),
    h("input", {
      id: "live-port",
      type: "text",
      list: "live-ports",
      initial: shown,
      spellcheck: "false",
      oninput: (event) => {
        port = event.target.value;
      },
    }),
    list,
    " ",
    h("button", { class: "primary" }, "Connect"),
    h(
      "p.hint",
      ports.length
        ? ports.map((each) => `${each.path} ${each.device}`).join(", ")
        : "There is no serial port. Run in the tab Build starts a program of this computer with a port.",
    ),
  );
}

// The head: enable, state, fault

function headPart(target) {
  return h(
    "div.live-head",
    { key: "head", shown: keepInSight },
    enablePart(target),
    h("button.quiet", { key: "disconnect", onclick: () => request("disconnect") }, "Disconnect"),
    !target.matches &&
      h("p.failed-end", { key: "other" }, "another firmware than that of the last build: it can only be watched"),
    live.dropped > 0 && h("p.hint", { key: "dropped" }, `${live.dropped} rows dropped`),
    goalsPart(target),
    answersPart(target),
    h(
      "p.hint",
      { key: "hint" },
      "While the robot is enabled, space and Escape stop it. They are not an emergency stop, and do nothing while another window is in front.",
    ),
    faultPart(target),
  );
}

const heights = new ResizeObserver((all) => {
  for (const { target } of all) setHeight(target);
});

// The browser scrolls an element that gets the focus to a place that the head does not cover (see style.css).
function keepInSight(head) {
  heights.observe(head);
  setHeight(head);
}

function setHeight(head) {
  document.documentElement.style.setProperty("--live-head", `${head.offsetHeight}px`);
}

// The latched fault: its cause, and the next steps of the user.
const faultPart = ({ fault }) =>
  fault &&
  h("p.failed-end", { key: "fault", role: "alert" }, icon("error"), h("b", fault.text), h("span.hint", fault.remedy));

// Plots

function shownSignals(target) {
  if (chosen === null) chosen = new Set(target.signals.slice(0, 4).map((each) => each.name));
  return target.signals.flatMap((each, index) => (chosen.has(each.name) ? [index] : []));
}

function signalsPart(target) {
  const shown = shownSignals(target);
  return h(
    "fieldset.live-signals",
    { key: "signals" },
    h("legend", "Signals"),
    target.signals.map((each, index) =>
      h(
        "div.live-signal",
        { key: each.name },
        h(
          "label",
          h("input", {
            type: "checkbox",
            checked: shown.includes(index),
            onchange: (event) => {
              if (event.target.checked) chosen.add(each.name);
              else chosen.delete(each.name);
              draw();
            },
          }),
          swatch(colour(index), dash(index)),
          ` ${each.name}`,
        ),
        value(index, each.unit), // not in the label: a name must not change all the time
      ),
    ),
  );
}

function savePart(target) {
  if (!target.every) {
    const text = "This target has no memory for streams and recordings: see 'capture' in the settings of its .tcf.";
    return h("p.hint", { key: "save" }, text);
  }
  const shown = shownSignals(target).map((index) => ({
    name: target.signals[index].name,
    colour: colour(index),
    dash: dash(index),
  }));
  const button = (form, text, title) =>
    h("button", { key: form, title, onclick: () => save("stream", form, `${target.name}.${form}`) }, text);
  return h(
    "div.live-save",
    { key: "save" },
    button("csv", "Save as CSV", "All signals, as far back as they are recorded"),
    button("mcap", "Save as MCAP", "For PlotJuggler and Foxglove"),
    pngButton(".plots", shown, `${target.name}.png`, { title: "The plots", disabled: !shown.length }),
    h("p.hint.live-kept", { key: "kept" }, keptText()),
    h("p.hint", { key: "making", role: "status" }, MAKING[isMade()]),
  );
}

// The time since which rows are recorded, their size, and how far a file with them has been written.
function keptText() {
  if (!live.kept?.since) return "";
  const { since, size, most, problem, saving } = live.kept;
  if (problem) return `The newest values are not recorded: ${problem}.`;
  const time = new Date(1000 * since).toLocaleTimeString();
  const text = `Recorded since ${time}: ${(size / 1e6).toFixed(0)} MB of at most ${(most / 1e6).toFixed(0)} MB.`;
  return saving === null ? text : `${text} The file is written: ${Math.round(100 * saving)} %.`;
}

function drawKept() {
  const place = document.querySelector(".live-kept");
  const text = keptText();
  if (place && place.textContent !== text) place.textContent = text;
}

const MAKING = {
  csv: "EPG makes the file.",
  mcap: "EPG makes the file. If its package for MCAP is not installed, EPG installs it first: this can take some minutes.",
};

// Reads the events of the target, if one is connected. Must be called with every new state.
/** @param {State} state */
export function followLive(state) {
  const target = state.live?.target;
  if (target) followTarget(target.signals, whenTold);
}

function whenTold(all) {
  moveOn();
  if (all) again();
  else drawSoon();
}

function again() {
  if (current()) followLive(current());
  draw();
}

function drawSoon() {
  if (drawing || document.hidden) return;
  drawing = true;
  requestAnimationFrame(() => {
    const begin = performance.now();
    const place = /** @type {HTMLElement | null} */ (document.querySelector(".plots"));
    const target = current()?.live?.target;
    if (target) {
      drawValues();
      drawKept();
    }
    if (target && place) drawPlotsNow(place, target);
    // On a slow computer, keys and signs of life have as much time as drawing.
    setTimeout(() => {
      drawing = false;
    }, performance.now() - begin);
  });
}

function drawPlotsNow(place, target) {
  if (live.times.length && place.clientWidth) drawPlots(place, target.signals, shownSignals(target));
}

// Setpoints, parameters, actuators, lines

const setpointsPart = ({ setpoints }) =>
  setpoints.length > 0 &&
  h(
    "section",
    { key: "setpoints" },
    h("h3", "Setpoints"),
    setpoints.map((each) => valueField(id("setpoint", each.name), each, "", (text) => command(`${each.name}=${text}`))),
  );

const parametersPart = ({ parameters, matches }) =>
  parameters.length > 0 &&
  h(
    "section",
    { key: "parameters", class: "live-parameters" },
    h("h3", "Parameters"),
    parameters.map((each) => {
      const changed = each.value !== each.generated;
      return h(
        "div.live-parameter",
        { key: each.name },
        valueField(id("parameter", each.name), { name: each.name, unit: each.unit }, String(each.value), (text) =>
          command(`set ${each.name}=${text}`),
        ),
        each.low !== null && each.high !== null && slider(each),
        changed &&
          matches &&
          h(
            "button.quiet",
            {
              title: `The firmware was built with ${each.generated}`,
              onclick: () =>
                attempt("fill", { changes: [{ path: ["parameters", each.name], text: String(each.value) }] }),
            },
            "Keep in the bindings",
          ),
      );
    }),
  );

const slider = (each) =>
  h("input", {
    type: "range",
    "aria-label": [each.name, each.unit].filter(Boolean).join(" "),
    min: each.low,
    max: each.high,
    step: (each.high - each.low) / 200,
    initial: each.value,
    onchange: (event) => command(`set ${each.name}=${event.target.value}`),
  });

// Texts of fields, by their ids: typed and not sent; and sent last, with the value that the field had before.
const typed = /** @type {Map<string, string>} */ (new Map());
const sent = /** @type {Map<string, {text: string, instead: string}>} */ (new Map());

// A field of a number. Enter sends it. Until then the field is marked, and Escape restores `known`, the number of the
// target, or else the number that was sent last. The unit belongs to the field's name.
function valueField(key, { name, unit, low = null, high = null }, known, send) {
  const last = sent.get(key);
  const shown = last?.instead === known ? last.text : known;
  const isTyped = typed.has(key);
  const take = (text) => {
    if (text.trim() === shown) typed.delete(key);
    else typed.set(key, text);
    draw();
  };
  const act = async (text) => {
    if (!(await send(text))) return; // it is still not sent
    sent.set(key, { text, instead: known });
    if (typed.get(key)?.trim() === text) typed.delete(key);
    draw();
  };
  const names = [`${key}-name`, unit && `${key}-unit`].filter(Boolean).join(" ");
  const range = low === null && high === null ? "" : `${low} to ${high} `;
  return h(
    "div",
    { key, class: `field${isTyped ? " unsent" : ""}` },
    h("label", { key: "name", id: `${key}-name`, for: key }, name),
    h("input", {
      key: "input",
      id: key,
      type: "text",
      inputmode: "decimal",
      initial: typed.get(key) ?? shown,
      spellcheck: "false",
      "aria-labelledby": names,
      "aria-describedby": `${key}-range ${key}-unsent`,
      oninput: (event) => take(event.target.value),
      onkeydown: (event) => {
        if (event.key === "Escape" && isTyped) take(shown);
        else sendWithEnter(event, act);
      },
    }),
    (range || unit) &&
      h(
        "span.hint",
        { key: "unit" },
        h("span", { key: "range", id: `${key}-range` }, range),
        h("span", { key: "unit", id: `${key}-unit` }, unit),
      ),
    isTyped &&
      h(
        "span.not-sent",
        { key: "unsent", id: `${key}-unsent` },
        `not sent: Enter sends it, Escape restores ${shown || "the empty field"}`,
      ),
  );
}

function sendWithEnter(event, send) {
  const text = event.target.value.trim();
  if (event.key !== "Enter" || event.repeat || !text) return;
  event.preventDefault(); // the same key must not press a button of a dialog that opens
  send(text);
}

const linesPart = () =>
  h(
    "section",
    { key: "lines", class: "live-console" },
    h("h3", "Console"),
    h("div.log-end", { role: "log", "aria-label": "Console", tabindex: "0" }, h("pre.log", live.lines.join("\n"))),
    h(
      "div.field",
      h("label", { for: "live-command" }, "Command"),
      h("input", {
        id: "live-command",
        type: "text",
        spellcheck: "false",
        autocomplete: "off",
        onkeydown: (event) => sendWithEnter(event, command),
      }),
    ),
  );
