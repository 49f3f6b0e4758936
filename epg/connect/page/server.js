// The other end: the newest State by long polling, and actions. Addresses are relative, because the page's own holds
// the token.

let state = null;
let lost = false;
let ended = false;
let changed = () => {};

export const current = () => state;
export const isLost = () => lost;
export const hasEnded = () => ended;

// Calls `whenChanged` with every new State, and when the connection is lost or found again; never returns.
export async function follow(whenChanged) {
  changed = whenChanged;
  while (!ended) {
    try {
      // A server that was found again may count its versions anew.
      const answer = await fetch(`api/state?after=${state === null || lost ? 0 : state.version}`);
      if (!answer.ok) throw new Error(String(answer.status));
      const found = lost;
      lost = false;
      take(await answer.json(), found);
    } catch {
      if (ended) return;
      if (!lost) {
        lost = true;
        changed();
      }
      await new Promise((resolve) => setTimeout(resolve, 1500));
    }
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
    answer = await fetch(`api/${action}`, {
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
  const answer = await fetch(address);
  if (!answer.ok) throw new Error(await answer.text());
  return answer.json();
}
