// SPDX-License-Identifier: Apache-2.0
// Buttons that act while they are pressed, with the pointer or with Enter. One button can be pressed at a time. The timer
// belongs to the page, not to a drawing of the button, so a release is heard after the page was drawn again.

let timer = 0;

for (const name of ["pointerup", "pointercancel", "keyup"]) {
  window.addEventListener(name, release, { capture: true });
}
window.addEventListener("blur", release); // not of elements: a press takes the focus from another one
document.addEventListener("visibilitychange", release);

function release() {
  window.clearInterval(timer); // of a timeout, too
  timer = 0;
}

function pressed(start) {
  const begin = (event) => {
    if (!timer) timer = start(event.currentTarget);
  };
  return {
    onpointerdown: begin,
    onpointerleave: release,
    onblur: release,
    onkeydown: (event) => event.key === "Enter" && begin(event),
  };
}

// Calls `act` if the button exists and can be pressed, else ends the press.
const actOn = (button, act) => (button.isConnected && !button.disabled ? act() : release());

// Handlers of a button that acts once, after it was pressed for `ms` milliseconds.
export const held = (act, ms) => pressed((button) => window.setTimeout(() => actOn(button, act), ms));

// Handlers of a button that acts at once, and again every `ms` milliseconds while it is pressed.
export const repeated = (act, ms) =>
  pressed((button) => {
    act();
    return window.setInterval(() => actOn(button, act), ms);
  });
