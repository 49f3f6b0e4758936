// SPDX-License-Identifier: Apache-2.0
// The question for the key of a console by UDP. EPG keeps the key for the next time, so it is asked once for each target.

import { h } from "./dom.js";

// The field, if the target behind the port `locked` needs a key. `connect` is called with the port and the key.
export const keyPart = (locked, connect) =>
  locked &&
  h(
    "form",
    {
      key: "key",
      onsubmit: (event) => {
        event.preventDefault();
        connect({ path: locked, key: event.target.querySelector("input").value });
      },
    },
    h("label", { for: "live-key" }, `Key of ${locked} `),
    h("input", { id: "live-key", type: "password", autocomplete: "off", required: true }),
    " ",
    h("button", { class: "primary" }, "Connect with this key"),
    h("p.hint", "The program prints the key when it starts, or has it from the file of --console-key."),
  );
