// SPDX-License-Identifier: Apache-2.0
// Buttons that act while they are pressed, with the pointer or with Enter. One button can be pressed at a time. The timer
// belongs to the page, not to a drawing of the button, so a release is heard after the page was drawn again. A key that was
// pressed on another element, and repeats here, does not press the button.

import { isBlocked } from "./dom.js";

let timer = 0;

for (const name of ["pointerup", "pointercancel", "keyup"]) {
  window.addEventListener(name, release, { capture: true });
}
window.addEventListener("blur", release); // not of elements: a press takes the focus from another one
document.addEventListener("visibilitychange", release);

// True while such a button is pressed.
export const isPressed = () => timer !== 0;

function release() {
  window.clearInterval(timer); // of a timeout, too
  timer = 0;
}

function pressed(start) {
  const begin = (event) => {
    if (!timer && !isBlocked(event.currentTarget)) timer = start(event.currentTarget);
  };
  return {
    onpointerdown: begin,
    onpointerleave: release,
    onblur: release,
    onkeydown: (event) => {
      if (event.key === "Enter" && !event.repeat) begin(event);
    },
  };
}

// Calls `act` if the button exists and can be pressed, else ends the press.
const actOn = (button, act) => (button.isConnected && !isBlocked(button) ? act() : release());

// Handlers of a button that acts once, after it was pressed for `ms` milliseconds. `act` gets the value of `begin`, which
// is called when the press begins.
export const held = (begin, act, ms) =>
  pressed((button) => {
    const begun = begin();
    return window.setTimeout(() => actOn(button, () => act(begun)), ms);
  });

// Handlers of a button that acts at once, and again every `ms` milliseconds while it is pressed. `act` gets a function that
// tells later if this press goes on.
export const repeated = (act, ms) =>
  pressed((button) => {
    const isHeld = () => timer === press;
    const press = window.setInterval(() => actOn(button, () => act(isHeld)), ms);
    act(isHeld);
    return press;
  });
