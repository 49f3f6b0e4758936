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
//   on...    an event handler
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
  const after = [];
  renderChildren(parent, [descriptions].flat(Infinity).filter(Boolean), after);
  for (const call of after) call();
  // Moving an element takes the focus from it.
  if (focused && focused !== document.activeElement && focused.isConnected && parent.contains(focused)) focused.focus();
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
  if (node.localName === "select" && node.value !== attributes.value) node.value = attributes.value;
  if ("checked" in attributes) node.checked = Boolean(attributes.checked);
  if (attributes.shown) after.push(() => attributes.shown(node));
}

function set(node, name, value, old) {
  if (["key", "keep", "shown", "checked"].includes(name) || value === old) return;
  if (name === "value" && node.localName === "select") return;
  if (name.startsWith("on")) node[name] = value;
  else if (name === "initial") node.value = value ?? "";
  else if (value === null || value === undefined || value === false) node.removeAttribute(name);
  else node.setAttribute(name, value === true ? "" : String(value));
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

export const plural = (number, noun) => `${number} ${noun}${number === 1 ? "" : "s"}`;

// Joins the parts to an id that is legal for any name of a port.
export function id(...parts) {
  return parts.join("-").replace(/[^\w-]/g, (letter) => `_${letter.codePointAt(0)}_`);
}
