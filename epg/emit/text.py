# SPDX-License-Identifier: Apache-2.0
"""Text of generated files: each output language has its own escaping, and unescaped text is an error.

A template may print numbers and text that is code of its language already, by a filter: ``|cstring``, ``|comment``,
``|identifier``, ``|double``, ``|bool``, ``|ns`` make C of values.  Anything else raises, so that no text of a user can
reach generated code by accident, and no escaping of one language can stand in another.  What would let text pass
unseen is refused when a template is read (:mod:`epg.emit.template`).
"""

from __future__ import annotations

import math
import re
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from epg.check.names import identifier_problem

if TYPE_CHECKING:
    from typing_extensions import Self


class Escaped(Markup):
    """Text of an output language.  Text that is none cannot be joined to it."""

    @classmethod
    def escape(cls, text: Any) -> Self:  # what Markup does to the other operand of +, %, join() and format()
        """``text`` if it is of this language; raises TypeError (Markup would turn ``&`` into ``&amp;``)."""
        if isinstance(text, cls):
            return text
        if type(text) is int:
            return cls(text)
        raise TypeError(f"{text!r} ({type(text).__name__}) was joined to {cls.__name__} without a filter")

    def __radd__(self, other: Any) -> Any:
        return type(self)(str.__add__(self.escape(other), self))


class Code(Escaped):
    """C or C++."""


class CMakeCode(Escaped):
    """CMake."""


class DevicetreeCode(Escaped):
    """Devicetree source."""


class KconfigCode(Escaped):
    """A Kconfig fragment."""


class ProjectText(Escaped):
    """A file of a new project: CMake, YAML, JSON or Markdown, with a filter for each."""


class NotFinite(ArithmeticError, ValueError):
    """A number that no literal of C has: infinite or NaN."""


def cstring(text: object) -> Code:
    """A C string literal: ``a"b`` becomes ``"a\\"b"``; everything but printable ASCII as octal escapes of its UTF-8."""
    out = []
    for byte in str(text).encode("utf-8"):
        char = chr(byte)
        if char in '"\\?':
            out.append("\\" + char)
        elif 32 <= byte < 127:
            out.append(char)
        else:
            out.append(f"\\{byte:03o}")
    return Code('"' + "".join(out) + '"')


def comment(text: object) -> Code:
    """Text inside a C comment: one line, printable, unable to end the comment or continue the line."""
    line = "".join(char if char.isprintable() else " " for char in str(text))
    line = re.sub(r"\*(?=/)", "* ", line)
    line = re.sub(r"/(?=\*)", "/ ", line)
    line = re.sub(r"\?\?(?=.)", "? ?", line)
    return Code(line.rstrip("\\*/ ") if line.rstrip().endswith(("\\", "*", "/")) else line)


def identifier(text: object) -> Code:
    """A C identifier; anything else is a bug in EPG, as names are checked before."""
    name = str(text)
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name):
        raise ValueError(f"{name!r} {identifier_problem(name)}")
    return Code(name)


def include(name: object) -> Code:
    """The name between the brackets of ``#include <...>``; one that cannot stand there is an error."""
    text = str(name)
    if not text or not text.isprintable() or re.search(r'[<>"\\]|//|/\*', text):
        raise ValueError(f"{text!r} cannot be included")
    return Code(text)


def double(value: object) -> Code:
    """A C literal with exactly the value of the nearest double; infinite and NaN are bugs."""
    if isinstance(value, bool) or not isinstance(value, (int, float, Fraction)):
        raise TypeError(f"{value!r} is no number")
    number = float(value)
    if not math.isfinite(number):
        raise NotFinite(f"{number} cannot be written as a literal")
    text = repr(number)
    if "." not in text and "e" not in text:
        text += ".0"
    return Code(text)


def boolean(value: object) -> Code:
    return Code("true" if value else "false")


def nanoseconds(value: object) -> Code:
    """A time in seconds as a C literal in whole nanoseconds."""
    assert isinstance(value, (int, float, Fraction))
    return Code(f"{round(Fraction(value) * 1_000_000_000)}u")


def cmake(text: object) -> CMakeCode:
    """A quoted argument of CMake."""
    value = str(text)
    if "\0" in value:
        raise ValueError("NUL in a CMake argument")
    escaped = value.replace("\\", "\\\\").replace('"', '\\"').replace("$", "\\$").replace(";", "\\;")
    return CMakeCode('"' + escaped.replace("\n", "\\n").replace("\r", "\\r") + '"')


def devicetree_string(text: object) -> DevicetreeCode:
    """A string property's value; what dtc does not take as it is becomes an octal escape of its UTF-8."""
    if "\0" in str(text):
        raise ValueError("NUL in a devicetree string")
    return DevicetreeCode(str(cstring(text)).replace("\\?", "?"))


def kconfig_string(text: object) -> KconfigCode:
    """The value of a string symbol, which ends with its line."""
    value = str(text)
    if not all(char.isprintable() for char in value):
        raise ValueError(f"{value!r} cannot stand on one line")
    return KconfigCode('"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"')


def kconfig_symbol(value: object) -> KconfigCode:
    """Part of a symbol's name: capital letters, digits and ``_``."""
    return KconfigCode(str(identifier(value)).upper())


def kconfig_bool(value: object) -> KconfigCode:
    return KconfigCode("y" if value else "n")


def word(value: object) -> ProjectText:
    """A name or version that needs no quotes in any language."""
    name = str(value)
    if not re.fullmatch(r"[A-Za-z0-9_.+-]+", name):
        raise ValueError(f"{name!r} is no word")
    return ProjectText(name)


def line(value: object) -> ProjectText:
    """Text in a comment or in prose: one line of printable characters, and none that ends a span of code."""
    return ProjectText("".join(char if char.isprintable() and char != "`" else " " for char in str(value)))
