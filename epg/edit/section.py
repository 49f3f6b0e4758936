# SPDX-License-Identifier: Apache-2.0
"""Adds ports to the sections ``inputs`` and ``outputs`` of a bindings file at the right place, and removes them.

A section can be missing, commented out by ``epg bind``, empty, or in braces.  It can have comments of ``epg bind`` for
ports that are not bound yet (:func:`open_port`).

The functions that edit take the whole text and return the changed text.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import takewhile

import yaml

from epg.edit import yaml_edit
from epg.edit.scalars import scalar_text
from epg.generator.dataclass import dataclass

ORDER = ("version", "model", "inputs", "outputs", "parameters", "motors")
"""The keys of a bindings file, in the order in which EPG writes them."""
_SECTIONS = ("inputs", "outputs")
_OPEN_PORT = re.compile(r"# (.*):    # no name matches; possible: .*")


def open_port(name: str, candidates: Sequence[str]) -> str:
    """The comment for a port that is not bound."""
    return f"# {scalar_text(name)}:    # no name matches; possible: {', '.join(candidates) or 'nothing'}"


def open_section(section: str) -> str:
    """The first line of a section in which all ports are comments of :func:`open_port`."""
    return f"# {section}:    # remove this '#' with the first below it"


def remove_port(text: str, section: str, port: str) -> str:
    """The text without the lines of ``port``.  A section without ports becomes ``{}``: its value must be a map."""
    node = yaml_edit.node_at(text, (section,))
    last = len(node.value) == 1
    if not last or yaml_edit.is_flow(node):
        return yaml_edit.remove(text, (section, port))
    start = yaml_edit.start_of(node)
    text = yaml_edit.remove_lines(text, start, yaml_edit.end_of(text, node))
    return yaml_edit.replace(text, (section,), "{}")


def add_port(text: str, section: str, order: Sequence[str], port: str, value: str | list[str]) -> str:
    """The text with ``port: value``.  The text must not have the port yet.

    ``order`` are the names of all ports of the section, in the order of the model.  A ``value`` in block style is a
    list of lines, which are indented relative to the port.
    """
    root = yaml_edit.node_at(text, ())
    node = yaml_edit.find(text, (section,))
    if node is None:
        if yaml_edit.is_flow(root):
            present = [key.value for key, _ in root.value]
            index = _index(present, ORDER, section)
            return yaml_edit.insert(text, (), index, f"{section}: {{{_entry(port, value)}}}")
        text = _with_section(text, root, section)
        node = yaml_edit.node_at(text, (section,))
    if yaml_edit.is_flow(root) or (yaml_edit.is_flow(node) and (node.value or not _may_open(text, section, node))):
        if isinstance(node, yaml.ScalarNode):
            return yaml_edit.replace(text, (section,), f"{{{_entry(port, value)}}}")
        present = [key.value for key, _ in node.value]
        return yaml_edit.insert(text, (section,), _index(present, order, port), _entry(port, value))
    if not isinstance(node, yaml.MappingNode) or not node.value:
        text = _opened(text, section, node)
    return _put(text, section, order, port, value)


def _entry(port: str, value: str | list[str]) -> str:
    """``port: value`` for a section in braces."""
    if isinstance(value, list):
        value = f"[{', '.join(line.strip().removeprefix('- ') for line in value)}]"
    return f"{scalar_text(port)}: {value}"


def _index(present: Sequence[str], order: Sequence[str], name: str) -> int:
    """The index at which ``name`` is inserted into ``present``: behind the nearest name before it in ``order``."""
    for other in reversed(order[: order.index(name)]):
        if other in present:
            return present.index(other) + 1
    return 0


def _may_open(text: str, section: str, node: yaml.Node) -> bool:
    """True if ``{}`` can be removed, so that each port gets its own line.

    Nothing may be inside of the braces, or between them and the colon.
    """
    before = text[yaml_edit.colon_of(text, (section,)) + 1 : yaml_edit.start_of(node)]
    return (
        not before.strip() and not yaml_edit.has_break(before) and yaml_edit.source_of(text, node)[1:-1].strip() == ""
    )


def _opened(text: str, section: str, node: yaml.Node) -> str:
    """The text without the value behind the section's colon."""
    if not yaml_edit.source_of(text, node):
        return text
    colon = yaml_edit.colon_of(text, (section,))
    return text[: colon + 1] + text[yaml_edit.end_of(text, node) :]


