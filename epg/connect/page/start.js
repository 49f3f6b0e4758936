// SPDX-License-Identifier: Apache-2.0
// The start page for a model without a project. It has three steps: 1 Model, 2 Target, 3 Project.

import { configurationCards } from "./configurations.js";
import { h, textField } from "./dom.js";
import { wiringPicture } from "./pictures.js";
import { current } from "./server.js";
import { attempt, draw, ui } from "./ui.js";
import { unitMark } from "./wiring.js";

let busy = false;

/** @param {StartState} state */
export function startPage(state) {
  return h(
    "div.start",
    { key: "start" },
    h("h1.unseen", "New project"),
    modelStep(state.model),
    h(
      "section.step.step-target",
      { key: "target", "aria-labelledby": "step-target" },
      heading("step-target", 2, "Target", "The robot that the model controls, and the board on which it runs."),
      configurationCards(state),
    ),
    projectStep(state),
  );
}

function heading(id, number, title, text) {
  return h(
    "div.step-head",
    h("h2", { id }, h("span.step-number", String(number)), " ", title),
    text && h("p.muted", text),
  );
}

/** @param {Model} model */
function modelStep(model) {
  if (!model)
    return h("section.step.step-model", { key: "model" }, heading("step-model", 1, "Model", "No model was found."));
  const list = (title, ports) =>
    h(
      "div",
      { key: title },
      h("h3", title, h("span.count", ` ${ports.length}`)),
      h(
        "ul.port-names",
        { tabindex: ports.length > 6 ? "0" : null, "aria-label": title },
        ports.map((port) => h("li", { key: port.name }, h("span", port.name), unitMark(port))),
      ),
    );
  return h(
    "section.step.step-model",
    { key: "model", "aria-labelledby": "step-model" },
    heading("step-model", 1, "Model"),
    h("p.big", model.name),
    h("p.muted", [model.origin, model.step ? `step ${model.step} s` : ""].filter(Boolean).join(", ")),
    h("div.port-lists", list("Inputs", model.inputs), list("Outputs", model.outputs)),
  );
}

let named = null; // the name for which the folder was last proposed; null before the first change of the name

// Lets the folder have the name of the project, as long as the user has not changed the folder.
function nameFolder(event) {
  const { folder, name } = event.target.form.elements;
  const { create } = current();
  const proposed = (text) => create.folder.replace(/[^/\\]*$/, text);
  if (folder.value === (named === null ? create.folder : proposed(named))) {
    named = name.value.trim();
    folder.value = proposed(named);
  }
}

/** @param {StartState} state */
function projectStep(state) {
  const picked = state.configurations.find((each) => each.name === ui.chosen);
  const create = async (event) => {
    event.preventDefault();
    const { folder, name } = event.target.elements;
    busy = true;
    draw();
    const done = await attempt("create", {
      configuration: ui.chosen,
      folder: folder.value.trim(),
      name: name.value.trim(),
    });
    busy = false;
    draw();
    if (done) document.getElementById("main").focus();
  };
  return h(
    "section.step.step-project",
    { key: "project", "aria-labelledby": "step-project" },
    heading(
      "step-project",
      3,
      "Project",
      "A folder with all files that the firmware is built from. EPG copies the model into it.",
    ),
    h(
      "form",
      { onsubmit: create, autocomplete: "off" },
      textField("create-name", "Name", {
        name: "name",
        required: true,
        initial: state.create.name,
        oninput: nameFolder,
      }),
      textField("create-folder", "Folder", { name: "folder", required: true, initial: state.create.folder }),
      h("p.picked", picked ? ["Target ", h("b", picked.name)] : h("span.muted", "No target is chosen yet.")),
      picked?.missing.length &&
        h(
          "p.muted",
          `You can connect ports now. To generate, install ${picked.missing.join(", ")}: 'epg doctor' shows how.`,
        ),
      h(
        "button",
        { type: "submit", class: "primary wide", disabled: !picked || busy },
        busy ? "Creating…" : "Create project",
      ),
      picked?.picture &&
        wiringPicture(picked.name, {
          key: "picture",
          class: "picked-picture",
          alt: `Board of ${picked.name} with its wiring`,
        }),
    ),
  );
}
