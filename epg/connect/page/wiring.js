// SPDX-License-Identifier: Apache-2.0
// The wires in the session's state, and the actions that change them. A side is one of
//   sources   component ports that give a value      inputs   inputs of the model
//   outputs   outputs of the model                   sinks    component ports that take a value

import { h } from "./dom.js";
import { current } from "./server.js";
import { attempt, say, ui } from "./ui.js";

export const OPPOSITE = { sources: "inputs", inputs: "sources", outputs: "sinks", sinks: "outputs" };
export const ofModel = (side) => side === "inputs" || side === "outputs";

/** @param {State} state */
export function modelPort(state, name) {
  for (const side of ["inputs", "outputs"]) {
    const port = state.model?.[side].find((each) => each.name === name);
    if (port) return { side, port };
  }
  return null;
}

/** @param {State} state */
export const endsOf = (state, port) => state.wires[port] || [];
/** @param {State} state */
export const isUnconnected = (state, port) => port in state.wires && state.wires[port].length === 0;

// True if two ends fit in direction, type and unit, according to the server.
/** @param {State} state */
export function fits(state, side, name, other) {
  const [port, reference] = ofModel(side) ? [name, other] : [other, name];
  return (state.fits[port] || []).includes(reference);
}

export function unitText({ unit, type }) {
  return [unit || "no unit", type === "real" ? "" : type].filter(Boolean).join(", ");
}

// The unit beside the name of a port; a dash for a real port without a unit.
export function unitMark(port) {
  const text = unitText(port);
  return h("span.unit", { title: port.unit ? null : text }, port.unit ? text : port.type === "real" ? "–" : port.type);
}

// The fields of an end that api/connect takes.
/** @param {Partial<End>} end */
export function plain({ reference, scale, offset, limits, unit }) {
  return { reference, scale: scale || "", offset: offset || "", limits: limits || null, unit: unit || "" };
}

export function setEnds(port, ends) {
  return attempt("connect", { port, ends: ends.map(plain) }, port);
}

export async function disconnect(port) {
  if (await attempt("disconnect", { port }, port)) say(`${port} is not connected`);
}

// Changes the wires of several ports in one step: `wires` maps ports to their ends. A port without ends is removed.
function rewire(wires, port) {
  const changes = Object.entries(wires).map(([name, ends]) => ({
    port: name,
    ends: ends.length ? ends.map(plain) : null,
  }));
  return attempt("rewire", { changes }, port);
}

// The ports whose wires end at a component port.
/** @param {State} state */
const usersOf = (state, reference) =>
  Object.keys(state.wires).filter((port) => endsOf(state, port).some((end) => end.reference === reference));

// Connects a component port and a model port. `side` and `name` are the end that was taken first, `other` is the
// second. An input has one source, and a sink has one driver: a new wire replaces the old one. An output may drive
// several sinks.
export async function join(side, name, other) {
  const [port, reference] = ofModel(side) ? [name, other] : [other, name];
  const state = current();
  const isOutput = side === "outputs" || side === "sinks";
  if (endsOf(state, port).some((end) => end.reference === reference)) {
    say(`${port} and ${reference} are connected already`);
    return;
  }
  /** @type {Record<string, Partial<End>[]>} */
  const wires = {};
  const replaced = isOutput ? usersOf(state, reference) : [];
  for (const user of replaced) wires[user] = endsOf(state, user).filter((end) => end.reference !== reference);
  wires[port] = [...(isOutput ? endsOf(state, port) : []), { reference }];
  if (await rewire(wires, port)) announceWire(port, reference, replaced);
}

// Moves the end of all wires at the port `name` to the port `other` of the same side. Their conversions stay.
export async function move(side, name, other) {
  const state = current();
  const wires = {};
  if (ofModel(side)) {
    const isOutput = side === "outputs";
    wires[name] = [];
    wires[other] = [...(isOutput ? endsOf(state, other) : []), ...endsOf(state, name)];
  } else {
    const replaced = side === "sinks" ? usersOf(state, other) : [];
    for (const port of new Set([...replaced, ...usersOf(state, name)])) {
      wires[port] = endsOf(state, port)
        .filter((end) => side === "sources" || end.reference !== other)
        .map((end) => (end.reference === name ? { ...end, reference: other } : end));
    }
  }
  if (await rewire(wires, ofModel(side) ? other : null)) say(`The wire of ${name} now ends at ${other}`);
}

/** @param {State} state */
export const isConnected = (state, side, name) =>
  ofModel(side) ? endsOf(state, name).length > 0 : usersOf(state, name).length > 0;

// Replaces end number `n` of a port, from 0. A `reference` of null removes the end.
export async function replaceEnd(port, n, reference) {
  /** @type {Partial<End>[]} */
  const ends = [...endsOf(current(), port)];
  if (reference === null) ends.splice(n, 1);
  else ends.splice(n, 1, { reference });
  ui.adding = null;
  if (ends.length === 0) await disconnect(port);
  else if ((await setEnds(port, ends)) && reference) announceWire(port, reference);
}

function announceWire(port, reference, replaced = []) {
  const problems = current().diagnostics.filter((each) => each.port === port);
  const what = problems.map((each) => `${each.severity}: ${each.message}`).join(". ");
  const instead = replaced.length ? ` instead of ${replaced.join(" and ")}` : "";
  say(`${port} is connected with ${reference}${instead}. ${what}`);
}