def _with_section(text: str, root: yaml.Node, section: str) -> str:
    """The text with a section that has no ports yet: in place of its comment, or behind the key before it."""
    line = _open_section_of(text, section)
    if line is None:
        return _with_line(text, section, f"{section}:")
    end = yaml_edit.line_end(text, line)
    return f"{text[:line]}{' ' * root.start_mark.column}{section}:{text[end:]}"


def _with_line(text: str, section: str, line: str) -> str:
    """The text with ``line`` at the place of ``section``: behind the key before it and the comments of this key."""
    root = yaml_edit.node_at(text, ())
    index = _index([key.value for key, _ in root.value], ORDER, section)
    if index == 0 and not line.startswith("#"):
        return yaml_edit.insert(text, (), 0, line)
    last = root if yaml_edit.is_flow(root) else root.value[max(index - 1, 0)][1]
    column = root.start_mark.column
    position = yaml_edit.end_of(text, last)
    # Skip comments that belong to the key before, and comments of a section that is commented out.
    for following in _lines(text, yaml_edit.next_line(text, position), len(text)):
        if _is_deeper_comment(text, following, column) or any(_is_open(text, following, name) for name in _SECTIONS):
            position = following
        elif text[following : yaml_edit.line_end(text, following)].strip():
            break
    return yaml_edit.insert_lines(text, position, [" " * column + line])


def _is_deeper_comment(text: str, line: int, column: int) -> bool:
    words = text[line : yaml_edit.line_end(text, line)]
    return len(words) - len(words.lstrip(" ")) > column and words.lstrip(" ").startswith("#")


def _is_open(text: str, line: int, section: str) -> bool:
    return text[line : yaml_edit.line_end(text, line)].strip() == open_section(section)


def _open_section_of(text: str, section: str) -> int | None:
    """The position of the line that begins a section that is commented out, or None."""
    return next((line for line in _lines(text, 0, len(text)) if _is_open(text, line, section)), None)


def _lines(text: str, start: int, end: int) -> list[int]:
    """The positions at which the lines from ``start`` to ``end`` begin.  ``start`` must be the begin of a line."""
    lines = []
    while start < end:
        lines.append(start)
        start = yaml_edit.next_line(text, start)
    return lines


def add_open_port(text: str, section: str, order: Sequence[str], port: str, candidates: Sequence[str]) -> str:
    """The text with the comment for a port that is not bound, at the place of the port.

    Returns the same text if it has this comment already.
    """
    if yaml_edit.find(text, (section,)) is None and _open_section_of(text, section) is None:
        text = _with_line(text, section, open_section(section))
    place = _place_of(text, section, order)
    if port in place.comments:
        return text
    return _inserted(text, place, order, port, [" " * place.column + open_port(port, candidates)])


def comment_out_port(text: str, section: str, port: str, remark: str) -> str:
    """The text with the lines of ``port`` as comments.  The first of them ends with ``remark``."""
    parent = yaml_edit.node_at(text, (section,))
    key, value = next((key, value) for key, value in parent.value if key.value == port)
    start, end = yaml_edit.start_of(key), yaml_edit.end_of(text, value)
    if yaml_edit.is_flow(parent):
        written = re.split(r"\s*[\r\n]\s*", text[start:end])
        text = yaml_edit.remove(text, (section, port))
        place = _place_of(text, section, ())
        comment = [f"{' ' * place.column}# {words}" for words in written]
        return yaml_edit.insert_lines(text, place.head, [f"{comment[0]}   # {remark}", *comment[1:]])
    first = yaml_edit.line_start(text, start)
    depth = start - first
    lines = _lines(text, first, end)
    for line in reversed(lines):
        stop = yaml_edit.line_end(text, line)
        words = text[line:stop]
        blanks = min(len(words) - len(words.lstrip()), depth)
        words = f"{words[:blanks]}# {words[blanks:]}" + (f"   # {remark}" if line == first else "")
        text = text[:line] + words + text[stop:]
    return text if len(parent.value) > 1 else yaml_edit.replace(text, (section,), "{}")


@dataclass(frozen=True)
class _Place:
    """The positions of the parts of a section in block style, without a value, or commented out.

    The first port must be below ``head``.  ``column`` is the column of the ports.
    """

    head: int
    ports: Mapping[str, int]  # port -> end of its value
    comments: Mapping[str, int]  # port that is not bound -> begin of the line of its comment
    column: int


