// SPDX-License-Identifier: Apache-2.0
// The dialog of one wire: scale, offset, limits, unit.

import { closeDialog, dialogButtons, openDialog } from "./dialog.js";
import { h, id, refusalPart, textField } from "./dom.js";
import { isError } from "./problems.js";
import { act, current } from "./server.js";
import { draw, say, ui } from "./ui.js";
import { endsOf, modelPort, plain, replaceEnd } from "./wiring.js";

export function editConversion(port, n) {
  const found = modelPort(current(), port);
  if (!found || !endsOf(current(), port)[n]) return;
  const { reference } = endsOf(current(), port)[n];
  const [from, to] = found.side === "inputs" ? [reference, port] : [port, reference];
  let error = null;
  let typed = null; // what the fields contain; null before the first change

  const apply = async (event) => {
    event.preventDefault();
    const value = (name) => event.target.elements[name].value.trim();
    /** @type {[string, string] | null} */
    const limits = value("low") || value("high") ? [value("low"), value("high")] : null;
    if (limits && !(limits[0] && limits[1])) {
      error = { message: "Limits need both values, the lowest and the highest", hint: "" };
      draw();
      return;
    }
    const ends = endsOf(current(), port).map(plain);
    ends[n] = { reference, scale: value("scale"), offset: value("offset"), limits, unit: value("unit") };
    const before = errorsOf(port).map((each) => each.message);
    error = await act("connect", { port, ends });
    // A wrong value, such as a scale that is not a number, is accepted with an error message. Show that message in the
    // dialog, where the user can correct the value.
    error = error || errorsOf(port).find((each) => !before.includes(each.message)) || null;
    draw();
    if (error) return;
    ui.refused = null;
    closeDialog();
    const text = endsOf(current(), port)[n]?.text;
    say(text ? `${from} to ${to}: ${text}` : `${from} to ${to} without a conversion`);
  };

  openDialog("conversion", `${from} → ${to}`, () => {
    const end = endsOf(current(), port)[n];
    // Another program may have removed the wire.
    if (!end || end.reference !== reference) return null;
    const readonly = !current().editable;
    const field = (name, label, initial, hint) =>
      textField(`conversion-${name}`, label, { name, initial, readonly, autofocus: name === "scale" }, hint);
    return h(
      "form",
      {
        onsubmit: apply,
        autocomplete: "off",
        novalidate: true,
        oninput: (event) => {
          const elements = [...event.currentTarget.elements].filter((each) => each.name);
          typed = Object.fromEntries(elements.map((each) => [each.name, each.value.trim()]));
          draw();
        },
      },
      h(
        "p.muted",
        "The value is multiplied by the scale, the offset is added, and the result is kept within the limits. ",
        "An empty field has no effect.",
      ),
      end.from_tcf && h("p", "The .tcf also converts the value: ", h("b", end.from_tcf)),
      h(
        "div.fields",
        field("scale", "Scale", end.scale, "a number or a ratio such as 361/5625; replaces the conversion of units"),
        field("offset", "Offset", end.offset),
        field("low", "Lowest", end.limits?.[0]),
        field("high", "Highest", end.limits?.[1]),
        field("unit", "Unit", end.unit, "unit of the value in the model, if it differs from the port's unit"),
      ),
      h("p.preview", { role: "status" }, preview(found, end, typed || fieldsOf(end))),
      refusalPart(error),
      dialogButtons(
        "Apply",
        { disabled: readonly },
        h("button", { type: "button", disabled: readonly, onclick: () => remove(port, n) }, "Remove wire"),
      ),
    );
  });
}

function remove(port, n) {
  closeDialog();
  replaceEnd(port, n, null);
  document.getElementById(id("ends", port, 0))?.focus();
}

const fieldsOf = ({ scale, offset, limits, unit }) => ({
  scale: scale || "",
  offset: offset || "",
  low: limits?.[0] || "",
  high: limits?.[1] || "",
  unit: unit || "",
});

// Two values before and after the conversion in the fields, with their units: "0 deg → 0 rad, 1 deg → 0.0174533 rad".
/**
 * @param {{ side: string, port: Port }} found
 * @param {End} end
 */
function preview({ side, port }, end, { scale, offset, low, high, unit }) {
  const modelUnit = unit || end.model_unit || port.unit;
  const { component_unit: componentUnit } = end;
  const [before, after] = side === "inputs" ? [componentUnit, modelUnit] : [modelUnit, componentUnit];
  const factor = scale ? 1 : unitFactor(before, after);
  const numbers = [scale || "1", offset || "0", low || "-Infinity", high || "Infinity"].map(number);
  if (numbers.some(Number.isNaN)) return "";
  const [scaled, shifted, lowest, highest] = numbers;
  const limit = (value) => Math.min(Math.max(value, lowest), highest);
  const convert = (value) =>
    side === "inputs" ? limit(value * factor * scaled + shifted) : limit(value * scaled + shifted) * factor;
  const shown = (value, unitOfIt) => [Number(value.toPrecision(6)), unitOfIt].filter((part) => part !== "").join(" ");
  return [0, 1].map((value) => `${shown(value, before)} → ${shown(convert(value), after)}`).join(", ");
}

// The factor from one unit to another; 1 if one is missing or unknown, or if they measure different quantities.
function unitFactor(before, after) {
  const { [before]: from, [after]: to } = current().units;
  return before && after && from && to && from[0] === to[0] ? from[1] / to[1] : 1;
}

// A number as the bindings write it: "0.5", or a ratio such as "361/5625".
function number(text) {
  const parts = text.split("/").map((part) => (part.trim() === "" ? NaN : Number(part)));
  return parts.length === 2 ? parts[0] / parts[1] : parts.length === 1 ? parts[0] : NaN;
}

const errorsOf = (port) => current().diagnostics.filter((each) => each.port === port && isError(each));
