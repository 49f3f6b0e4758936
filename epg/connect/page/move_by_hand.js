// SPDX-License-Identifier: Apache-2.0
// "Move by hand": an actuator of a disabled target moves while its button is held.

import { h } from "./dom.js";
import { isOld, live, page } from "./live_events.js";
import { repeated } from "./press.js";
import { isEnabled } from "./robot.js";
import { askRepeatedly } from "./server.js";

const AGAIN = 200; // ms after which a held button asks for numbers again, if a request or the numbers were lost
const CLICK = 250; // ms after which a button that is not held any more moves nothing

const request = askRepeatedly("move", 3);

// The newest press of a button.
let press =
  /** @type {{actuator: string, duty: number, begun: number, isHeld: () => boolean, moved: boolean} | null} */ (null);

// Asks the target for numbers.
function begin(actuator, duty, isHeld) {
  if (press?.isHeld !== isHeld) press = { actuator, duty, begun: performance.now(), isHeld, moved: false };
  request({ page, actuator, duty });
}

// Moves the actuator whose button is held, with the number in the newest event. A short click moves once. Must be called
// after each event. The target drives the actuator for at most 300 ms after it has sent the number. So a request that is
// still on its way when this page ends does not drive for longer.
export function moveOn() {
  const number = live.moving;
  live.moving = null; // an event is followed by calls for other reasons
  if (!number || !press) return;
  const { actuator, duty, begun, isHeld, moved } = press;
  if (!isHeld() && (moved || performance.now() - begun > CLICK)) return;
  press.moved = true;
  request({ page, actuator, duty, number });
}

export const actuatorsPart = (target) =>
  target.actuators.length > 0 &&
  h(
    "section",
    { key: "actuators" },
    h("h3", "Move by hand"),
    h("p.hint", isEnabled(target) ? "Stop the target first." : "Hold a button: the actuator moves with a duty of 0.1."),
    target.actuators.map((name) =>
      h(
        "p",
        { key: name },
        `${name} `,
        [-0.1, 0.1].map((duty) =>
          h(
            "button",
            {
              key: String(duty),
              "aria-label": `Move ${name} ${duty < 0 ? "backwards" : "forwards"}`,
              disabled: isEnabled(target) || !target.matches || !live.inTime || isOld(),
              ...repeated((isHeld) => begin(name, duty, isHeld), AGAIN),
            },
            duty < 0 ? "−" : "+",
          ),
        ),
      ),
    ),
  );
