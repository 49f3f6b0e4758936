# SPDX-License-Identifier: Apache-2.0
"""Finds the lines of exported code that hold the model's data: array elements with their names in 20-sim.

Examples are ``xx_V[7] = u[0];  /* in {rad} */`` and ``xx_P[1] = 2.6;  /* PID1\\kp {} */``.  These lines have the same
form in every target and version of 20-sim, also after the user renamed prefixes or reformatted the code.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from fractions import Fraction
from typing import TypeGuard

from epg.generator.dataclass import dataclass
from epg.generator.documents.source_file import STRING, SourceFile
from epg.generator.source import Span

# The search takes two steps, because a regular expression for a whole statement takes quadratic time if `;` is missing.
_STATEMENT_END = re.compile(r"[;{}]")
_ASSIGNMENT = re.compile(
    r"(?<![\w.>])((?:[A-Za-z_]\w{0,255}->)?[A-Za-z_]\w{0,255})\s{0,80}\[\s{0,80}(\d{1,9})\s{0,80}\]\s{0,80}=(?!=)\s*",
    re.ASCII,
)
_ELEMENT = re.compile(r"(?<![\w.>])([A-Za-z_]\w{0,255})\s{0,80}\[\s{0,80}(\d{1,9})\s{0,80}\]", re.ASCII)
_COMMENT = re.compile(r"[ \t]*(?:/\*(.*?)\*/|//(.*)$)", re.MULTILINE)
_NUMBER = re.compile(r"[-+]?\s*(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d{1,3})?", re.ASCII)
_LONGEST_NUMBER = 400
_LONGEST_LIST = 1 << 20
_LIST_END = re.compile(r"\bNULL\b|\}")


@dataclass(frozen=True)
class ArrayAssignment:
    """A line ``array[index] = value;  /* name {unit} */``.  ``name`` and ``unit`` are empty if there is no comment.

    ``start``, ``value_start`` and ``value_end`` are offsets into the text of the file.
    """

    array: str
    index: int
    value: str
    name: str
    unit: str
    start: int
    value_start: int
    value_end: int
    span: Span


@dataclass(frozen=True)
class PortLine:
    """A port.  ``array[array_index]`` holds its value; ``index`` is its position in the vector ``u`` or ``y``."""

    name: str
    unit: str
    index: int
    array: str
    array_index: int
    span: Span


def assignments(file: SourceFile, start: int = 0, end: int | None = None) -> Iterator[ArrayAssignment]:
    """All assignments to an array element with a literal index, in the order of the code."""
    code = file.code
    statement = start
    for mark in _STATEMENT_END.finditer(code, start, len(code) if end is None else end):
        match = _ASSIGNMENT.search(code, statement, mark.start()) if mark[0] == ";" else None
        statement = mark.end()
        if match is None:
            continue
        value_end = match.end() + len(code[match.end() : mark.start()].rstrip())
        comment = _COMMENT.match(file.text, mark.end())
        name, unit = split_name((comment[1] or comment[2] or "") if comment else "")
        yield ArrayAssignment(
            match[1],
            int(match[2]),
            file.text[match.end() : value_end],
            name,
            unit,
            match.start(),
            match.end(),
            value_end,
            file.span(match.start(), mark.end()),
        )


def port_lines(file: SourceFile, direction: str, vector: str, start: int = 0, end: int | None = None) -> list[PortLine]:
    """The lines ``array[i] = u[k];`` of inputs, or ``y[k] = array[i];`` of outputs.

    ``direction`` is "input" or "output".  ``vector`` is the name of ``u`` or ``y`` in the code.
    """
    is_output = direction == "output"
    result = []
    for line in assignments(file, start, end):
        elements = [match for match in _ELEMENT.finditer(line.value) if is_output or match[1] == vector]
        if len(elements) != 1 or (line.array == vector) != is_output:
            continue
        array, index = elements[0][1], int(elements[0][2])
        if is_output:
            result.append(PortLine(line.name, line.unit, line.index, array, index, line.span))
        else:
            result.append(PortLine(line.name, line.unit, index, line.array, line.index, line.span))
    return result


def split_name(comment: str) -> tuple[str, str]:
    """The name and the unit in a comment: ``PID1\\tauD {s}`` gives ``("PID1\\tauD", "s")``."""
    text = comment.strip()
    name, brace, unit = text[:-1].rpartition("{") if text.endswith("}") else ("", "", "")
    return (name.strip(), unit.strip()) if brace and "}" not in unit else (text, "")


def listed_names(file: SourceFile, kind: str) -> list[tuple[str, Span]]:
    """The names in the list ``xx_<kind>_names[]``, which exports contain inside a comment."""
    head = re.compile(rf"{kind}_names\w{{0,80}}\s{{0,80}}\[\s{{0,80}}\]\s{{0,80}}=\s{{0,80}}\{{", re.ASCII)
    for match in head.finditer(file.text):
        end = _LIST_END.search(file.text, match.end(), match.end() + _LONGEST_LIST)
        if end is None:
            break
        names = [
            (re.sub(r"\\(.)", r"\1", string[1]), file.span(string.start(), string.end()))
            for string in STRING.finditer(file.text, match.end(), end.start())
        ]
        if names:
            return names
    return []


def exact_number(text: str) -> Fraction | None:
    """The exact value of a literal, of a quotient such as ``1.0 / 1000.0``, or of a truth value.

    The text can contain a cast.  None for any other text.
    """
    text = text.strip()
    if len(text) > _LONGEST_NUMBER:
        return None
    text = re.sub(r"\(\s*(?:XX|YY)?[A-Za-z]\w*\s*\)", "", text)
    while text.startswith("(") and text.endswith(")"):
        text = text[1:-1].strip()
    if re.fullmatch(r"(?:\w*TRUE|true)", text):
        return Fraction(1)
    if re.fullmatch(r"(?:\w*FALSE|false)", text):
        return Fraction(0)
    numerator, slash, denominator = text.partition("/")
    value = _literal(numerator)
    if value is None or not slash:
        return value
    divisor = _literal(denominator)
    return value / divisor if divisor else None


def number(text: str) -> float | None:
    """The value of :func:`exact_number` as the nearest double, or None."""
    return finite(exact_number(text))


def finite(value: Fraction | None) -> float | None:
    """The nearest double.  None if ``value`` is None or larger than every double."""
    if value is None:
        return None
    try:
        return float(value)
    except OverflowError:
        return None


def is_step(value: Fraction | None) -> TypeGuard[Fraction]:
    """True if ``value``, in seconds, can be the step of a model: from 1 ns to 1000000 s.

    Such a step is a normal double.  As a control period, it is at least one whole nanosecond.
    """
    return value is not None and Fraction(1, 1_000_000_000) <= value <= 1_000_000


def _literal(text: str) -> Fraction | None:
    text = text.strip()
    if re.fullmatch(r".*[\d.][fFlL]", text):
        text = text[:-1]
    return Fraction(re.sub(r"\s", "", text)) if _NUMBER.fullmatch(text) else None
