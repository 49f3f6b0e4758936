// SPDX-License-Identifier: Apache-2.0
// The secret by which EPG knows its page. The page gets it once, for the token in its address, and keeps it for this tab
// alone: never in the address, which other users of the computer can see, nor in a cookie, which browsers send to every
// port of 127.0.0.1.

const NAME = "epg-secret";
let secret = stored();
let refusal = "This page was opened without the key that an address of EPG has."; // said without a secret

export const whyLocked = () => (secret ? null : refusal);
export const sign = () => (secret ? { "X-EPG-Secret": secret } : {});

// EPG does not know the secret: it was started anew.
export function lock() {
  keep(null);
  refusal = "EPG was started again.";
}

// Exchanges the token in the address, if there is one. A reload has none: the secret is there already.
export async function unlock() {
  // A page that the browser loads in advance must not use up the token.
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
    else refusal = "This address was used before, and each opens one page.";
  } catch {
    refusal = "EPG does not answer.";
  }
}

function stored() {
  try {
    return sessionStorage.getItem(NAME);
  } catch {
    return null; // not allowed: the secret lives until the page is loaded again
  }
}

function keep(text) {
  secret = text;
  try {
    if (text) sessionStorage.setItem(NAME, text);
    else sessionStorage.removeItem(NAME);
  } catch {
    // not allowed, as above
  }
}
