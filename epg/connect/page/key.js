// SPDX-License-Identifier: Apache-2.0
// The secret with which the page proves its requests to EPG. The page gets it once, in exchange for the token in its
// address, and keeps it for this tab only. It is never in the address, which other users of the computer can see, and
// never in a cookie, which browsers send to every port of 127.0.0.1.

const NAME = "epg-secret";
let secret = stored();
let refusal = "This page was opened without the key that EPG's address contains."; // shown while there is no secret

export const whyLocked = () => (secret ? null : refusal);
export const sign = () => (secret ? { "X-EPG-Secret": secret } : {});

// For a worker, which has neither an address nor a storage of its own.
export const secretOf = () => secret;
export function adopt(text) {
  secret = text;
}

// Forgets the secret. EPG does not know it, because EPG was started again.
export function lock() {
  keep(null);
  refusal = "EPG was restarted.";
}

// Exchanges the token in the address for the secret, if there is one. After a reload there is no token, but a secret.
export async function unlock() {
  // The token works once. A page that the browser only loads in advance must not use it.
  if (document.prerendering) {
    await new Promise((go) => document.addEventListener("prerenderingchange", go, { once: true }));
  }
  const token = location.hash.slice(1);
  if (!token) return;
  history.replaceState(null, "", location.pathname);
  try {
    const answer = await fetch("exchange", {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify({ token }),
    });
    const data = await answer.json();
    if (answer.ok) keep(data.secret);
    else refusal = "This address was already used. Each address opens one page.";
  } catch {
    refusal = "EPG does not answer.";
  }
}

function stored() {
  try {
    return sessionStorage.getItem(NAME);
  } catch {
    return null; // storage is not allowed: the secret is lost when the page is loaded again
  }
}

function keep(text) {
  secret = text;
  try {
    if (text) sessionStorage.setItem(NAME, text);
    else sessionStorage.removeItem(NAME);
  } catch {
    // storage is not allowed, as above
  }
}
