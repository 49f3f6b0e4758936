# SPDX-License-Identifier: Apache-2.0
"""Random bindings files in every style of users, with comments that show to which line they belong.

A comment is ``#17``, each with its own number, so that a test can check which comments remain, and their order.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import yaml
from hypothesis import strategies as st

from epg.edit.bindings import WireEnd
from epg.edit.scalars import scalar_text
from epg.edit.section import open_port, open_section

PORTS = {
    "inputs": ("angle", "Pan\\PID.u", "on", "x y", "set: point"),
    "outputs": ("duty", "log", "it's", "größe", "{}"),
}
TAB = ["\t"] if yaml.__with_libyaml__ else []
"""A tab before a comment, which PyYAML's own parser does not allow."""
KEY = {"inputs": "from", "outputs": "to"}

references = st.sampled_from(["encoder", "motor", "motor.duty", "joint_states.pan.position", "lamp", "a"])
numbers = st.sampled_from(["1", "-2", "0.5", "1e-3", ".25", "0x10"])
ends = st.builds(
    WireEnd,
    references,
    st.sampled_from(["", "", "2", "-0.5", "1/4", "361/5625"]),
    st.just("") | numbers,
    st.none() | st.tuples(numbers, numbers),
    st.sampled_from(["", "", "rad", "rad/s", "%", "1", "N m"]),
)
"""Ends with conversions.  Limits may be in the wrong order, because that does not matter for the text."""


@dataclass
class Line:
    """``owner``: the port whose value is on this line, or the section that begins here or is this line, or empty."""

    text: str
    owner: str = ""


@dataclass
class Text:
    """A file, its lines, and its meaning: section -> port -> ends."""

    lines: list[Line]
    said: dict[str, dict[str, tuple[WireEnd, ...]]]
    line_end: str
    has_last_end: bool
    in_braces: set[str] = field(default_factory=set)
    open: set[str] = field(default_factory=set)

    @property
    def text(self) -> str:
        body = self.line_end.join(line.text for line in self.lines)
        return body + (self.line_end if self.has_last_end else "")


