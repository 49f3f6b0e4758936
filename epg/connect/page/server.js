// SPDX-License-Identifier: Apache-2.0
// The connection to EPG: gets the newest state by long polling, and sends actions.

import { lock, sign, unlock, whyLocked } from "./key.js";

/** @type {State | null} */
let state = null;
let lost = false;
let locked = null;
let ended = false;
let changed = () => {};

// Before a target is chosen, the state has the keys of StartState only.
export const current = () => state;
export const isLost = () => lost;
export const hasEnded = () => ended;

// Calls `whenChanged` after every new state, and when the connection is lost or restored. Returns when EPG has ended.
export async function follow(whenChanged) {
  changed = whenChanged;
  await unlock();
  // If the user opens a new address of EPG in this tab, the browser does not load the page again: only the token
  // behind the # differs.
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
      reportError(error); // an error in drawing is a bug of the page; the connection is not lost
    }
    if (lost) await new Promise((resolve) => setTimeout(resolve, 1500));
  }
}

async function newest() {
  if (whyLocked()) return null;
  try {
    // After a lost connection, ask for the present state at once: the page may have missed one.
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

let before = Promise.resolve(); // the last action

// Does an action after all earlier ones, so that a change that was made just before "save" is saved. Returns null, or the
// error if it was refused: {message, hint}.
/**
 * @template {keyof Actions} Name
 * @param {Name} action
 * @param {Actions[Name]} [body]
 * @returns {Promise<Refusal | null>}
 */
export function act(action, body) {
  const done = before.then(() => send(action, body));
  before = done.catch(() => {}); // the caller reports the error
  return done;
}

async function send(action, body) {
  let answer, data;
  try {
    answer = await request(`api/${action}`, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(body ?? {}),
    });
    data = await answer.json();
  } catch {
    if (action !== "done") {
      lost = true;
      changed();
      return { message: "EPG does not answer", hint: "" };
    }
  }
  if (data?.error) return data.error;
  if (action === "done") {
    ended = true;
    changed();
  } else {
    take(data);
  }
  return null;
}

// A browser opens six connections to a server, and streams of this and other tabs can occupy all of them. It keeps requests
// with credentials apart from those without, so these actions have connections of their own. EPG does not use the credentials.
const URGENT = new Set(["stop", "respond", "move", "enable"]);
const PATIENCE = 5000; // ms after which such a request gives its connection up

// Does an action on a running target at once: it does not wait for other actions. Returns the answer, or the error if it
// was refused: {error: {message, hint}}.
export async function ask(action, body = {}) {
  try {
    const answer = await request(`api/live/${action}`, {
      method: "POST",
      credentials: URGENT.has(action) ? "same-origin" : "omit",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(body),
      signal: URGENT.has(action) ? AbortSignal.timeout(PATIENCE) : null,
    });
    return answer.status === 204 ? {} : await answer.json();
  } catch {
    return { error: { message: "EPG does not answer", hint: "look at the robot" } };
  }
}

// A function that does an action as `ask` does, but not while `most` earlier ones have no answer: then it returns null.
// Actions that are repeated then leave connections free for others, and do not queue up for a server that stands still: it
// would do them late.
export function askRepeatedly(action, most) {
  let waiting = 0;
  return async (body = {}) => {
    if (waiting === most) return null;
    waiting++;
    try {
      return await ask(action, body);
    } finally {
      waiting--;
    }
  };
}

// The objects of an answer that arrive one by one, as lines of JSON.
export async function* jsonLines(address) {
  const answer = await get(address);
  const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = "";
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return;
    const lines = (rest + value).split("\n");
    rest = lines.pop();
    for (const line of lines) if (line) yield JSON.parse(line);
  }
}

export async function getJson(address) {
  return (await get(address)).json();
}

export async function getText(address) {
  return (await get(address)).text();
}

// Fetches JSON, or the reason why it was refused: {message, hint}.
export async function getAnswer(address) {
  try {
    const data = await (await request(address)).json();
    return data.error ?? data;
  } catch {
    return { message: "EPG does not answer", hint: "" };
  }
}

// Fetches a picture, and returns a local address of it for <img> and links: these cannot send the secret.
export async function getPicture(address) {
  const answer = await get(address);
  return URL.createObjectURL(await answer.blob());
}

async function get(address) {
  const answer = await request(address);
  if (!answer.ok) throw new Error(await answer.text());
  return answer;
}

async function request(address, options = {}) {
  // The browser's cache must not be asked: there, equal addresses of several tabs wait for each other.
  const headers = { ...options.headers, ...sign() };
  const answer = await fetch(address, { cache: "no-store", credentials: "omit", ...options, headers });
  if (answer.status === 401) lock();
  return answer;
}
