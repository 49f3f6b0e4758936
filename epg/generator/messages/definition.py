# SPDX-License-Identifier: Apache-2.0
"""Reads the text of a ``.msg`` file.

The grammar is that of rosidl (rosidl_adapter/parser.py): one field or constant per line, ``<type> <name> [default]`` or
``<type> <NAME>=<value>``.  A type can be an array ``[N]``, a bounded sequence ``[<=N]`` or a sequence ``[]``; a string
can be bounded: ``string<=N``.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.source import Span

PRIMITIVES = (
    "bool",
    "byte",
    "char",
    "float32",
    "float64",
    "int8",
    "uint8",
    "int16",
    "uint16",
    "int32",
    "uint32",
    "int64",
    "uint64",
    "string",
    "wstring",
)

_LARGEST = 1 << 20  # the largest bound of an array or string; keeps hostile files from costing memory

_TYPE = r"(?P<base>[A-Za-z][A-Za-z0-9_/]*)(?:<=(?P<bound>\d+))?(?:\[(?P<array>(?:<=)?\d*)\])?"
_NAME = r"[a-z](?:_?[a-z0-9]+)*"
_CONSTANT = r"[A-Z](?:_?[A-Z0-9]+)*"
_NESTED = r"(?:[a-z][a-z0-9_]*/)?(?:msg/)?[A-Z][A-Za-z0-9]*|[a-z][a-z0-9_]*/msg/[A-Z][A-Za-z0-9]*"


@dataclass(frozen=True)
class FieldType:
    """The type of a field.

    ``base`` is a primitive type, or the full name of a message: ``geometry_msgs/msg/Vector3``.  ``string_bound`` is the
    largest length of a bounded string, otherwise 0.  ``form`` is "one", "array" (``count`` elements), "bounded" (at
    most ``count`` elements) or "sequence".
    """

    base: str
    string_bound: int = 0
    form: str = "one"
    count: int = 0

    @property
    def is_message(self) -> bool:
        return "/" in self.base


@dataclass(frozen=True)
class Field:
    """A field of a message.  ``default`` is the text of its default value, or empty."""

    name: str
    type: FieldType
    default: str
    span: Span


@dataclass(frozen=True)
class Message:
    """The definition of a message.  ``name`` is its full name: ``sensor_msgs/msg/Imu``."""

    name: str
    fields: tuple[Field, ...]
    constants: Mapping[str, str]  # name -> text of the value
    text: str
    path: Path

    @property
    def dependencies(self) -> tuple[str, ...]:
        """The names of the messages that this one names, in alphabetical order."""
        return tuple(sorted({field.type.base for field in self.fields if field.type.is_message}))


def parse_message(name: str, text: str, path: Path, diagnostics: Diagnostics) -> Message | None:
    """The message ``name`` with the definition ``text`` of the file ``path``.  None after reporting all mistakes."""
    before = diagnostics.error_count
    package = name.partition("/")[0]
    fields: dict[str, Field] = {}
    constants: dict[str, str] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        member = _line(line, package, str(path), number, constants, diagnostics)
        if member is None:
            continue
        if member.name in fields:
            diagnostics.error("message-definition", member.span, f"the message already has a field '{member.name}'")
        fields[member.name] = member
    return Message(name, tuple(fields.values()), constants, text, path) if diagnostics.error_count == before else None


def _line(
    line: str, package: str, file: str, number: int, constants: dict[str, str], diagnostics: Diagnostics
) -> Field | None:
    """The field of a line.  None for an empty line, a constant, which is added, or a mistake, which is reported."""
    code = _without_comment(line).rstrip()
    start = len(code) - len(code.lstrip())
    if not code.strip():
        return None
    type_text, _, rest = code[start:].partition(" ")
    at = Span(file, number, start + 1, start + len(type_text) + 1)
    type_ = _type(type_text, package, at, diagnostics)
    if type_ is None:
        return None
    rest_start = len(code) - len(rest.lstrip())
    rest = rest.lstrip()
    name = re.match(r"[^\s=]*", rest)
    assert name is not None
    after = rest[name.end() :].lstrip()
    span = Span(file, number, rest_start + 1, rest_start + len(name[0]) + 1)
    if not name[0]:
        diagnostics.error("message-definition", at, "the name of the field is missing", hint="<type> <name>")
        return None
    if after.startswith("="):
        if not re.fullmatch(_CONSTANT, name[0]):
            hint = "capital letters, digits and single underscores, for example MAX_SPEED"
            diagnostics.error("message-definition", span, f"'{name[0]}' cannot be the name of a constant", hint=hint)
        constants[name[0]] = after[1:].strip()
        if type_.base == "bool" and constants[name[0]].lower() not in ("true", "false", "1", "0"):
            place = Span(file, number, code.index("=", rest_start) + 1, len(code) + 1)
            message = f"'{constants[name[0]]}' is not a value of a bool: true or false"
            diagnostics.error("message-definition", place, message)
        return None
    if not re.fullmatch(_NAME, name[0]):
        hint = "small letters, digits and single underscores, for example max_speed"
        if re.fullmatch(_CONSTANT, name[0]):
            hint = f"write a constant with '=': {name[0]}=<value>"
        diagnostics.error("message-definition", span, f"'{name[0]}' cannot be the name of a field", hint=hint)
        return None
    return Field(name[0], type_, after, span)


def _type(text: str, package: str, span: Span, diagnostics: Diagnostics) -> FieldType | None:
    match = re.fullmatch(_TYPE, text)
    if match is None:
        hint = "for example float64, float64[3], string or geometry_msgs/Vector3"
        diagnostics.error("message-definition", span, f"'{text}' is not a type of ROS 2", hint=hint)
        return None
    bound = match["bound"]
    base = _base(match["base"], package, span, diagnostics)
    if base is None:
        return None
    if bound is not None and base not in ("string", "wstring"):
        diagnostics.error("message-definition", span, "only strings can have a bound: string<=20")
        return None
    form = _form(match["array"])
    count = int((match["array"] or "").lstrip("<=")[:9] or 0)
    length = int((bound or "")[:9] or 0)
    if (form in ("array", "bounded") and not 1 <= count <= _LARGEST) or (bound and not 1 <= length <= _LARGEST):
        diagnostics.error("message-definition", span, f"a length must be from 1 to {_LARGEST}")
        return None
    return FieldType(base, length, form, count)


def _base(text: str, package: str, span: Span, diagnostics: Diagnostics) -> str | None:
    """A primitive type, or the full name of a message.  None, after an error, if ``text`` is neither."""
    if text in PRIMITIVES:
        return text
    if not re.fullmatch(_NESTED, text):
        hint = did_you_mean(text, PRIMITIVES)
        diagnostics.error("message-definition", span, f"'{text}' is not a type of ROS 2", hint=hint)
        return None
    parts = text.split("/")
    return f"{parts[0] if len(parts) > 1 else package}/msg/{parts[-1]}"


def _form(array: str | None) -> str:
    """The form of a field from the text in its brackets: None, ``""``, ``3`` or ``<=3``."""
    if array is None:
        return "one"
    if not array:
        return "sequence"
    return "bounded" if array[0] == "<" else "array"


def _without_comment(line: str) -> str:
    """The line up to its comment.  A ``#`` inside quotes does not begin one."""
    quote = ""
    for at, char in enumerate(line):
        if quote:
            quote = "" if char == quote else quote
        elif char in "\"'" and line[:at].strip():
            quote = char
        elif char == "#":
            return line[:at]
    return line
