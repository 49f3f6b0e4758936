// SPDX-License-Identifier: Apache-2.0
// Cards of the configurations that can be chosen, grouped by robot and board, with search and filter.

import { h, id, listField, option, plural, textField } from "./dom.js";
import { icon } from "./icons.js";
import { wiringPicture } from "./pictures.js";
import { change, ui } from "./ui.js";

const NO_ROBOT = "Board only";

// The list of cards. Each is a radio button; ui.chosen is the chosen one. `only` is a function that returns true for the
// configurations to list.
/**
 * @param {StartState} state
 * @param {(configuration: Configuration) => boolean} only
 */
export function configurationCards(state, only = () => true) {
  const configurations = state.configurations.filter(only);
  const robots = [...new Set(configurations.map((each) => each.robot || NO_ROBOT))];
  const shown = configurations.filter(isShown);
  const isMove = state.phase === "connect";
  return h(
    "div.chooser",
    filters(robots),
    h(
      "p.muted",
      { role: "status" },
      shown.length === configurations.length
        ? plural(shown.length, "target")
        : `${shown.length} of ${configurations.length} targets`,
    ),
    state.configurations.length === 0
      ? h("p.empty", "Searching for targets, and for tools on this computer…")
      : shown.length === 0
        ? h("p.empty", "No target matches. Clear the search to see all.")
        : null,
    h(
      "div.robots",
      { role: "radiogroup", "aria-label": "Targets" },
      grouped(shown).map((group) => robotGroup(group, isMove)),
    ),
  );
}

/** @param {Configuration} configuration */
function isShown(configuration) {
  const { text, robot, fits } = ui.filter;
  if (robot && (configuration.robot || NO_ROBOT) !== robot) return false;
  if (fits && !isReady(configuration)) return false;
  const { name, board, platform, summary } = configuration;
  const words = [name, configuration.robot, board, platform, summary].join(" ").toLowerCase();
  return text
    .toLowerCase()
    .split(/\s+/)
    .every((word) => words.includes(word));
}

/** @param {Configuration} configuration */
const isReady = (configuration) => configuration.possible && configuration.missing.length === 0;
const readyFirst = (a, b) => Number(isReady(b)) - Number(isReady(a));

// Returns [{robot, boards: [{board, list}]}]. The robot with the most matching ports is first; boards without a robot
// are last. Of each robot, the boards for which this computer can build now are first.
function grouped(configurations) {
  const best = (all) => Math.max(...all.map((each) => each.matches));
  return [...Map.groupBy(configurations, (each) => each.robot || NO_ROBOT)]
    .sort(([a, ofA], [b, ofB]) => Number(a === NO_ROBOT) - Number(b === NO_ROBOT) || best(ofB) - best(ofA))
    .map(([robot, all]) => ({
      robot,
      boards: [...Map.groupBy(all, (each) => each.board)]
        .map(([board, list]) => ({ board, list: list.sort(readyFirst) }))
        .sort((a, b) => readyFirst(a.list[0], b.list[0])),
    }));
}

function filters(robots) {
  return h(
    "div.filters",
    textField("target-search", "Search", {
      type: "search",
      placeholder: "board, robot, RTOS",
      initial: ui.filter.text,
      oninput: (event) => filter({ text: event.target.value }),
    }),
    listField(
      "target-robot",
      "Robot",
      { value: ui.filter.robot, onchange: (event) => filter({ robot: event.target.value }) },
      [option("", "all"), robots.map((robot) => option(robot))],
    ),
    h(
      "label.check",
      h("input", {
        type: "checkbox",
        checked: ui.filter.fits,
        onchange: (event) => filter({ fits: event.target.checked }),
      }),
      "Only targets that this computer can build now",
    ),
  );
}

const filter = (part) => change({ filter: { ...ui.filter, ...part } });

function robotGroup({ robot, boards }, isMove) {
  const name = id("robot", robot);
  const own = isMove ? "with the components of this project" : "every port becomes a topic; you add components next";
  const summary = robot === NO_ROBOT ? own : "";
  return h(
    "section.robot",
    { key: robot, "aria-labelledby": name },
    h("h3", { id: name }, robot, summary ? h("span.muted", ` ${summary}`) : null),
    boards.map(({ board, list }) =>
      h(
        "div.board",
        { key: board, role: "group", "aria-label": `${robot}, ${board}` },
        h("h4", board),
        h(
          "div.cards",
          list.map((each) => card(each, isMove)),
        ),
      ),
    ),
  );
}

/**
 * @param {Configuration} configuration
 * @param {boolean} isMove
 */
function card(configuration, isMove) {
  const { name, platform, picture, components, matches, ports, missing, possible, reason, chosen } = configuration;
  const [title, ...more] = platform.split(/[:,] /);
  const field = id("target", name);
  return h(
    "label",
    { class: `card${possible ? "" : " impossible"}`, key: name, for: field },
    h("input", {
      type: "radio",
      id: field,
      name: "configuration",
      value: name,
      checked: ui.chosen === name,
      disabled: !possible,
      onchange: () => change({ chosen: name }),
    }),
    picture && wiringPicture(name, { alt: "", width: "84", height: "84" }),
    h(
      "span.card-text",
      h("span.card-title", title[0].toUpperCase() + title.slice(1), chosen ? h("span.tag", "in use") : null),
      more.length && h("span.card-line", more.join(", ")),
      h("span.card-line.name", breakable(name)),
      (components > 0 || !isMove) && h("span.card-line", offer(components, matches, ports)),
      missing.length && h("span.card-line.warning", icon("warning"), `Missing on this computer: ${missing.join(", ")}`),
      reason && h("span.card-line.warning", icon("warning"), reason),
    ),
  );
}

// Lets a long name wrap after an underscore.
function breakable(name) {
  const parts = name.split("_");
  return parts.map((part, n) => (n < parts.length - 1 ? [`${part}_`, h("wbr")] : part));
}

function offer(components, matches, ports) {
  const parts = [components === 0 ? "no components yet" : plural(components, "component")];
  if (components > 0 && ports > 0) parts.push(`${matches} of ${ports} ports match by name`);
  return parts.join(", ");
}
