"""Ports of a bindings file as entries of its sections ``inputs`` and ``outputs``: put in at their place, taken out.

A section may be missing, commented out by ``epg bind``, empty, or in braces; ports may stand in it as comments that
``epg bind`` left (:func:`open_port`).
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import yaml

from epg.emit import yaml_edit
from epg.emit.yaml_text import scalar_text

ORDER = ("version", "model", "inputs", "outputs", "parameters")
"""Keys of a bindings file in the order in which EPG writes them."""
_SECTIONS = ("inputs", "outputs")


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
    return _place(text, section, order, port, value)


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
    column = root.start_mark.column
    for line in _lines(text, 0, len(text)):
        if _is_open_section(text, line, section):
            end = yaml_edit.line_end(text, line)
            return f"{text[:line]}{' ' * column}{section}:{text[end:]}"
    index = _index([key.value for key, _ in root.value], ORDER, section)
    if index == 0:
        return yaml_edit.insert(text, (), 0, f"{section}:")
    position = yaml_edit.end_of(text, root.value[index - 1][1])
    # comments that belong to the key before
    following = yaml_edit.next_line(text, position)
    while following < len(text) and _belongs_above(text, following, column):
        position, following = following, yaml_edit.next_line(text, following)
    return yaml_edit.insert_lines(text, position, [f"{' ' * column}{section}:"])


def _belongs_above(text: str, line: int, column: int) -> bool:
    words = text[line : yaml_edit.line_end(text, line)]
    deeper = len(words) - len(words.lstrip(" ")) > column and words.lstrip(" ").startswith("#")
    return deeper or any(_is_open_section(text, line, section) for section in _SECTIONS)


def _is_open_section(text: str, line: int, section: str) -> bool:
    return text[line : yaml_edit.line_end(text, line)].strip() == open_section(section)


def _lines(text: str, start: int, end: int) -> list[int]:
    """Where the lines begin from ``start`` on, which begins one."""
    lines = []
    while start < end:
        lines.append(start)
        start = yaml_edit.next_line(text, start)
    return lines


def _place(text: str, section: str, order: Sequence[str], port: str, value: str | list[str]) -> str:
    """Puts lines into a section in block style, or one that has no value yet."""
    colon = yaml_edit.colon_of(text, (section,))
    node = yaml_edit.node_at(text, (section,))
    entries = node.value if isinstance(node, yaml.MappingNode) else []
    spans = {key.value: (yaml_edit.start_of(key), yaml_edit.end_of(text, child)) for key, child in entries}
    comments = _comments(text, section, order, list(spans.values()))
    column = _column(text, section, [start for start, _ in spans.values()], list(comments.values()))
    lines = [f"{' ' * column}{scalar_text(port)}:" + (f" {value}" if isinstance(value, str) else "")]
    lines += [" " * column + line for line in value] if isinstance(value, list) else []
    if port in comments:
        # the comment's line end is the new line's
        start = comments[port]
        text = yaml_edit.insert_lines(text, start, lines)
        return yaml_edit.remove_lines(text, start, start)
    places = comments | {name: end for name, (_, end) in spans.items()}
    for name in reversed(order[: order.index(port)]):
        if name in places:
            return yaml_edit.insert_lines(text, places[name], lines)
    position = max(colon, yaml_edit.start_of(node) if not entries else colon)
    if not places:
        # comments below an empty section were above a port that was taken out
        base = _base_column(text)
        following = yaml_edit.next_line(text, position)
        while following < len(text) and _belongs_above(text, following, base):
            if any(_is_open_section(text, following, other) for other in _SECTIONS):
                break
            position, following = following, yaml_edit.next_line(text, following)
    return yaml_edit.insert_lines(text, position, lines)


def _base_column(text: str) -> int:
    return int(yaml_edit.node_at(text, ()).start_mark.column)


def _column(text: str, section: str, entries: list[int], comments: list[int]) -> int:
    """How far ports are indented: as the others are, or as their comments, or as in the other section, or by two."""
    base = _base_column(text)
    if entries:
        return yaml_edit.column_of(text, entries[0])
    depths = [len(re.match(r" *", text[line:])[0]) for line in comments]  # type: ignore[index]
    for other in _SECTIONS:
        node = yaml_edit.find(text, (other,))
        if other != section and isinstance(node, yaml.MappingNode) and node.value and not node.flow_style:
            depths.append(node.start_mark.column)
    return next((depth for depth in depths if depth > base), base + 2)


def _comments(text: str, section: str, order: Sequence[str], taken: Sequence[yaml_edit.Item]) -> dict[str, int]:
    """Where the comments for open ports are, which stand below the section's name and above the next key."""
    root = yaml_edit.node_at(text, ())
    colon = yaml_edit.colon_of(text, (section,))
    end = min((yaml_edit.start_of(key) for key, _ in root.value if yaml_edit.start_of(key) > colon), default=len(text))
    found: dict[str, int] = {}
    for line in _lines(text, yaml_edit.next_line(text, colon), yaml_edit.line_start(text, end)):
        if any(_is_open_section(text, line, other) for other in _SECTIONS):
            break
        words = text[line : yaml_edit.line_end(text, line)].strip()
        if not words.startswith("#") or any(start <= line < stop for start, stop in taken):
            continue
        for name in order:
            if words.startswith(open_port(name, ())[: -len("nothing")].rstrip()):
                found.setdefault(name, line)
    return found
