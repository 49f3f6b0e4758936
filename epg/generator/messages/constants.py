# SPDX-License-Identifier: Apache-2.0
"""Constants of messages: values that users write for fields, and default values in definitions."""

from __future__ import annotations

import math
import struct
from typing import Union

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.messages.definition import Field, Message
from epg.generator.source import Span

Value = Union[bool, int, float, str, "tuple[Constant, ...]"]

_BITS = {"int8": 8, "int16": 16, "int32": 32, "int64": 64}
RANGES = {
    "bool": (0, 1),
    "byte": (0, 255),
    "char": (0, 255),
    **{name: (-(1 << (bits - 1)), (1 << (bits - 1)) - 1) for name, bits in _BITS.items()},
    **{f"u{name}": (0, (1 << bits) - 1) for name, bits in _BITS.items()},
}
"""The smallest and the largest value of each type of whole numbers."""


@dataclass(frozen=True)
class Constant:
    """A value for a field, with its position and that of its key."""

    value: Value
    span: Span
    key: Span


def default_of(field: Field) -> Constant | None:
    """The default value that the definition gives to a field: ``float64 w 1``.  None without one."""
    if not field.default:
        return None
    return Constant(_parsed(field.default, field.span), field.span, field.span)


def number_of(type_: str, constant: Constant, message: Message, diagnostics: Diagnostics) -> float:
    """The number for a field of a type.  A text can name a constant of the message.  Reports a wrong value."""
    value = constant.value
    if isinstance(value, str):
        if value not in message.constants:
            names = ", ".join(sorted(message.constants))
            hint = f"constants of {message.name}: {names}" if names else ""
            diagnostics.error("message-constant", constant.span, f"'{value}' is not a number", hint=hint)
            return 0
        value = _parsed(message.constants[value], constant.span)
    if isinstance(value, (str, tuple)):
        diagnostics.error("message-constant", constant.span, "this must be a number")
        return 0
    if type_ not in RANGES:
        if type_ == "float32" and math.isfinite(value) and abs(value) > struct.unpack("<f", b"\xff\xff\x7f\x7f")[0]:
            diagnostics.error("message-constant", constant.span, f"{value} does not fit into a float32")
            return 0
        return float(value)
    low, high = RANGES[type_]
    if not math.isfinite(value) or value != int(value) or not low <= value <= high:
        article = "an" if type_[0] == "i" else "a"
        diagnostics.error("message-constant", constant.span, f"{value} is not {article} {type_}: {low} ... {high}")
        return 0
    return int(value)


def _parsed(text: str, span: Span) -> Value:
    """The value of a text in a definition: a number, ``true``, a text with or without quotes, or a list of them."""
    text = text.strip()
    if text.startswith("[") and text.endswith("]"):
        parts = [part for part in text[1:-1].split(",") if part.strip()]
        return tuple(Constant(_parsed(part, span), span, span) for part in parts)
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text[1:-1] if len(text) > 1 and text[0] == text[-1] and text[0] in "\"'" else text
