# SPDX-License-Identifier: Apache-2.0
"""Changes values of a ``.tcf``.  All other text of the file, with its comments, stays as it was written.

>>> text = "# my robot\\nversion: 1\\nextends: host_jiwy.tcf   # for now\\nnode: me\\n"
>>> text = set_value(text, "robot.tcf", ["extends"], "rpi_pico_bare_metal_jiwy.tcf")
>>> print(set_value(text, "robot.tcf", ["components", "pwm_pan", "pins", "value"], "GP4"), end="")
# my robot
version: 1
extends: rpi_pico_bare_metal_jiwy.tcf   # for now
node: me
components:
  pwm_pan: {pins: {value: GP4}}
"""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any

import yaml

from epg.edit import yaml_edit
from epg.edit.scalars import scalar_text
from epg.edit.section import add_port
from epg.edit.yaml_edit import CannotEdit, parse_map
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.yaml_file import parse_yaml

JsonValue = object
"""A value as JSON has it: a map with texts as keys, a list, a text, a number, a boolean or None."""

COMPONENTS = "components"
_Change = Callable[[str, tuple[str, ...], JsonValue], str]
_ORDER = (
    *("api", "version", "model", "extends", "target", "node", "namespace", "clocks", "control", "communication"),
    COMPONENTS,
)
"""The usual order of the keys of a ``.tcf``, and of the first keys of other files."""
_LISTS = ((COMPONENTS,), ("parameters",))
"""The sections with a line for each entry, also if they are short; the second one is that of bindings."""
_WIDEST = 100
"""The largest number of characters of a line with a new map; a longer map gets a line for each key."""


def set_value(text: str, file: str, path: Sequence[str], value: JsonValue, order: Sequence[str] = ()) -> str:
    """``text`` with ``value`` at ``path``.  Missing maps on the way are made.

    A map is changed key by key, so the comments between its keys stay.  None removes a component or a parameter that
    an extended file has.  ``file`` is the name of the text in messages.  ``order`` are the names of the ports of a
    section of bindings: a new one gets its place among them.  Raises
    :class:`~epg.edit.yaml_edit.CannotEdit` if EPG cannot edit the form of the text; then an editor can.
    """
    body = text.removeprefix("\ufeff")
    wanted = copy.deepcopy(parse_map(body, file).plain())
    tree = wanted
    for key in path[:-1]:
        if not isinstance(tree.get(key), dict):
            tree[key] = {}
        tree = tree[key]
    tree[path[-1]] = value
    change = partial(_add_port, order) if order and yaml_edit.find(body, tuple(path)) is None else _set
    return _changed(text, body, change, file, tuple(path), value, wanted)


def remove_value(text: str, file: str, path: Sequence[str]) -> str:
    """``text`` without the key at ``path``, and without the maps that would be empty then.

    A key that does not exist is no mistake.  Raises :class:`~epg.edit.yaml_edit.CannotEdit` as :func:`set_value` does.
    """
    body = text.removeprefix("\ufeff")
    wanted = copy.deepcopy(parse_map(body, file).plain())
    if yaml_edit.find(body, tuple(path)) is None:
        return text
    last = len(path)
    while last > 1 and len(_at(wanted, path[: last - 1])) == 1:
        last -= 1
    if path[:last] == [COMPONENTS] and "extends" not in wanted:  # this key is required
        return set_value(text, file, path[:last], {})
    del _at(wanted, path[: last - 1])[path[last - 1]]
    return _changed(text, body, _remove, file, tuple(path[:last]), None, wanted)


def rename_key(text: str, file: str, path: Sequence[str], name: str) -> str:
    """``text`` in which the key at ``path`` is called ``name``; its value, comments and place stay.

    Raises :class:`~epg.edit.yaml_edit.CannotEdit` as :func:`set_value` does, and if there is no such key.
    """
    body = text.removeprefix("\ufeff")
    wanted = copy.deepcopy(parse_map(body, file).plain())
    if yaml_edit.find(body, tuple(path)) is None:
        raise CannotEdit(f"{file}: there is no '{'.'.join(path)}'")
    tree = _at(wanted, path[:-1])
    tree[name] = tree.pop(path[-1])
    return _changed(text, body, _rename, file, tuple(path), name, wanted)


def _rename(text: str, path: tuple[str, ...], value: JsonValue) -> str:
    above = yaml_edit.node_at(text, path[:-1])
    key = next(key for key, _ in above.value if key.value == path[-1])
    start, end = yaml_edit.start_of(key), yaml_edit.end_of(text, key)
    return text[:start] + scalar_text(value, key.style if key.style in ("'", '"') else "") + text[end:]


def _at(tree: dict[str, Any], path: Sequence[str]) -> dict[str, Any]:
    for key in path:
        tree = tree[key]
    return tree