def _place_of(text: str, section: str, order: Sequence[str]) -> _Place:
    """The positions of the parts of a section, which must exist or be commented out."""
    root = yaml_edit.node_at(text, ())
    node = yaml_edit.find(text, (section,))
    if node is None:
        line = _open_section_of(text, section)
        assert line is not None
        comments = _comments(text, order, line, [])
        return _Place(line, {}, comments, _column(text, section, line))
    colon = yaml_edit.colon_of(text, (section,))
    entries = node.value if isinstance(node, yaml.MappingNode) and not yaml_edit.is_flow(node) else []
    spans = [(yaml_edit.start_of(key), yaml_edit.end_of(text, child)) for key, child in entries]
    head = colon if entries else max(colon, yaml_edit.end_of(text, root if yaml_edit.is_flow(root) else node))
    comments = _comments(text, order, head, spans)
    column = yaml_edit.column_of(text, spans[0][0]) if spans else _column(text, section, head)
    return _Place(head, {key.value: end for (key, _), (_, end) in zip(entries, spans)}, comments, column)


def _put(text: str, section: str, order: Sequence[str], port: str, value: str | list[str]) -> str:
    """The text with a port in a section in block style, or without a value yet.

    The port replaces its comment of :func:`open_port` if there is one.
    """
    place = _place_of(text, section, order)
    blanks = " " * place.column
    lines = [f"{blanks}{scalar_text(port)}:" + (f" {value}" if isinstance(value, str) else "")]
    lines += [blanks + line for line in value] if isinstance(value, list) else []
    if port in place.comments:
        start = place.comments[port]
        return yaml_edit.remove_lines(yaml_edit.insert_lines(text, start, lines), start, start)
    return _inserted(text, place, order, port, lines)


def _inserted(text: str, place: _Place, order: Sequence[str], port: str, lines: Sequence[str]) -> str:
    """The text with ``lines`` below those of the nearest port before ``port``, or below the section's name."""
    known = {**place.comments, **place.ports}
    for name in reversed(order[: order.index(port)]):
        if name in known:
            return yaml_edit.insert_lines(text, known[name], lines)
    # Comments below an empty section were written above a port that has been removed.
    below = [] if known else _comments_below(text, place.head)
    return yaml_edit.insert_lines(text, below[-1] if below else place.head, lines)


def _comments_below(text: str, head: int) -> list[int]:
    """The positions of comment lines that belong to a section by their indentation, up to the first other line."""
    base = _base_column(text)
    lines = _lines(text, yaml_edit.next_line(text, head), len(text))
    return list(takewhile(lambda line: _is_deeper_comment(text, line, base), lines))


def _base_column(text: str) -> int:
    return int(yaml_edit.node_at(text, ()).start_mark.column)


def _column(text: str, section: str, head: int) -> int:
    """The column of the first port: that of the comments below the section, or of the ports in the other section.

    Otherwise it is two more than the column of the section.
    """
    base = _base_column(text)
    lines = (text[line : yaml_edit.line_end(text, line)] for line in _comments_below(text, head))
    depths = [len(line) - len(line.lstrip(" ")) for line in lines]
    for other in _SECTIONS:
        node = yaml_edit.find(text, (other,))
        if other != section and isinstance(node, yaml.MappingNode) and node.value and not node.flow_style:
            depths.append(node.start_mark.column)
    return next((depth for depth in depths if depth > base), base + 2)


def _comments(text: str, order: Sequence[str], head: int, taken: Sequence[yaml_edit.Extent]) -> dict[str, int]:
    """Port -> position of its comment of :func:`open_port`, between the section's name and the next key.

    ``taken`` are the parts of the text with bound ports, whose comments do not count.
    """
    root = yaml_edit.node_at(text, ())
    keys = [yaml_edit.line_start(text, yaml_edit.start_of(key)) for key, _ in root.value]
    end = min((key for key in keys if key > head), default=len(text))
    names = {scalar_text(name): name for name in order}
    lines: dict[str, int] = {}
    for line in _lines(text, yaml_edit.next_line(text, head), end):
        words = text[line : yaml_edit.line_end(text, line)].strip()
        if any(words == open_section(other) for other in _SECTIONS):
            break
        comment = _OPEN_PORT.fullmatch(words)
        if comment and comment[1] in names and not any(start <= line < stop for start, stop in taken):
            lines.setdefault(names[comment[1]], line)
    return lines
