# SPDX-License-Identifier: Apache-2.0
"""Ports of a bindings file as entries of its sections ``inputs`` and ``outputs``: put in at their place, taken out.

A section may be missing, commented out by ``epg bind``, empty, or in braces; ports may stand in it as comments that
``epg bind`` left (:func:`open_port`).
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile

import yaml

from epg.edit import yaml_edit
from epg.edit.scalars import scalar_text

ORDER = ("version", "model", "inputs", "outputs", "parameters")
"""Keys of a bindings file in the order in which EPG writes them."""
_SECTIONS = ("inputs", "outputs")
_OPEN_PORT = re.compile(r"# (.*):    # no name matches; possible: .*")


def open_port(name: str, candidates: Sequence[str]) -> str:
    """The comment for a port that nobody has bound."""
    return f"# {scalar_text(name)}:    # no name matches; possible: {', '.join(candidates) or 'nothing'}"


def open_section(section: str) -> str:
    """The first line of a section in which all ports are such comments."""
    return f"# {section}:    # remove this '#' with the first below it"


def remove_port(text: str, section: str, port: str) -> str:
    """Without the lines of ``port``; a section without ports becomes ``{}``, as files must say it."""
    node = yaml_edit.node_at(text, (section,))
    last = len(node.value) == 1
    if not last or yaml_edit.is_flow(node):
        return yaml_edit.remove(text, (section, port))
    start = yaml_edit.start_of(node)
    text = yaml_edit.remove_lines(text, start, yaml_edit.end_of(text, node))
    return yaml_edit.replace(text, (section,), "{}")


def add_port(text: str, section: str, order: Sequence[str], port: str, value: str | list[str]) -> str:
    """With ``port: value``, which is not in the text; ``order`` are the names of all ports of the section.

    A list of lines is a value in block style; their indentation counts from that of the port.
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
    """``port: value`` for a place between braces."""
    if isinstance(value, list):
        value = f"[{', '.join(line.strip().removeprefix('- ') for line in value)}]"
    return f"{scalar_text(port)}: {value}"


def _index(present: Sequence[str], order: Sequence[str], name: str) -> int:
    """Where ``name`` comes among ``present``: behind the nearest that is before it in ``order``."""
    for other in reversed(order[: order.index(name)]):
        if other in present:
            return present.index(other) + 1
    return 0


def _may_open(text: str, section: str, node: yaml.Node) -> bool:
    """Whether ``{}`` can go, so that ports stand on lines of their own: nothing else is in it or before it."""
    before = text[yaml_edit.colon_of(text, (section,)) + 1 : yaml_edit.start_of(node)]
    return (
        not before.strip() and not yaml_edit.has_break(before) and yaml_edit.source_of(text, node)[1:-1].strip() == ""
    )


def _opened(text: str, section: str, node: yaml.Node) -> str:
    """With nothing behind the section's colon."""
    if not yaml_edit.source_of(text, node):
        return text
    colon = yaml_edit.colon_of(text, (section,))
    return text[: colon + 1] + text[yaml_edit.end_of(text, node) :]


def _with_section(text: str, root: yaml.Node, section: str) -> str:
    """With a section that has no ports yet: in the place of its comment, or behind the key before it."""
    line = _open_section_of(text, section)
    if line is None:
        return _with_line(text, section, f"{section}:")
    end = yaml_edit.line_end(text, line)
    return f"{text[:line]}{' ' * root.start_mark.column}{section}:{text[end:]}"


def _with_line(text: str, section: str, line: str) -> str:
    """With a line where ``section`` should be."""
    root = yaml_edit.node_at(text, ())
    index = _index([key.value for key, _ in root.value], ORDER, section)
    if index == 0 and not line.startswith("#"):
        return yaml_edit.insert(text, (), 0, line)
    last = root if yaml_edit.is_flow(root) else root.value[max(index - 1, 0)][1]
    column = root.start_mark.column
    position = yaml_edit.end_of(text, last)
    # comments that belong to the key before, and those of a section that is commented out
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
    """Where the line begins that says the section is commented out."""
    return next((line for line in _lines(text, 0, len(text)) if _is_open(text, line, section)), None)


def _lines(text: str, start: int, end: int) -> list[int]:
    """Where the lines begin from ``start`` on, which begins one."""
    lines = []
    while start < end:
        lines.append(start)
        start = yaml_edit.next_line(text, start)
    return lines


def add_open_port(text: str, section: str, order: Sequence[str], port: str, candidates: Sequence[str]) -> str:
    """With the comment for a port that nobody has bound, where the port would be, if there is none yet."""
    if yaml_edit.find(text, (section,)) is None and _open_section_of(text, section) is None:
        text = _with_line(text, section, open_section(section))
    place = _place_of(text, section, order)
    if port in place.comments:
        return text
    return _inserted(text, place, order, port, [" " * place.column + open_port(port, candidates)])


