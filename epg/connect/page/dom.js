// SPDX-License-Identifier: Apache-2.0
// Elements as a function of data. h() describes an element. render() changes only the differences between the page and
// the descriptions, so the focus, scroll positions, open lists and half-typed text stay.
//
//   render(document.getElementById("main"), [h("p.note", "4 ports")])

const SVG = "http://www.w3.org/2000/svg";
const SVG_TAGS = new Set(["svg", "path", "circle", "g", "rect"]);

// Describes an element, as h("p.note", { title: "all ports" }, "4 ports"): its tag and classes, its attributes if it has
// any, and its children. Special attributes:
//   key      identifies the element among its siblings
//   on...    an event handler; its result is not used: the result `false` would cancel the event
//   disabled a button that has the focus keeps it, and is only announced as disabled, until the focus leaves it
//   onchoose of a list: called with its value when the user has chosen (see `listenForChoice`)
//   keep     render() does not touch the children; another function draws them
//   shown    called with the element after each drawing
//   initial  the first value of an input; later the user's text stays
// Children that are null, undefined, false, 0 or an empty text are left out.
export function h(selector, ...rest) {
  const [tag, ...classes] = selector.split(".");
  const attributes = isAttributes(rest[0]) ? rest.shift() : {};
  if (classes.length) attributes.class = classes.join(" ");
  return { tag, attributes, children: rest.flat(Infinity).filter(Boolean) };
}

const isAttributes = (value) => value?.constructor === Object && !("tag" in value);

export function render(parent, descriptions) {
  const focused = document.activeElement;
  const places = placesAround(focused);
  const after = [];
  renderChildren(parent, [descriptions].flat(Infinity).filter(Boolean), after);
  for (const call of after) call();
  // Moving an element takes the focus from it. If it is gone or disabled, the closest element around it gets the focus:
  // else the next Tab begins at the page's start.
  const now = document.activeElement;
  if (now === focused ? canFocus(focused) : now !== document.body) return;
  places.find(canFocus)?.focus({ preventScroll: true });
}

const canFocus = (element) =>
  element.isConnected && !element.matches(":disabled") && !element.closest("[hidden], [inert]");

// An element, and the elements around it that can have the focus.
function placesAround(element) {
  const places = [];
  for (let each = element; each && each !== document.body; each = each.parentElement) {
    if (each === element || each.hasAttribute("tabindex") || each.localName === "dialog") places.push(each);
  }
  return places;
}

function renderChildren(parent, descriptions, after) {
  const keyed = new Map();
  const others = [];
  for (const node of parent.childNodes) {
    if (node.epgKey !== undefined) keyed.set(node.epgKey, node);
    else others.push(node);
  }
  let place = parent.firstChild;
  for (const wanted of descriptions) {
    let node = take(wanted, keyed, others);
    if (node === null) {
      node = make(wanted);
      parent.insertBefore(node, place);
    } else if (node === place) {
      place = place.nextSibling;
    } else {
      parent.insertBefore(node, place);
    }
    update(node, wanted, after);
  }
  for (const node of [...keyed.values(), ...others]) if (node !== null) node.remove();
}

function take(wanted, keyed, others) {
  const tag = typeof wanted === "object" ? wanted.tag : null;
  const key = tag ? wanted.attributes.key : undefined;
  if (key !== undefined) {
    const node = keyed.get(key);
    if (!node || node.localName !== tag) return null;
    keyed.delete(key);
    return node;
  }
  const n = others.findIndex((node) => node !== null && (tag ? node.localName === tag : node.nodeType === 3));
  if (n < 0) return null;
  const [node] = others.splice(n, 1);
  return node;
}

function make(wanted) {
  if (typeof wanted !== "object") return document.createTextNode(String(wanted));
  const { tag, attributes } = wanted;
  const node = SVG_TAGS.has(tag) ? document.createElementNS(SVG, tag) : document.createElement(tag);
  node.epgKey = attributes.key;
  node.epgAttributes = {};
  if (tag === "select") listenForChoice(node);
  return node;
}

function update(node, wanted, after) {
  if (typeof wanted !== "object") {
    if (node.data !== String(wanted)) node.data = String(wanted);
    return;
  }
  const { attributes, children } = wanted;
  const old = node.epgAttributes;
  for (const name of Object.keys(old)) if (!(name in attributes)) set(node, name, null, old[name]);
  for (const [name, value] of Object.entries(attributes)) set(node, name, value, old[name]);
  node.epgAttributes = attributes;
  if (!attributes.keep) renderChildren(node, children, after);
  // A select accepts a value only after its options exist. Its `value` always follows the files.
  if (node.localName === "select" && !node.epgChoosing && node.value !== attributes.value)
    node.value = attributes.value;
  if ("checked" in attributes) node.checked = Boolean(attributes.checked);
  if (attributes.shown) after.push(() => attributes.shown(node));
}

