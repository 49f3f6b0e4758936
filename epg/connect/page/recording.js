// SPDX-License-Identifier: Apache-2.0
// Recordings of every control cycle around a trigger, which a running target makes in its memory.

import { curvesPart } from "./curves.js";
import { h, listField, option } from "./dom.js";
import { save } from "./live_commands.js";
import { colour, dash } from "./plots.js";
import { pngButton } from "./save.js";
import { getJson } from "./server.js";
import { draw } from "./ui.js";

const MOST = 8; // signals of a recording

// The texts of the form.
const form = { when: "now", signal: "", level: "0", rows: "", before: "0", every: "1" };
let fetched = 0; // the number of the recording that was fetched
let recorded = /** @type {import("./curves.js").Curves | null} */ (null);

/**
 * The part of the tab Live with the form and the last recording. `chosen` are indices of signals; `send` sends a
 * command to the target.
 * @param {LiveTarget} target
 * @param {number[]} chosen
 * @param {(line: string) => void} send
 */
export function recordingPart(target, chosen, send) {
  if (!target.every) return null;
  fetchRecorded(target);
  const signals = chosen.slice(0, MOST);
  const { capture } = target;
  const records = capture.state === "recording";
  return h(
    "section.live-recording",
    { key: "recording", "aria-labelledby": "recording-title" },
    h("h3", { id: "recording-title" }, "Record every cycle"),
    h(
      "p.hint",
      { key: "hint" },
      signals.length
        ? `The target records ${chosen.length > MOST ? `the first ${MOST} of the` : "the"} chosen signals in its memory.`
        : "Choose signals above.",
    ),
    h(
      "form",
      {
        key: "form",
        onsubmit: (event) => {
          event.preventDefault();
          send(commandOf(target, signals));
        },
      },
      listField(
        "recording-when",
        "Trigger",
        { value: form.when, onchange: (event) => fill("when", event.target.value) },
        Object.entries(WHEN).map(([value, text]) => option(value, text)),
      ),
      "<>".includes(form.when) && [
        listField(
          "recording-signal",
          "Signal",
          { value: watched(target), onchange: (event) => fill("signal", event.target.value) },
          target.signals.filter((each) => !each.loop).map((each) => option(each.name)),
        ),
        input("level", "Level"),
      ],
      form.when !== "now" && input("before", "Rows before it"),
      input("rows", "Rows", "as many as fit"),
      input("every", "Every n-th cycle"),
      h(
        "button",
        { key: "record", class: "primary", disabled: records || !signals.length || !target.matches },
        "Record",
      ),
      records && h("button", { key: "end", type: "button", onclick: () => send("capture stop") }, "End the recording"),
    ),
    records && progressPart(capture),
    recorded && resultPart(target.name, recorded),
  );
}

const WHEN = { now: "at once", ">": "signal rises to", "<": "signal falls to", fault: "fault" };

function fill(name, text) {
  form[name] = text;
  draw();
}

const input = (name, label, placeholder = null) =>
  h(
    "div.field",
    { key: name },
    h("label", { for: `recording-${name}` }, label),
    h("input", {
      id: `recording-${name}`,
      type: "text",
      inputmode: "decimal",
      initial: form[name],
      placeholder,
      oninput: (event) => {
        form[name] = event.target.value.trim();
      },
    }),
  );

function progressPart({ rows, wanted }) {
  const text = rows < wanted ? `${rows} of ${wanted} rows` : "Waiting for the trigger";
  return h(
    "p",
    { key: "progress", role: "status" },
    h("progress", { "aria-label": "Recording", max: wanted, value: rows < wanted ? rows : null }),
    ` ${text}`,
  );
}

const watched = ({ signals }) => (signals.some((each) => each.name === form.signal) ? form.signal : signals[0]?.name);

// A name without its first part, if no other signal has it: a command has at most 256 characters.
function short({ signals }, name) {
  const end = (text) => text.slice(text.indexOf(".") + 1);
  return signals.filter((each) => end(each.name) === end(name)).length === 1 ? end(name) : name;
}

function commandOf(target, signals) {
  const words = ["capture", ...signals.map((index) => short(target, target.signals[index].name))];
  if (form.rows) words.push(`rows=${form.rows}`);
  if (form.every !== "1") words.push(`every=${form.every}`);
  if (form.when === "now") return words.join(" ");
  words.push(`before=${form.before || 0}`);
  const level = form.when === "fault" ? "" : `${short(target, watched(target))}${form.when}${form.level}`;
  words.push(`when=${level || "fault"}`);
  return words.join(" ");
}

// Fetches a new recording.
async function fetchRecorded(target) {
  const { number } = target.capture;
  if (number === fetched) return;
  fetched = number;
  recorded = null;
  if (!number) return;
  try {
    const { names, times, columns, triggered } = await getJson("api/live/capture");
    const known = target.signals.map((each) => each.name);
    const curves = names.map((name, column) => {
      const index = known.indexOf(name);
      return {
        name,
        unit: target.signals[index]?.unit ?? "",
        colour: colour(index),
        dash: dash(index),
        values: columns[column],
      };
    });
    recorded = { times, mark: triggered, curves };
    draw();
  } catch {
    // the connection has ended, and the state says so
  }
}

/** @param {import("./curves.js").Curves} shown */
function resultPart(name, shown) {
  const { times, mark, curves } = shown;
  const text = `${times.length} rows. ${mark ? "The trigger is at 0 s." : "There was no trigger."}`;
  return h(
    "div.recorded",
    { key: "result" },
    h("p", { key: "text" }, text),
    curvesPart(`Recording of ${curves.map((each) => each.name).join(", ")}. ${text}`, shown),
    h(
      "p",
      { key: "save" },
      h("button", { onclick: () => save("capture", "csv", `${name}-recording.csv`) }, "Save as CSV"),
      " ",
      pngButton(".recorded", curves, `${name}-recording.png`),
    ),
  );
}
