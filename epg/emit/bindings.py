"""Bindings files as text: new ones, and old ones after a re-export with everything else kept as it was written."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from epg.diagnostics import Diagnostics
from epg.load.models.model import Model
from epg.load.yaml_file import parse_yaml
from epg.resolve.matching import Match
from epg.source import Node


@dataclass(frozen=True)
class Change:
    """An updated file: ports the model has gained or lost since, and those that wait for the user."""

    text: str
    added: tuple[str, ...]
    removed: tuple[str, ...]
    open: tuple[str, ...]


def new_bindings(model: Model, matches: Mapping[str, Match]) -> str:
    """A bindings file for ``model``; ports without a match stand in it as comments that name the candidates."""
    lines = ["version: 1", f"model: {_scalar(model.name)}"]
    for section, ports in (("inputs", model.inputs), ("outputs", model.outputs)):
        if ports:
            is_empty = all(matches[port.name].reference is None for port in ports)
            lines.append(f"# {section}:    # remove this '#' with the first below it" if is_empty else f"{section}:")
            lines += [_line(matches[port.name]) for port in ports]
    return "\n".join(lines) + "\n"


def updated_bindings(
    text: str, file: str, model: Model, matches: Mapping[str, Match], diagnostics: Diagnostics
) -> Change | None:
    """``text`` with lines for new ports and with removed ports commented out."""
    root = parse_yaml(text, file, diagnostics)
    if root is None or not root.is_mapping:
        return None
    end = "\r\n" if "\r\n" in text else "\n"
    lines = text.splitlines()
    added: list[str] = []
    removed: list[str] = []
    left: list[str] = []
    # from the bottom up, so that positions above stay true
    sections = [("inputs", model.inputs), ("outputs", model.outputs)]
    sections.sort(key=lambda entry: root.key_span(entry[0]).line if entry[0] in root else 1 << 30, reverse=True)
    for section, ports in sections:
        names = [port.name for port in ports]
        node = root.get(section)
        written = [key for key, _ in node.items()] if node is not None else []
        gone = [key for key in written if key not in names]
        new = [name for name in names if name not in written]
        added += [name for name in new if matches[name].reference]
        left += [name for name in new if not matches[name].reference]
        removed += gone
        new_lines = [_line(matches[name]) for name in new if not _mentioned(lines, _line(matches[name]))]
        if node is None:
            if new_lines:
                lines += [f"{section}:", *new_lines]
        elif node.is_mapping and written and node.key_span(written[0]).line == root.key_span(section).line:
            _rewrite_flow(lines, root, section, node, gone, new_lines)
        else:
            _edit_block(lines, root, section, node, gone, new_lines)
    changed = end.join(lines) + (end if text.endswith(("\n", "\r")) or lines else "")
    return Change(changed, tuple(added), tuple(removed), tuple(left))


def _edit_block(lines: list[str], root: Node, section: str, node: Node, gone: list[str], new: list[str]) -> None:
    """Edits a section with one port per line."""
    keys = [(key, node.key_span(key)) for key, _ in node.items()]
    start = root.key_span(section).line
    last = start
    for index, (key, span) in enumerate(keys):
        until = keys[index + 1][1].line - 1 if index + 1 < len(keys) else _block_end(lines, span.line, span.column)
        while until > span.line and re.match(r"\s*(#.*)?$", lines[until - 1]):
            until -= 1
        last = max(last, until)
        if key in gone:
            for number in range(span.line - 1, until):
                blanks = re.match(r"\s*", lines[number])
                depth = min(len(blanks[0]) if blanks else 0, span.column - 1)
                lines[number] = f"{lines[number][:depth]}# {lines[number][depth:]}" + (
                    "   # no longer a port of the model" if number == span.line - 1 else ""
                )
    depth = keys[0][1].column - 1 if keys else 2
    lines[last:last] = [" " * depth + line.lstrip() for line in new]


def _block_end(lines: list[str], line: int, column: int) -> int:
    """The last line of the entry that begins at ``line``: lines that are indented deeper belong to it."""
    until = line
    while until < len(lines):
        text = lines[until]
        if text.strip() and len(text) - len(text.lstrip()) < column:
            break
        until += 1
    return until


def _rewrite_flow(lines: list[str], root: Node, section: str, node: Node, gone: list[str], new: list[str]) -> None:
    """Turns ``inputs: {a: b}`` into one port per line when it has to change."""
    if not gone and not new:
        return
    first = root.key_span(section).line - 1
    following = [root.key_span(key).line for key, _ in root.items() if root.key_span(key).line > first + 1]
    last = min(following, default=len(lines) + 1) - 1
    while last > first + 1 and re.match(r"\s*(#.*)?$", lines[last - 1]):
        last -= 1
    kept = []
    for key, value in node.items():
        mark = "# " if key in gone else ""
        note = "   # no longer a port of the model" if key in gone else ""
        kept.append(f"  {mark}{_scalar(key)}: {_flow(value)}{note}")
    lines[first:last] = [f"{section}:", *kept, *new]


def _flow(node: Node) -> str:
    if node.is_mapping:
        return "{" + ", ".join(f"{_scalar(key)}: {_flow(child)}" for key, child in node.items()) + "}"
    if node.is_sequence:
        return "[" + ", ".join(_flow(child) for child in node.elements()) + "]"
    return _scalar(node.value)


def _line(match: Match) -> str:
    name = _scalar(match.port.name)
    if match.reference:
        return f"  {name}: {match.reference}"
    possible = ", ".join(match.candidates) if match.candidates else "nothing"
    return f"  # {name}:    # no name matches; possible: {possible}"


def _mentioned(lines: list[str], line: str) -> bool:
    """True if an earlier run has left the same comment already."""
    words = line.strip()
    return words.startswith("#") and any(words.split(":")[0] == other.strip().split(":")[0] for other in lines)


def _scalar(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if value is None:
        return "null"
    if isinstance(value, (int, float)):
        return repr(value)
    text = str(value)
    if re.fullmatch(r"[A-Za-z_][A-Za-z0-9_.]*", text) and text.casefold() not in (
        "true",
        "false",
        "null",
        "yes",
        "no",
        "on",
        "off",
        "y",
        "n",
    ):
        return text
    return "'" + text.replace("'", "''") + "'"