function set(node, name, value, old) {
  if (["key", "keep", "shown", "checked", "onchoose"].includes(name) || value === old) return;
  if (name === "value" && node.localName === "select") return;
  if (name.startsWith("on")) node[name] = value && ((event) => void value(event));
  else if (name === "disabled" && node.localName === "button") disable(node, Boolean(value));
  else if (name === "initial") node.value = value ?? "";
  else if (value === null || value === undefined || value === false) node.removeAttribute(name);
  else node.setAttribute(name, value === true ? "" : String(value));
}

// Browsers take the focus from a button that becomes disabled, and Firefox then goes on at the page's start.
function disable(button, isDisabled) {
  const keeps = isDisabled && button === document.activeElement;
  button.toggleAttribute("disabled", isDisabled && !keeps);
  button.ariaDisabled = keeps ? "true" : null;
  const again = () => disable(button, Boolean(button.epgAttributes.disabled));
  if (keeps) button.addEventListener("blur", again, { once: true });
}

// True if a button is disabled, also if it still has the focus.
export const isBlocked = (button) => button.disabled || button.ariaDisabled === "true";

window.addEventListener(
  "click",
  (event) => {
    if (!(event.target instanceof Element) || !event.target.closest("button[aria-disabled=true]")) return;
    event.preventDefault();
    event.stopImmediatePropagation();
  },
  { capture: true },
);

const PAUSE = 1000; // ms without a key after which a choice by keys is complete

// A list changes with each letter that is typed to find an entry, and with each arrow key. The user has chosen after a
// pause, with Enter, with a key such as Ctrl+S, when the focus leaves the list, or with the pointer. Escape takes the choice
// back.
function listenForChoice(list) {
  let byKey = false;
  const end = () => {
    window.clearTimeout(list.epgChoosing);
    list.epgChoosing = 0;
  };
  const choose = () => {
    if (!list.epgChoosing) return;
    end();
    if (list.isConnected) list.epgAttributes.onchoose(list.value);
  };
  list.addEventListener("change", () => {
    if (!list.epgAttributes.onchoose) return;
    end();
    list.epgChoosing = window.setTimeout(choose, PAUSE);
    if (!byKey) choose();
  });
  list.addEventListener("blur", choose);
  list.addEventListener("pointerdown", () => {
    byKey = false;
  });
  list.addEventListener("keydown", (event) => {
    byKey = true;
    if (event.key === "Enter" || event.ctrlKey || event.metaKey) choose();
    if (event.key !== "Escape" || !list.epgChoosing) return;
    end();
    list.value = list.epgAttributes.value;
  });
}

// A text field with its label. A hint is below it.
export function textField(id, label, attributes, hint = null) {
  return h(
    "div.field",
    h("label", { for: id }, label),
    h("input", { id, type: "text", spellcheck: "false", "aria-describedby": hint && `${id}-hint`, ...attributes }),
    hint && h("span.hint", { id: `${id}-hint` }, hint),
  );
}

export const option = (value, text = value) => h("option", { key: `:${value}`, value }, text);

// A list with its label.
export function listField(id, label, attributes, options) {
  return h("div.field", { key: id }, h("label", { for: id }, label), h("select", { id, ...attributes }, options));
}

// The reason why an action was refused.
/** @param {Refusal | null} error */
export function refusalPart(error, attributes = {}) {
  const hint = error?.hint && h("span.hint", error.hint);
  return error && h("p.refusal", { role: "alert", ...attributes }, error.message, hint);
}

// A table. Each row is a list of cells, of which each that is not a <th> or <td> comes into a <td>.
export function table(attributes, caption, head, rows) {
  const heads = head.map((text) => h("th", { scope: "col" }, text));
  const row = (cells) =>
    h(
      "tr",
      cells.map((cell) => (["th", "td"].includes(cell?.tag) ? cell : h("td", cell))),
    );
  return h("table", attributes, caption, heads.length > 0 && h("thead", h("tr", heads)), h("tbody", rows.map(row)));
}

export const rowHead = (text) => h("th", { scope: "row" }, text);

export const plural = (number, noun) => `${number} ${noun}${number === 1 ? "" : "s"}`;

// Joins the parts to an id that is legal for any name of a port.
export function id(...parts) {
  return parts.join("-").replace(/[^\w-]/g, (letter) => `_${letter.codePointAt(0)}_`);
}
