// SPDX-License-Identifier: Apache-2.0
// "Live": a running target. Plots of its signals, its parameters, and the buttons that enable, move and stop it.

import { comparisonPart } from "./comparison.js";
import { swatch } from "./curves.js";
import { h, id } from "./dom.js";
import { icon } from "./icons.js";
import { followTarget, live, page, tell } from "./live_events.js";
import { drawValues, value } from "./live_values.js";
import { colour, drawPlots } from "./plots.js";
import { held, repeated } from "./press.js";
import { recordingPart } from "./recording.js";
import { saveFrom, savePng } from "./save.js";
import { ask, askRepeatedly, current } from "./server.js";
import { timingPart } from "./timing.js";
import { attempt, draw, say, ui } from "./ui.js";

const HOLD = 500; // ms that the button for enabling must be pressed
const PULSE = 100; // ms between two commands that prolong a movement; each lasts 250 ms at most

let chosen = /** @type {Set<string> | null} */ (null); // the names of the signals in the plots; null: the first ones
let refused = null; // the last error: {message, hint}
let port = ""; // the port in the field
let drawing = false;

/** @param {State} state */
export const liveTitle = ({ live: { target } }) =>
  target ? `Live ${isEnabled(target) ? "● enabled" : "○ disabled"}` : "Live";

const isEnabled = (target) => target.state.enabled === "1";

const move = askRepeatedly("move", 1);

async function request(action, body) {
  const answer = await ask(action, body);
  refused = answer.error ?? null;
  if (refused) say(`Refused: ${refused.message}`);
  draw();
  return answer;
}

/** @param {State} state */
export function livePanel(state) {
  const { target } = state.live;
  if (!target) return [problemPart(state.live.problem), problemPart(refused), portsPart(state.live)];
  const ported = shownSignals(target).filter((index) => !target.signals[index].loop);
  return [
    headPart(target),
    problemPart(refused),
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
    ports.map((each) => h("option", { key: each.path, value: each.path })),
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

// The head: state, stop, enable

function headPart(target) {
  const enabled = isEnabled(target);
  return h(
    "div.live-head",
    { key: "head" },
    h("button", { key: "stop", class: "stop", title: "Space bar", onpointerdown: stop, onclick: stop }, "Stop"),
    h(
      "p",
      { key: "state", class: enabled ? "live-enabled" : "", role: "status" },
      h("b", target.name),
      enabled ? " enabled" : " disabled",
      !target.matches && h("span.failed-end", " another firmware than that of the last build: it can only be watched"),
      live.dropped > 0 && h("span.hint", ` ${live.dropped} rows dropped`),
    ),
    h(
      "button.hold",
      { key: "enable", disabled: enabled || !target.matches, ...held(() => request("enable", { page }), HOLD) },
      "Enable (hold)",
    ),
    h("button.quiet", { key: "disconnect", onclick: () => request("disconnect") }, "Disconnect"),
    h(
      "p.hint",
      { key: "hint" },
      "The space bar stops. It is not an emergency stop, and does nothing while another window is in front.",
    ),
    faultPart(target),
  );
}

// The latched fault: its cause, and the next steps of the user.
const faultPart = ({ fault }) =>
  fault &&
  h("p.failed-end", { key: "fault", role: "alert" }, icon("error"), h("b", fault.text), h("span.hint", fault.remedy));

// Stop in the head of the page, for the other tabs. While the tab Live is shown, it has a button of its own.
/** @param {State} state */
export const stopButton = (state) =>
  state.live?.target &&
  !isShown() &&
  h("button", { key: "stop-robot", class: "stop", onpointerdown: stop, onclick: stop }, "Stop robot");

const isShown = () => ui.tab === "live" && ui.dock !== "closed";

// Disables the target. It has a connection of its own (see server.js), and is never behind other requests.
function stop() {
  request("stop");
}

window.addEventListener("keydown", (event) => spaceBar(event, true), { capture: true });
window.addEventListener("keyup", (event) => spaceBar(event, false), { capture: true });

// In the tab Live the space bar stops the target, wherever the focus is, and does nothing else.
function spaceBar(event, stops) {
  if (event.key !== " " || !isShown() || !current()?.live?.target) return;
  event.preventDefault();
  event.stopPropagation();
  if (stops && !event.repeat) stop();
}

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
        "label",
        { key: each.name },
        h("input", {
          type: "checkbox",
          checked: shown.includes(index),
          onchange: (event) => {
            if (event.target.checked) chosen.add(each.name);
            else chosen.delete(each.name);
            draw();
          },
        }),
        swatch(colour(index)),
        ` ${each.name} `,
        value(index, each.unit),
      ),
    ),
  );
}