class Writer:
    def __init__(self, draw: st.DrawFn) -> None:
        self.draw = draw
        self.lines: list[Line] = []
        self.comments = 0

    def chance(self, one_in: int = 3) -> bool:
        return self.draw(st.integers(1, one_in)) == one_in  # the simplest result is no

    def comment(self) -> str:
        """A comment after a value; most values have none."""
        if not self.chance(4):
            return ""
        self.comments += 1
        return self.draw(st.sampled_from([" ", "   ", *TAB])) + f"#{self.comments}: {{not}} [a] 'value',"

    def between(self, indent: int, owner: str = "") -> None:
        """Lines without content: empty ones and comments."""
        while self.chance(5):
            self.comments += 1
            self.lines.append(
                Line(self.draw(st.sampled_from(["", "  ", " " * indent + f"#{self.comments} - a: b"])), owner)
            )

    def text(self, value: str) -> str:
        return scalar_text(value, self.draw(st.sampled_from(["", "", "'", '"'])))

    def parts(self, end: WireEnd, key: str) -> list[tuple[str, str]]:
        parts = [(key, self.text(end.reference))]
        parts += [(name, getattr(end, name)) for name in ("scale", "offset") if getattr(end, name)]
        if end.limits:
            parts.append(("limits", "[" + self.draw(st.sampled_from([", ", ",", " , "])).join(end.limits) + "]"))
        if end.unit:
            parts.append(("unit", self.text(end.unit)))
        return self.draw(st.permutations(parts)) if self.chance() else parts

    def flow(self, end: WireEnd, key: str) -> str:
        """An end on one line."""
        parts = self.parts(end, key)
        if len(parts) == 1 and not self.chance(4):
            return parts[0][1]
        blank = self.draw(st.sampled_from(["", "", " "]))
        last = self.draw(st.sampled_from(["", "", "", ",", " , "]))
        return "{" + blank + ", ".join(f"{name}: {value}" for name, value in parts) + last + blank + "}"

    def flow_value(self, ends: tuple[WireEnd, ...], section: str) -> str:
        if not ends:
            return self.draw(st.sampled_from(["unconnected", "'unconnected'", "[unconnected]"]))
        texts = [self.flow(end, KEY[section]) for end in ends]
        if len(texts) == 1 and (section == "inputs" or not self.chance(4)):
            return texts[0]
        if self.chance(8):
            texts.append("unconnected")
        return "[" + ", ".join(texts) + self.draw(st.sampled_from(["", "", ",", " "])) + "]"

    def braces(self, head: str, parts: list[str], indent: int, owner: str, marks: str = "{}") -> None:
        """``head {part, part}`` over several lines."""
        self.lines.append(Line(f"{head} {marks[0]}{self.comment()}", owner))
        for index, part in enumerate(parts):
            self.between(indent, owner)
            comma = "," if index + 1 < len(parts) or self.chance() else ""
            self.lines.append(Line(" " * (indent + 2) + part + comma + self.comment(), owner))
        self.between(indent, owner)
        self.lines.append(Line(" " * indent + marks[1] + self.comment(), owner))

    def map(self, first: str, end: WireEnd, key: str, indent: int, owner: str) -> None:
        """A mapping in block style."""
        for index, (name, value) in enumerate(self.parts(end, key)):
            if index:
                self.between(indent, owner)
            before = first if index == 0 else " " * indent
            if name == "limits" and self.chance() and end.limits:
                self.lines.append(Line(f"{before}{name}:{self.comment()}", owner))
                self.lines += [Line(f"{' ' * indent}  - {number}{self.comment()}", owner) for number in end.limits]
            else:
                self.lines.append(Line(f"{before}{name}: {value}{self.comment()}", owner))

    def port(self, name: str, ends: tuple[WireEnd, ...], section: str, indent: int, list_indent: int) -> None:
        head = " " * indent + self.text(name) + self.draw(st.sampled_from(["", "", " "])) + ":"
        style = self.draw(st.integers(0, 5))
        if style > 2 or not ends:
            self.lines.append(Line(f"{head} {self.flow_value(ends, section)}{self.comment()}", name))
        elif len(ends) == 1 and style == 0:
            self.braces(head, [f"{key}: {value}" for key, value in self.parts(ends[0], KEY[section])], indent, name)
        elif section == "outputs" and style == 1:
            self.braces(head, [self.flow(end, "to") for end in ends], indent, name, "[]")
        elif len(ends) == 1 and (section == "inputs" or self.chance()):
            self.lines.append(Line(head + self.comment(), name))
            self.between(indent + 2, name)
            self.map(" " * (indent + 2), ends[0], KEY[section], indent + 2, name)
        else:
            self.lines.append(Line(head + self.comment(), name))
            dash = indent + list_indent
            for end in ends:
                self.between(dash, name)
                if self.chance(2):
                    self.map(" " * dash + "- ", end, "to", dash + 2, name)
                else:
                    self.lines.append(Line(f"{' ' * dash}- {self.flow(end, 'to')}{self.comment()}", name))

    def section(self, section: str, result: Text, base: int) -> None:
        style = self.draw(st.sampled_from(["block"] * 6 + ["braces", "long braces", "empty", "open", "missing"]))
        least = self.draw(st.integers(0, 3))
        names = self.draw(st.lists(st.sampled_from(PORTS[section]), min_size=least, unique=True))
        if not names and style not in ("open", "missing"):
            style = "empty"
        several = st.lists(ends, max_size=3, unique_by=lambda end: end.reference).map(tuple)
        one = ends.map(lambda end: (end,))
        said = {name: self.draw(one if section == "inputs" else several) for name in names}
        said = {} if style in ("empty", "open", "missing") else said
        result.said[section] = said
        blanks = " " * base
        indent = base + self.draw(st.sampled_from([2, 2, 2, 1, 4]))
        if style == "missing":
            return
        if style == "open":
            self.lines.append(Line(blanks + open_section(section), section))
            result.open.add(section)
        elif style == "empty":
            self.lines.append(Line(f"{blanks}{section}: {{}}{self.comment()}", section))
        elif style == "braces":
            result.in_braces.add(section)
            inside = ", ".join(f"{self.text(name)}: {self.flow_value(said[name], section)}" for name in said)
            self.lines.append(Line(f"{blanks}{section}: {{{inside}}}{self.comment()}", section))
        elif style == "long braces":
            result.in_braces.add(section)
            parts = [f"{self.text(name)}: {self.flow_value(said[name], section)}" for name in said]
            self.braces(f"{blanks}{section}:", parts, base, section)
        if style == "block":
            self.lines.append(Line(f"{blanks}{section}:{self.comment()}", section))
        if style in ("braces", "long braces"):
            return
        list_indent = self.draw(st.sampled_from([0, 2]))
        left = [name for name in PORTS[section] if name not in said and (style == "open" or self.chance())]
        for name in [*said, *left] if style != "block" or not self.chance() else [*said]:
            self.between(indent)
            if name in said:
                self.port(name, said[name], section, indent, list_indent)
            else:
                self.lines.append(Line(" " * indent + open_port(name, ("a", "b.c")), name))
                result.open.add(name)


@st.composite
def bindings_texts(draw: st.DrawFn) -> Text:
    """A bindings file of a model with :data:`PORTS`."""
    writer = Writer(draw)
    result = Text([], {}, draw(st.sampled_from(["\n", "\n", "\r\n"])), draw(st.booleans()))
    base = draw(st.sampled_from([0, 0, 0, 0, 2]))
    writer.between(0)
    parts = ["version", "model", "inputs", "outputs", "parameters"]
    for part in draw(st.permutations(parts)) if writer.chance(4) else parts:
        writer.between(base)
        if part in PORTS:
            writer.section(part, result, base)
        elif part == "parameters":
            if writer.chance():
                writer.lines.append(Line(" " * base + "parameters: {Pan\\PID\\kp: 2.60, b: .5}" + writer.comment()))
        else:
            value = {"version": "1", "model": "Servo"}[part]
            writer.lines.append(Line(f"{' ' * base}{part}: {value}{writer.comment()}"))
    writer.between(base)
    result.lines = writer.lines
    return result
