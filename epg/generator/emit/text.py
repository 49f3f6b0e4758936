# SPDX-License-Identifier: Apache-2.0
"""Text of generated files.  Each output language has its own escaping, and unescaped text is an error.

A template can print two things: whole numbers, and values that a filter has made code of the template's language.
The filters for C are ``|cstring``, ``|comment``, ``|identifier``, ``|include``, ``|double``, ``|bool`` and ``|ns``.
Printing anything else raises an error.  Text of the user therefore cannot reach generated code without escaping, and
text that is escaped for one language cannot reach a file of another language.

Expressions of Jinja that would avoid these checks are refused when a template is read
(:mod:`epg.generator.emit.template`).
"""

from __future__ import annotations

import math
import re
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from epg.generator.check.names import identifier_problem

if TYPE_CHECKING:
    from typing_extensions import Self


class Escaped(Markup):
    """Text that is code of an output language.  Joining any other text to it raises TypeError."""

    @classmethod
    def escape(cls, text: Any) -> Self:  # Markup calls this for the other operand of +, %, join() and format()
        """Returns ``text`` if it is code of this language or an ``int``.  Raises TypeError for any other value.

        Markup itself would escape such text for HTML: ``&`` would become ``&amp;``.
        """
        if isinstance(text, cls):
            return text
        if type(text) is int:
            return cls(text)
        raise TypeError(f"{text!r} ({type(text).__name__}) was joined to {cls.__name__} without a filter")

    def __radd__(self, other: Any) -> Any:
        return type(self)(str.__add__(self.escape(other), self))


class Code(Escaped):
    """Text of C or C++."""


class CMakeCode(Escaped):
    """Text of CMake."""


class DevicetreeCode(Escaped):
    """Text of devicetree source."""


class KconfigCode(Escaped):
    """Text of a Kconfig fragment."""


class ProjectText(Escaped):
    """Text of a file of a new project: CMake, YAML, JSON or Markdown.  Each of them has its filters."""


class NotFinite(ArithmeticError, ValueError):
    """A number for which C has no literal: infinite or NaN."""


def cstring(text: object) -> Code:
    """A C string literal: ``a"b`` becomes ``"a\\"b"``.

    Each byte of the UTF-8 text that is not printable ASCII becomes an octal escape.
    """
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
    """Text for a C comment, on one line of printable characters.  It cannot end the comment or continue the line."""
    line = "".join(char if char.isprintable() else " " for char in str(text))
    line = re.sub(r"\*(?=/)", "* ", line)
    line = re.sub(r"/(?=\*)", "/ ", line)
    line = re.sub(r"\?\?(?=.)", "? ?", line)
    return Code(line.rstrip("\\*/ ") if line.rstrip().endswith(("\\", "*", "/")) else line)


def identifier(text: object) -> Code:
    """A C identifier.  Raises ValueError for other text; that is a bug in EPG, because names are checked before."""
    name = str(text)
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name):
        raise ValueError(f"{name!r} {identifier_problem(name)}")
    return Code(name)


def include(name: object) -> Code:
    """The name between the brackets of ``#include <...>``.  Raises ValueError if C does not allow the name there."""
    text = str(name)
    if not text or not text.isprintable() or re.search(r'[<>"\\]|//|/\*', text):
        raise ValueError(f"{text!r} cannot be included")
    return Code(text)


def double(value: object) -> Code:
    """A C literal whose value is exactly the double nearest to ``value``.  Raises NotFinite for infinite and NaN."""
    if isinstance(value, bool) or not isinstance(value, (int, float, Fraction)):
        raise TypeError(f"{value!r} is not a number")
    number = float(value)
    if not math.isfinite(number):
        raise NotFinite(f"{number} cannot be written as a literal")
    text = repr(number)
    if "." not in text and "e" not in text:
        text += ".0"
    return Code(text)


def boolean(value: object) -> Code:
    """The C literal ``true`` or ``false``."""
    return Code("true" if value else "false")


def nanoseconds(value: object) -> Code:
    """A time in seconds, as a C literal in nanoseconds, rounded to a whole number."""
    assert isinstance(value, (int, float, Fraction))
    return Code(f"{round(Fraction(value) * 1_000_000_000)}u")


def cmake(text: object) -> CMakeCode:
    """A quoted argument of a CMake command.  Raises ValueError for text with NUL."""
    value = str(text)
    if "\0" in value:
        raise ValueError("NUL in a CMake argument")
    escaped = value.replace("\\", "\\\\").replace('"', '\\"').replace("$", "\\$").replace(";", "\\;")
    return CMakeCode('"' + escaped.replace("\n", "\\n").replace("\r", "\\r") + '"')


def devicetree_string(text: object) -> DevicetreeCode:
    """The value of a string property.  Bytes of UTF-8 that dtc does not accept as they are become octal escapes.

    Raises ValueError for text with NUL.
    """
    if "\0" in str(text):
        raise ValueError("NUL in a devicetree string")
    return DevicetreeCode(str(cstring(text)).replace("\\?", "?"))


def kconfig_string(text: object) -> KconfigCode:
    """The quoted value of a string symbol.  It must be on one line: raises ValueError for text with a line end."""
    value = str(text)
    if not all(char.isprintable() for char in value):
        raise ValueError(f"{value!r} cannot be written on one line")
    return KconfigCode('"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"')


def kconfig_symbol(value: object) -> KconfigCode:
    """A part of the name of a symbol, in capital letters, digits and ``_``."""
    return KconfigCode(str(identifier(value)).upper())


def kconfig_bool(value: object) -> KconfigCode:
    """The value of a bool symbol: ``y`` or ``n``."""
    return KconfigCode("y" if value else "n")


def word(value: object) -> ProjectText:
    """A name or a version that does not need quotes in CMake, YAML, JSON or Markdown.  Raises ValueError otherwise."""
    name = str(value)
    if not re.fullmatch(r"[A-Za-z0-9_.+-]+", name):
        raise ValueError(f"{name!r} is not a word")
    return ProjectText(name)


def line(value: object) -> ProjectText:
    """Text for a comment or for prose, on one line of printable characters.

    Backquotes become blanks, because they would end inline code of Markdown.
    """
    return ProjectText("".join(char if char.isprintable() and char != "`" else " " for char in str(value)))