def _changed(
    text: str, body: str, change: _Change, file: str, path: tuple[str, ...], value: JsonValue, wanted: JsonValue
) -> str:
    """Does ``change``, and verifies that the values of the changed text are the ``wanted`` ones."""
    key = ".".join(path)
    try:
        changed = change(body, path, value)
    except CannotEdit as problem:
        raise CannotEdit(f"{file}: '{key}' cannot be changed here: {problem}") from None
    after = parse_yaml(changed, file, Diagnostics())
    if after is None or _sorted(after.plain()) != _sorted(wanted):
        root = parse_map(body, file)
        line = root.key_span(path[0]).line if path[0] in root else 1
        raise CannotEdit(f"{file}:{line}: EPG cannot edit this form: change '{key}' in an editor")
    return text[: len(text) - len(body)] + changed


def _sorted(value: JsonValue) -> str:
    """``value`` as a text that tells 1, 1.0 and true apart, but not the order of keys."""
    return str(json.dumps(value, sort_keys=True, default=repr))


def _set(text: str, path: tuple[str, ...], value: JsonValue) -> str:
    node = yaml_edit.find(text, path) if path else yaml_edit.node_at(text, ())
    if node is None:
        return _insert(text, path, value)
    if isinstance(node, yaml.MappingNode) and isinstance(value, Mapping) and node.value and value:
        return _set_keys(text, path, [key.value for key, _ in node.value], value)
    if isinstance(node, yaml.ScalarNode) and not isinstance(value, (Mapping, list)):
        return _set_scalar(text, path, node, value)
    return _write(text, path, value)


def _set_keys(text: str, path: tuple[str, ...], present: Iterable[str], value: Mapping[str, JsonValue]) -> str:
    """``text`` with the keys and values of ``value`` in the map at ``path``, which has the keys ``present``."""
    for key in present:
        if key not in value:
            text = _remove(text, (*path, key))
    for key, child in value.items():
        text = _set(text, (*path, key), child)
    return text


def _set_scalar(text: str, path: tuple[str, ...], node: yaml.ScalarNode, value: JsonValue) -> str:
    """``text`` with another scalar at ``path``.  A scalar that says the same stays as it is written."""
    said = parse_yaml(yaml_edit.source_of(text, node), "", Diagnostics())
    if said is not None and _sorted(said.plain()) == _sorted(value):
        return text
    style = str(node.style) if isinstance(value, str) and node.style in ("'", '"') else ""
    return yaml_edit.replace(text, path, scalar_text(value, style))


def _add_port(order: Sequence[str], text: str, path: tuple[str, ...], value: JsonValue) -> str:
    section, port = path
    return add_port(text, section, order, port, _flow(value))


def _insert(text: str, path: tuple[str, ...], value: JsonValue) -> str:
    """``text`` with a new key.  The missing maps on its path are written with it."""
    depth = next(n for n in range(len(path) - 1, -1, -1) if yaml_edit.find(text, path[:n]) is not None or n == 0)
    for key in reversed(path[depth + 1 :]):
        value = {key: value}
    parent, key = path[:depth], path[depth]
    node = yaml_edit.find(text, parent) if parent else yaml_edit.node_at(text, ())
    if not isinstance(node, yaml.MappingNode) or not node.value:  # null, or an empty map
        return _write(text, parent, {key: value})
    keys = [each.value for each, _ in node.value]
    text = yaml_edit.insert(text, parent, _index(keys, key) if not parent else len(keys), f"{_key(key)}: null")
    return _write(text, (*parent, key), value)


def _index(keys: Sequence[str], key: str) -> int:
    """The place of a new ``key`` among the ``keys`` of the file: behind the last key that usually stands before it."""
    before = _ORDER[: _ORDER.index(key)] if key in _ORDER else keys
    return max((index + 1 for index, each in enumerate(keys) if each in before), default=0)


def _write(text: str, path: tuple[str, ...], value: JsonValue) -> str:
    """``text`` with ``value`` in place of the one at ``path``: on one line, or with a line for each key of a map.

    A section of a file in block style has a line for each key.
    """
    line = _flow(value)
    is_block = not any(yaml_edit.is_flow(yaml_edit.node_at(text, path[:n])) for n in range(len(path)))
    if not is_block or not isinstance(value, Mapping) or not value:
        return yaml_edit.replace(text, path, line)
    width = 2 * len(path) + len(path[-1]) + len(line)
    if path not in _LISTS and width <= _WIDEST:
        return yaml_edit.replace(text, path, line)
    return yaml_edit.replace_by_lines(text, path, [f"  {each}" for each in _block(value, len(path))])


def _block(value: Mapping[str, JsonValue], depth: int) -> list[str]:
    lines = []
    for key, child in value.items():
        line = f"{_key(key)}: {_flow(child)}"
        if isinstance(child, Mapping) and child and 2 * depth + len(line) > _WIDEST:
            lines += [f"{_key(key)}:", *(f"  {each}" for each in _block(child, depth + 1))]
        else:
            lines.append(line)
    return lines


def _flow(value: JsonValue) -> str:
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(key)}: {_flow(child)}" for key, child in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_flow(child) for child in value) + "]"
    return scalar_text(value)


def _key(key: str) -> str:
    return scalar_text(key)


def _remove(text: str, path: tuple[str, ...], value: JsonValue = None) -> str:
    parent = yaml_edit.node_at(text, path[:-1])
    if len(parent.value) == 1:
        return yaml_edit.replace(text, path[:-1], "{}")
    return yaml_edit.remove(text, path)
