"""Text of generated files: each output language has its own escaping, and unescaped text is an error.

A template may print numbers and :class:`Code`; anything else raises, so that no text of a user can reach generated
code by accident.  Filters make code of values: ``|cstring``, ``|comment``, ``|identifier``, ``|double``, ``|bool``,
``|cmake``.
"""

from __future__ import annotations

import math
import re
from fractions import Fraction
from pathlib import Path

import jinja2
from markupsafe import Markup

from epg.check.names import identifier_problem


class Code(Markup):
    """Text that is code already."""


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


def double(value: object) -> Code:
    """A C literal with exactly the value of the nearest double; infinite and NaN are bugs."""
    if isinstance(value, bool) or not isinstance(value, (int, float, Fraction)):
        raise TypeError(f"{value!r} is no number")
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(f"{number} cannot be written as a literal")
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


def cmake(text: object) -> Code:
    """A CMake bracket-free quoted argument."""
    value = str(text)
    if "\0" in value:
        raise ValueError("NUL in a CMake argument")
    escaped = value.replace("\\", "\\\\").replace('"', '\\"').replace("$", "\\$").replace(";", "\\;")
    return Code('"' + escaped.replace("\n", "\\n").replace("\r", "\\r") + '"')


def _only_code(value: object) -> object:
    if isinstance(value, Markup) or (isinstance(value, int) and not isinstance(value, bool)):
        return value
    raise TypeError(f"a template printed {value!r} ({type(value).__name__}) without a filter")


def environment(folders: list[Path]) -> jinja2.Environment:
    """A Jinja environment for C and CMake with the filters of this module; undefined names are errors."""
    env = jinja2.Environment(
        loader=jinja2.FileSystemLoader([str(folder) for folder in folders]),
        undefined=jinja2.StrictUndefined,
        autoescape=True,
        finalize=_only_code,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        extensions=["jinja2.ext.do"],
    )
    env.filters.update(
        cstring=cstring,
        comment=comment,
        identifier=identifier,
        double=double,
        bool=boolean,
        ns=nanoseconds,
        cmake=cmake,
    )
    env.globals["pi"] = math.pi
    return env
