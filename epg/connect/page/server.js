// SPDX-License-Identifier: Apache-2.0
// The other end: the newest State by long polling, and actions.

import { lock, sign, unlock, whyLocked } from "./key.js";

let state = null;
let lost = false;
let locked = null;
let ended = false;
let changed = () => {};

export const current = () => state;
export const isLost = () => lost;
export const hasEnded = () => ended;

// Calls `whenChanged` with every new State, and when the connection is lost or found again; never returns.
export async function follow(whenChanged) {
  changed = whenChanged;
  await unlock();
  // An address that is opened in the tab of another one of EPG's only changes what stands behind its #.
  window.addEventListener("hashchange", unlock);
  while (!ended) {
    const next = await newest();
    if (ended) return;
    const differs = lost !== (next === null) || locked !== whyLocked();
    lost = next === null;
    locked = whyLocked();
    try {
      if (lost) {
        if (differs) changed();
      } else {
        take(next, differs);
      }
    } catch (error) {
      reportError(error); // a mistake of the page is none of the connection
    }
    if (lost) await new Promise((resolve) => setTimeout(resolve, 1500));
  }
}

async function newest() {
  if (whyLocked()) return null;
  try {
    // After a loss the state may have been missed.
    const answer = await request(`api/state?after=${state === null || lost ? 0 : state.version}`);
    return answer.ok ? await answer.json() : null;
  } catch {
    return null;
  }
}

function take(next, always = false) {
  const newer = state === null || next.version > state.version || always;
  if (newer) state = next;
  if (newer || always) changed();
}

// Does an action; null, or what speaks against it: {message, hint}.
export async function act(action, body = {}) {
  let answer, data;
  try {
    answer = await request(`api/${action}`, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(body),
    });
    data = await answer.json();
  } catch {
    if (action === "done") {
      ended = true;
      changed();
      return null;
    }
    lost = true;
    changed();
    return { message: "EPG does not answer", hint: "" };
  }
  if (!answer.ok) return data.error;
  if (action === "done") {
    ended = true;
    changed();
  } else {
    take(data);
  }
  return null;
}

export async function getJson(address) {
  const answer = await request(address);
  if (!answer.ok) throw new Error(await answer.text());
  return answer.json();
}

// A picture of the server as an address that <img> and links can have: they cannot send the secret themselves.
export async function getPicture(address) {
  const answer = await request(address);
  if (!answer.ok) throw new Error(await answer.text());
  return URL.createObjectURL(await answer.blob());
}

async function request(address, options = {}) {
  const answer = await fetch(address, { ...options, headers: { ...options.headers, ...sign() } });
  if (answer.status === 401) lock();
  return answer;
}