def comment_out_port(text: str, section: str, port: str, remark: str) -> str:
    """With ``port`` as a comment that ends with ``remark``."""
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
    """A section in block style, or one that has no value or is a comment: where its parts begin and end.

    ``head`` is behind all of which the first port must be below, ``column`` is that of the ports.
    """

    head: int
    ports: Mapping[str, int]  # where their values end
    comments: Mapping[str, int]  # those of open ports, where their lines begin
    column: int


def _place_of(text: str, section: str, order: Sequence[str]) -> _Place:
    root = yaml_edit.node_at(text, ())
    node = yaml_edit.find(text, (section,))
    if node is None:
        line = _open_section_of(text, section)
        assert line is not None
        comments = _comments(text, section, order, line, [])
        return _Place(line, {}, comments, _column(text, section, line))
    colon = yaml_edit.colon_of(text, (section,))
    entries = node.value if isinstance(node, yaml.MappingNode) and not yaml_edit.is_flow(node) else []
    spans = [(yaml_edit.start_of(key), yaml_edit.end_of(text, child)) for key, child in entries]
    head = colon if entries else max(colon, yaml_edit.end_of(text, root if yaml_edit.is_flow(root) else node))
    comments = _comments(text, section, order, head, spans)
    column = yaml_edit.column_of(text, spans[0][0]) if spans else _column(text, section, head)
    return _Place(head, {key.value: end for (key, _), (_, end) in zip(entries, spans)}, comments, column)


def _put(text: str, section: str, order: Sequence[str], port: str, value: str | list[str]) -> str:
    """Puts a port into a section in block style, or one that has no value yet."""
    place = _place_of(text, section, order)
    blanks = " " * place.column
    lines = [f"{blanks}{scalar_text(port)}:" + (f" {value}" if isinstance(value, str) else "")]
    lines += [blanks + line for line in value] if isinstance(value, list) else []
    if port in place.comments:
        start = place.comments[port]
        return yaml_edit.remove_lines(yaml_edit.insert_lines(text, start, lines), start, start)
    return _inserted(text, place, order, port, lines)


def _inserted(text: str, place: _Place, order: Sequence[str], port: str, lines: Sequence[str]) -> str:
    """Lines below those of the nearest port before ``port``, or below the section's name."""
    known = {**place.comments, **place.ports}
    for name in reversed(order[: order.index(port)]):
        if name in known:
            return yaml_edit.insert_lines(text, known[name], lines)
    # comments below an empty section were above a port that was taken out
    below = [] if known else _comments_below(text, place.head)
    return yaml_edit.insert_lines(text, below[-1] if below else place.head, lines)


def _comments_below(text: str, head: int) -> list[int]:
    """The lines of comments that belong to a section by their indentation, up to the first other line."""
    base = _base_column(text)
    lines = _lines(text, yaml_edit.next_line(text, head), len(text))
    return list(takewhile(lambda line: _is_deeper_comment(text, line, base), lines))


def _base_column(text: str) -> int:
    return int(yaml_edit.node_at(text, ()).start_mark.column)


def _column(text: str, section: str, head: int) -> int:
    """How far the first port is indented: as comments below the section are, or as in the other one, or by two."""
    base = _base_column(text)
    lines = (text[line : yaml_edit.line_end(text, line)] for line in _comments_below(text, head))
    depths = [len(line) - len(line.lstrip(" ")) for line in lines]
    for other in _SECTIONS:
        node = yaml_edit.find(text, (other,))
        if other != section and isinstance(node, yaml.MappingNode) and node.value and not node.flow_style:
            depths.append(node.start_mark.column)
    return next((depth for depth in depths if depth > base), base + 2)


def _comments(
    text: str, section: str, order: Sequence[str], head: int, taken: Sequence[yaml_edit.Item]
) -> dict[str, int]:
    """Where the comments for open ports are, which stand below the section's name and above the next key."""
    root = yaml_edit.node_at(text, ())
    keys = [yaml_edit.line_start(text, yaml_edit.start_of(key)) for key, _ in root.value]
    end = min((key for key in keys if key > head), default=len(text))
    names = {scalar_text(name): name for name in order}
    found: dict[str, int] = {}
    for line in _lines(text, yaml_edit.next_line(text, head), end):
        words = text[line : yaml_edit.line_end(text, line)].strip()
        if any(words == open_section(other) for other in _SECTIONS):
            break
        comment = _OPEN_PORT.fullmatch(words)
        if comment and comment[1] in names and not any(start <= line < stop for start, stop in taken):
            found.setdefault(names[comment[1]], line)
    return found
