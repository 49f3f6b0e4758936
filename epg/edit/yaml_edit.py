# SPDX-License-Identifier: Apache-2.0
"""Edits of YAML text that change only the characters of one value or one entry.

The files belong to the user.  PyYAML would write the whole document again, without its comments, blank lines, quotes
and line ends.  Therefore only its positions are used.

Each function takes the text, finds the place of the edit by the positions of PyYAML's nodes, and returns the new text.
The functions do not know the meaning of the text, and they do not check the result: callers must parse it again.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import yaml

from epg.generator.diagnostics import Diagnostics
from epg.generator.documents import yaml_file
from epg.generator.source import YamlNode

_BREAK = re.compile("\r\n|[\r\n\x85\u2028\u2029]")
_REST = re.compile(r"[ \t]*(#.*)?")
Steps = tuple["str | int", ...]
"""The path from the root to a value: keys of maps and indices of lists."""
Extent = tuple[int, int]
"""The begin and the end of an entry of a map or an element of a list in the text, without comments and commas."""


class CannotEdit(Exception):
    """EPG cannot make this change; the user can in an editor.  The message says where and why."""


def parse_map(text: str, file: str) -> YamlNode:
    """Parses ``text``, which must be a map.  ``file`` is its name in messages.

    Raises :class:`CannotEdit` with the first mistake.
    """
    problems = Diagnostics()
    root = yaml_file.parse_yaml(text, file, problems)
    if root is None:
        first = next(iter(problems))
        raise CannotEdit(f"{file}:{first.span.line}: {first.message}: correct this in an editor first")
    if not root.is_mapping:
        raise CannotEdit(f"{file}:1: this is not a map (key: value): correct this in an editor first")
    return root


def compose(text: str) -> yaml.Node:
    """PyYAML's root node of ``text``, which :func:`epg.generator.documents.yaml_file.parse_yaml` must have accepted
    before."""
    return _compose(text, yaml_file.LOADER)


@lru_cache(maxsize=4)
def _compose(text: str, loader: Any) -> yaml.Node:
    # One edit needs the nodes of the same text several times.
    try:
        root = yaml.compose(text, Loader=loader)
    except (yaml.YAMLError, RecursionError) as error:
        raise CannotEdit(f"YAML: {str(error).splitlines()[0]}") from None
    if root is None:
        raise CannotEdit("the file is empty")
    return root


def find(text: str, path: Steps) -> yaml.Node | None:
    """The node at ``path``, or None."""
    node: yaml.Node = compose(text)
    for step in path:
        if isinstance(node, yaml.MappingNode):
            values = [value for key, value in node.value if key.value == step]
        else:
            values = (
                node.value[step : step + 1] if isinstance(node, yaml.SequenceNode) and isinstance(step, int) else []
            )
        if not values:
            return None
        node = values[0]
    return node


def node_at(text: str, path: Steps) -> yaml.Node:
    """The node at ``path``.  Raises :class:`CannotEdit` if there is none."""
    node = find(text, path)
    if node is None:
        raise CannotEdit(f"there is no '{'.'.join(map(str, path))}'")
    return node


def start_of(node: yaml.Node) -> int:
    """The position at which the node begins in the text."""
    return int(node.start_mark.index)


def end_of(text: str, node: yaml.Node) -> int:
    """The end of the last value in ``node``.

    PyYAML's own end of a block is not used: it is the begin of the next token, behind comments and blank lines.
    """
    if isinstance(node, yaml.ScalarNode):
        end = int(node.end_mark.index)
        return max(len(text[:end].rstrip()), start_of(node)) if node.style in ("|", ">") else end
    if is_flow(node) or not node.value:
        return int(node.end_mark.index)
    last = node.value[-1]
    return end_of(text, last[1] if isinstance(last, tuple) else last)


def is_flow(node: yaml.Node) -> bool:
    """True if the node is written with ``{}`` or ``[]``."""
    return bool(getattr(node, "flow_style", False))


def source_of(text: str, node: yaml.Node) -> str:
    """The part of the text that is the node, with its quotes or brackets."""
    return text[start_of(node) : end_of(text, node)]


def line_start(text: str, position: int) -> int:
    """The begin of the line of ``position``."""
    return max(text.rfind(character, 0, position) for character in "\r\n\x85\u2028\u2029") + 1


def line_end(text: str, position: int) -> int:
    """The end of the line of ``position``, before its line break."""
    line_break = _BREAK.search(text, position)
    return line_break.start() if line_break else len(text)


def next_line(text: str, position: int) -> int:
    """The begin of the next line, or the end of the text."""
    line_break = _BREAK.search(text, position)
    return line_break.end() if line_break else len(text)


def column_of(text: str, position: int) -> int:
    """The column of ``position``, counted from 0."""
    return position - line_start(text, position)


def has_break(text: str) -> bool:
    """True if the text has more than one line."""
    return _BREAK.search(text) is not None


def insert_lines(text: str, position: int, lines: Sequence[str]) -> str:
    """The text with ``lines`` below the line of ``position``.

    If this is the last line and has no line end, the new last line has none either.
    """
    line_break = _BREAK.search(text, position)
    if line_break:
        return text[: line_break.end()] + "".join(line + line_break[0] for line in lines) + text[line_break.end() :]
    return text + "".join(_line_break(text) + line for line in lines)


def remove_lines(text: str, start: int, end: int) -> str:
    """The text without the lines from that of ``start`` to that of ``end``."""
    first = line_start(text, start)
    line_break = _BREAK.search(text, end)
    if line_break:
        return text[:first] + text[line_break.end() :]
    return text[: first - 2] if text.endswith("\r\n", 0, first) else text[: max(first - 1, 0)]


def skip_gap(text: str, position: int) -> int:
    """The position of the first character from ``position`` on that is not blank and not part of a comment."""
    while position < len(text):
        if text[position] == "#":
            position = line_end(text, position)
        elif text[position] in " \t\r\n\x85\u2028\u2029":
            position += 1
        else:
            break
    return position


def colon_of(text: str, path: Steps) -> int:
    """The position of the ``:`` before the value at ``path``."""
    parent = node_at(text, path[:-1])
    for key, _ in parent.value:
        if key.value == path[-1]:
            colon = skip_gap(text, key.end_mark.index)
            if text[colon : colon + 1] == ":":
                return colon
    raise CannotEdit(f"'{path[-1]}' has no ':'")


def replace(text: str, path: Steps, new: str) -> str:
    """The text with ``new`` in place of the value at ``path``.

    If the old value was a block on the lines below its key, ``new`` is on the line of the key.
    """
    node = node_at(text, path)
    start, end = start_of(node), end_of(text, node)
    if start == end:
        return f"{text[:start]} {new}{text[end:]}"
    if is_flow(node) or isinstance(node, yaml.ScalarNode):
        return text[:start] + new + text[end:]
    anchor = colon_of(text, path) if isinstance(path[-1], str) else _dash(text, path)
    if line_start(text, anchor) == line_start(text, start):
        return text[:start] + new + text[end:]
    text = remove_lines(text, start, end)
    return f"{text[: anchor + 1]} {new}{text[anchor + 1 :]}"


def replace_by_lines(text: str, path: Steps, lines: Sequence[str]) -> str:
    """The text with ``lines`` below the key at ``path``, in place of its value.

    The key must be in a block.  The lines are indented relative to its column.
    """
    node = node_at(text, path)
    colon = colon_of(text, path)
    key = next(key for key, _ in node_at(text, path[:-1]).value if key.value == path[-1])
    indent = " " * column_of(text, start_of(key))
    start, end = start_of(node), end_of(text, node)
    if line_start(text, colon) == line_start(text, start):
        text = text[: colon + 1] + text[end:]
    else:
        text = remove_lines(text, start, end)
    return insert_lines(text, colon, [indent + line for line in lines])


def indent_as_element(text: str, node: yaml.Node) -> str:
    """The text with a list whose only element is the block map ``node``."""
    end = end_of(text, node)
    position = next_line(text, start_of(node))
    result = f"{text[: start_of(node)]}- {text[start_of(node) : position]}"
    while position < end:
        following = next_line(text, position)
        blank = not text[position:following].strip()
        result += text[position:following] if blank else "  " + text[position:following]
        position = following
    return result + text[position:]


def insert(text: str, path: Steps, index: int, new: str) -> str:
    """The text with ``new`` (``key: value``, or an element) as entry ``index`` of the map or list at ``path``."""
    node = node_at(text, path)
    items = _items(text, node)
    if is_flow(node):
        return _insert_flow(text, node, items, index, new)
    mark = "- " if isinstance(node, yaml.SequenceNode) else ""
    first = items[0][0]
    indent = " " * column_of(text, first)
    if index > 0:
        return insert_lines(text, items[index - 1][1], [indent + mark + new])
    line_break = _BREAK.search(text, first)
    return f"{text[:first]}{mark}{new}{line_break[0] if line_break else _line_break(text)}{indent}{text[first:]}"


def remove(text: str, path: Steps) -> str:
    """The text without the entry at ``path``.

    If the entry is alone on its lines, comments inside of it and behind it are removed, too.  A map or list in block
    style must have another entry.
    """
    parent = node_at(text, path[:-1])
    items = _items(text, parent)
    index = path[-1] if isinstance(path[-1], int) else [key.value for key, _ in parent.value].index(path[-1])
    if is_flow(parent):
        return _remove_flow(text, items, index)
    start, end = items[index]
    if not text[line_start(text, start) : start].strip():
        return remove_lines(text, start, end)
    # This is the first key of a map that begins on the line of a dash.
    following = skip_gap(text, end)
    if "#" in text[line_end(text, end) : following]:
        return text[:start].rstrip() + text[line_end(text, end) :]
    return text[:start] + text[following:]


def _items(text: str, node: yaml.Node) -> list[Extent]:
    if isinstance(node, yaml.MappingNode):
        return [(start_of(key), max(end_of(text, key), end_of(text, value))) for key, value in node.value]
    items: list[Extent] = []
    position = start_of(node)
    for element in node.value:
        start = start_of(element) if is_flow(node) else skip_gap(text, position)
        position = end_of(text, element)
        items.append((start, position))
    return items


def _dash(text: str, path: Steps) -> int:
    index = path[-1]
    assert isinstance(index, int)
    return _items(text, node_at(text, path[:-1]))[index][0]


def _comma(text: str, end: int) -> int | None:
    """The position of the comma behind the entry that ends at ``end``, or None."""
    position = skip_gap(text, end)
    return position if text[position : position + 1] == "," else None


def _has_own_lines(text: str, item: Extent, comma: int | None) -> bool:
    """True if the lines of an entry have only this entry, its comma and a comment."""
    start, end = item
    behind = end if comma is None else comma + 1
    rest = text[behind : line_end(text, behind)]
    return not text[line_start(text, start) : start].strip() and _REST.fullmatch(rest) is not None


def _insert_flow(text: str, node: yaml.Node, items: list[Extent], index: int, new: str) -> str:
    """:func:`insert` for a node in braces or brackets.  The entry gets its own line if its neighbour has one."""
    if not items:
        inside = start_of(node) + 1
        return text[:inside] + new + text[inside:]
    start, end = items[max(index - 1, 0)]
    comma = _comma(text, end)
    if not _has_own_lines(text, (start, end), comma):
        return f"{text[:end]}, {new}{text[end:]}" if index > 0 else f"{text[:start]}{new}, {text[start:]}"
    first = line_start(text, start)
    indent = text[first:start]
    if index == 0:
        line_break = _BREAK.search(text, start)
        return f"{text[:first]}{indent}{new},{line_break[0] if line_break else _line_break(text)}{text[first:]}"
    if comma is not None:
        return insert_lines(text, comma, [f"{indent}{new},"])
    return insert_lines(f"{text[:end]},{text[end:]}", end + 1, [f"{indent}{new}"])


def _remove_flow(text: str, items: list[Extent], index: int) -> str:
    """:func:`remove` for a node in braces or brackets, with one of the commas around the entry."""
    start, end = items[index]
    comma = _comma(text, end)
    before = _comma(text, items[index - 1][1]) if index > 0 else None
    stop = end if comma is None else comma + 1
    if _has_own_lines(text, items[index], comma):
        text = remove_lines(text, start, stop)
        return text[:before] + text[before + 1 :] if comma is None and before is not None else text
    if before is not None and "#" not in text[before:start]:
        return text[:before] + text[end:]
    if index == 0 and len(items) > 1 and "#" not in text[stop : items[1][0]]:
        stop = items[1][0]
    return text[:start] + text[stop:]


def _line_break(text: str) -> str:
    line_break = _BREAK.search(text)
    return line_break[0] if line_break else "\n"
