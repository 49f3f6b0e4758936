# SPDX-License-Identifier: Apache-2.0
"""Changes a ``.tcf``: the name of the file that it extends, and parts of that file which it leaves out.

All other text of the file stays as it was written.

>>> text = "# my robot\\nversion: 1\\nextends: host_jiwy.tcf   # for now\\nnode: me\\n"
>>> print(set_extends(text, "robot.tcf", "rpi_pico_bare_metal_jiwy.tcf"), end="")
# my robot
version: 1
extends: rpi_pico_bare_metal_jiwy.tcf   # for now
node: me
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import yaml

from epg.diagnostics import Diagnostics
from epg.documents.yaml_file import parse_yaml
from epg.edit import yaml_edit
from epg.edit.scalars import scalar_text
from epg.edit.yaml_edit import CannotEdit, parse_map
from epg.source import YamlNode

KEY = "extends"
COMPONENTS = "components"


def set_extends(text: str, file: str, value: str) -> str:
    """``text`` with ``extends: value``: in place of the old name, or behind ``version`` if there was none.

    ``file`` is the name of the text in messages.  Raises :class:`~epg.edit.yaml_edit.CannotEdit` if the text is not a
    map, or if its ``extends`` is a map or a list.
    """
    body = text.removeprefix("\ufeff")
    root = parse_map(body, file)
    old = root.get(KEY)
    if old is not None and (old.is_mapping or old.is_sequence):
        line = root.key_span(KEY).line
        raise CannotEdit(f"{file}:{line}: '{KEY}' must be one name: correct this in an editor first")
    if old is not None and old.value == value:
        return text
    try:
        changed = _edited(body, value, old is not None)
    except CannotEdit as problem:
        raise CannotEdit(f"{file}: '{KEY}' cannot be changed here: {problem}") from None
    _verify(root, changed, file, value)
    return text[: len(text) - len(body)] + changed


def leave_out(text: str, file: str, parts: Sequence[Sequence[str]]) -> str:
    """``text`` in which each of ``parts`` is null: a component, or a parameter of one.

    A part is a list of keys below ``components``, such as ``["guard_tilt", "homing"]``.  Null removes it although the
    extended file has it.  Raises :class:`~epg.edit.yaml_edit.CannotEdit` if EPG cannot edit the form of the text.
    """
    body = text.removeprefix("\ufeff")
    wanted = parse_map(body, file).plain()
    changed = body
    for part in parts:
        keys = (COMPONENTS, *part)
        try:
            changed = _with_null(changed, keys)
        except CannotEdit as problem:
            raise CannotEdit(f"{file}: '{'.'.join(keys)}' cannot be left out here: {problem}") from None
        _set_null(wanted, keys)
    after = parse_yaml(changed, file, Diagnostics())
    if after is None or after.plain() != wanted:
        raise CannotEdit(f"{file}: EPG cannot edit this form: write 'null' for these components in an editor")
    return text[: len(text) - len(body)] + changed


def _with_null(text: str, path: tuple[str, ...]) -> str:
    if yaml_edit.find(text, path) is not None:
        return yaml_edit.replace(text, path, "null")
    depth = next(n for n in range(len(path) - 1, -1, -1) if _is_map(text, path[:n]))
    parent, key, below = path[:depth], path[depth], path[depth + 1 :]
    node = yaml_edit.node_at(text, parent)
    value = "null"
    for name in reversed(below):
        value = f"{{{name}: {value}}}"
    if depth == 0 and below and not yaml_edit.is_flow(node):  # the first component has its own line
        value = f"\n  {value[1:-1]}"
    return yaml_edit.insert(text, parent, len(node.value), f"{key}: {value}".replace(": \n", ":\n"))


def _is_map(text: str, path: tuple[str, ...]) -> bool:
    node = yaml_edit.find(text, path) if path else yaml_edit.node_at(text, ())
    return isinstance(node, yaml.MappingNode)


def _set_null(tree: dict[str, Any], path: tuple[str, ...]) -> None:
    for key in path[:-1]:
        if not isinstance(tree.get(key), dict):
            tree[key] = {}
        tree = tree[key]
    tree[path[-1]] = None


def _edited(text: str, value: str, is_there: bool) -> str:
    if is_there:
        node = yaml_edit.node_at(text, (KEY,))
        style = node.style or "" if isinstance(node, yaml.ScalarNode) else ""
        return yaml_edit.replace(text, (KEY,), _name(value, style))
    root = yaml_edit.node_at(text, ())
    keys = [key.value for key, _ in root.value]
    return yaml_edit.insert(text, (), keys.index("version") + 1 if "version" in keys else 0, f"{KEY}: {_name(value)}")


def _name(value: str, style: str = "") -> str:
    """A file name as YAML text.  It needs quotes only if a part of it does: ``../robots/a-b.tcf`` needs none."""
    parts = value.replace("-", "_").split("/")
    plain = not style and all(part in (".", "..") or scalar_text(part) == part for part in parts)
    return value if plain and not value.startswith("-") else scalar_text(value, style)


def _verify(root: YamlNode, changed: str, file: str, value: str) -> None:
    after = parse_yaml(changed, file, Diagnostics())
    others = [(key, node.plain()) for key, node in root.items() if key != KEY]
    if (
        after is None
        or repr([(key, node.plain()) for key, node in after.items() if key != KEY]) != repr(others)
        or after[KEY].value != value
    ):
        line = root.key_span(KEY).line if KEY in root else 1
        raise CannotEdit(f"{file}:{line}: EPG cannot edit this form: change '{KEY}' in an editor")