function savePart(target) {
  if (!target.every) {
    const text = "This target has no memory for streams and recordings: see 'capture' in the settings of its .tcf.";
    return h("p.hint", { key: "save" }, text);
  }
  const shown = shownSignals(target).map((index) => ({ name: target.signals[index].name, colour: colour(index) }));
  const save = async (form) => {
    try {
      refused = null;
      await saveFrom(`api/live/save?what=stream&as=${form}`, `${target.name}.${form}`);
    } catch (error) {
      refused = JSON.parse(/** @type {Error} */ (error).message).error;
    }
    draw();
  };
  return h(
    "p.live-save",
    { key: "save" },
    h("button", { onclick: () => save("csv"), title: "All signals, as far back as EPG keeps them" }, "Save as CSV"),
    h("button", { onclick: () => save("mcap"), title: "For PlotJuggler and Foxglove" }, "Save as MCAP"),
    h(
      "button",
      {
        title: "The plots",
        disabled: !shown.length,
        onclick: () => savePng(document.querySelector(".plots"), shown, `${target.name}.png`),
      },
      "Save as PNG",
    ),
  );
}

// Reads the events of the target, if one is connected. Must be called with every new state.
/** @param {State} state */
export function followLive(state) {
  const target = state.live?.target;
  if (target) followTarget(target.signals, (all) => (all ? again() : drawSoon()));
}

function again() {
  if (current()) followLive(current());
  draw();
}

function drawSoon() {
  if (drawing || document.hidden) return;
  drawing = true;
  requestAnimationFrame(() => {
    drawing = false;
    const place = /** @type {HTMLElement | null} */ (document.querySelector(".plots"));
    const target = current()?.live?.target;
    if (!target) return;
    drawValues();
    if (place) drawPlotsNow(place, target);
  });
}

function drawPlotsNow(place, target) {
  if (live.times.length && place.clientWidth) drawPlots(place, target.signals, shownSignals(target));
}

// Setpoints, parameters, actuators, lines

async function command(line) {
  const { answer, error } = await request("command", { line });
  tell([`> ${line}`, ...(answer ?? [`error ${error.message}`])]);
  draw();
}

const setpointsPart = ({ setpoints }) =>
  setpoints.length > 0 &&
  h(
    "section",
    { key: "setpoints" },
    h("h3", "Setpoints"),
    setpoints.map((name) => field(id("setpoint", name), name, "", "", (text) => command(`${name}=${text}`))),
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
        field(id("parameter", each.name), each.name, String(each.value), each.unit, (text) =>
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
    "aria-label": each.name,
    min: each.low,
    max: each.high,
    step: (each.high - each.low) / 200,
    initial: each.value,
    onchange: (event) => command(`set ${each.name}=${event.target.value}`),
  });

// A field that sends its text with Enter.
function field(key, label, text, unit, send) {
  return h(
    "div.field",
    { key },
    h("label", { for: key }, label),
    h("input", {
      id: key,
      type: "text",
      inputmode: "decimal",
      initial: text,
      spellcheck: "false",
      onkeydown: (event) => {
        if (event.key === "Enter" && event.target.value.trim()) send(event.target.value.trim());
      },
    }),
    unit && h("span.hint", unit),
  );
}

const actuatorsPart = (target) =>
  target.actuators.length > 0 &&
  h(
    "section",
    { key: "actuators" },
    h("h3", "Move by hand"),
    h("p.hint", isEnabled(target) ? "Stop the target first." : "Hold a button: the actuator moves with a duty of 0.1."),
    target.actuators.map((name) =>
      h(
        "p",
        { key: name },
        `${name} `,
        [-0.1, 0.1].map((duty) =>
          h(
            "button",
            {
              key: String(duty),
              "aria-label": `Move ${name} ${duty < 0 ? "backwards" : "forwards"}`,
              disabled: isEnabled(target) || !target.matches,
              ...repeated(() => move({ actuator: name, duty }), PULSE),
            },
            duty < 0 ? "−" : "+",
          ),
        ),
      ),
    ),
  );

const linesPart = () =>
  h(
    "section",
    { key: "lines", class: "live-console" },
    h("h3", "Console"),
    h("div.log-end", { role: "log", "aria-label": "Console", tabindex: "0" }, h("pre.log", live.lines.join("\n"))),
    field("live-command", "Command", "", "", command),
  );
