# SPDX-License-Identifier: Apache-2.0
"""Mutations of a project's files: some use the structure of a file, some do not."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from hypothesis import strategies as st

ODD_SCALARS = (
    "0", "-1", "1", "1.5", "1e999", "-1e999", "1e-400", "1e300", ".inf", "-.inf", ".nan", "0x7fffffffffffffff",
    "0o17", "99999999999999999999999999999999999999999", "010", "null", "~", "true", "on", "yes", "''", '""', "[]",
    "{}", "[1, 2]", "{a: 1}", "1 ms", "0 ms", "-1 ms", "1e-30 s", "1e300 s", "0.1 us", "20 kHz", "1e-9 Hz",
    "1e300 Hz", "180 deg", "1 rad", "1e300 deg", "3.3 V", "5 m", "1/3", "1/0", "1e300/1e-300", "1e-300/1e300",
    "5625/361", "0 rad", "1 foot", "%", "1 %", "encoder", "encoder.reset", "motor", "unconnected", "speed.value",
    "host", "rpi_pico", "robot.tcf", "..", "/", "/dev/null", "*", "'**'", "'a**b'", "'[a'", "a.b.c", "int", "double",
    "class", "main", "errno", "_x", "__x", "NULL", "bool", "true_", "epg_x", "EPG_X", "ROBOT_H", "SIZE_MAX",
    "INT8_MAX", "inputs", "robot_inputs", "start", "t", "x" * 64, "x" * 300, "x" * 5000, "'*/'", "'/*'", "'// x'",
    "'a\\'", "'\\'", "'\\n'", "'\"'", '"\\""', "'%s%n'", "'??/'", "'??='", "'$x'", "'${x}'", "'$<x>'", "'$ENV{HOME}'",
    "';'", "'a;b'", "'#x'", "'# x'", "'@x@'", "'[=['", "']]'", "'&amp;'", "'<b>'", "'{{ x }}'", "'{% x %}'", "é",
    "µs", "日本", "'\u202e'", "'\u00a0'", "'\u2028'", "😀", '"\\0"', '"\\n"', '"a\\nb"', '"\\r\\n"', '"\\t"', '"\\x07"',
    '"\\e[2J"', '"\\x7f"', '"\\x85"', '"\\u202e"', '"a\\\nb"', "|\n    a\n    b", ">\n    a\n    b", "!!str 1",
    "&a 1", "*a", "<<", "? x", "- x", "'it''s'", "2026-01-01", "1_000", "0b1", "+1", "1.", ".5", "1e3", "'1'", "=",
    "!", "@x", "`x`",
)  # fmt: skip
"""Values in YAML: numbers at every limit, words with a special meaning elsewhere, text with escapes."""

ODD_TEXT = (
    "*/", "/*", "//", "\\", '"', "'", "\n", "\r", "\0", "\x1b[31m", "\x85", "\u2028", "%n", "??/", "${x}", "$<1:x>",
    ";", "#", "#include <x.h>\n", "#define x", "&amp;", "<![CDATA[", "]]>", "<!DOCTYPE x>", "&x;", "&#0;", "&#10;",
    "<x>", "</token>", "{", "}", "(", ")", "[", "]", ",", ":", "=", " = ", "1e999", "99999999999999999999", "²", "٣",
    "é", "\ufeff", "\ud7ff", "if", "return", "static", "struct", "extern", "double ", "xx_P[0] = ", "u[99]", "y[0]",
    "xx_", "aaaaaaaaaaaaaaaaaaaaaaaa" * 20, "(" * 200, "{" * 200,
)  # fmt: skip
"""Pieces to insert into any other file: C, C++, XML."""

_TOKEN = re.compile(r"[A-Za-z_]\w*|[0-9][\w.]*|\s+|[^\w\s]")
_VALUE = re.compile(r"(?<=: )[^,{}\n\[\]]+")
_KEY = re.compile(r"[A-Za-z_]\w*(?=:)")
Draw = Callable[[st.SearchStrategy], object]  # type: ignore[type-arg]


def _place(draw: Draw, places: Sequence[re.Match[str]]) -> re.Match[str] | None:
    return places[draw(st.integers(0, len(places) - 1))] if places else None  # type: ignore[call-overload, no-any-return]


def _replaced(text: str, match: re.Match[str] | None, new: str) -> str:
    return text if match is None else text[: match.start()] + new + text[match.end() :]


def _value(draw: Draw, text: str) -> str:
    """Replaces a value by another scalar."""
    return _replaced(text, _place(draw, list(_VALUE.finditer(text))), str(draw(st.sampled_from(ODD_SCALARS))))


def _other_value(draw: Draw, text: str) -> str:
    """Replaces a value by the value of another key."""
    places = list(_VALUE.finditer(text))
    other = _place(draw, places)
    return _replaced(text, _place(draw, places), other[0]) if other else text


def _number(draw: Draw, text: str) -> str:
    """Replaces a number by another one with the same unit."""
    number = draw(st.one_of(st.integers(0, 40), st.floats(allow_nan=False, allow_infinity=False), st.integers()))
    return _replaced(text, _place(draw, list(re.finditer(r"(?<![\w.])[0-9][0-9.]*", text))), repr(number))


def _rename(draw: Draw, text: str) -> str:
    """Replaces a key."""
    match = _place(draw, list(_KEY.finditer(text)))
    return _replaced(text, match, str(draw(st.sampled_from((*ODD_SCALARS, *_KEY.findall(text))))))


def _rename_everywhere(draw: Draw, text: str) -> str:
    """Replaces a key by a harmless new name everywhere in the text."""
    match = _place(draw, list(_KEY.finditer(text)))
    return re.sub(rf"\b{match[0]}\b", f"{match[0]}_2", text) if match else text


def _line(draw: Draw, text: str) -> str:
    """Deletes, duplicates or indents a line, exchanges it with another, or inserts a comment."""
    lines = text.splitlines(keepends=True)
    if not lines:
        return text
    one, other = (draw(st.integers(0, len(lines) - 1)) for _ in range(2))
    assert isinstance(one, int) and isinstance(other, int)
    how = draw(st.sampled_from(("delete", "double", "swap", "indent", "comment")))
    if how == "delete":
        del lines[one]
    elif how == "double":
        lines.insert(other, lines[one])
    elif how == "swap":
        lines[one], lines[other] = lines[other], lines[one]
    elif how == "indent":
        lines[one] = "  " + lines[one]
    else:
        lines.insert(one, "# */ \\ ??/ ${x}\n")
    return "".join(lines)


def _token(draw: Draw, text: str) -> str:
    """Deletes, duplicates or replaces a word or sign."""
    match = _place(draw, list(_TOKEN.finditer(text)))
    if match is None:
        return text
    new = draw(st.sampled_from(("", match[0] * 2, *ODD_TEXT)))
    return _replaced(text, match, str(new))


def _insert(draw: Draw, text: str) -> str:
    at = draw(st.integers(0, len(text)))
    assert isinstance(at, int)
    return text[:at] + str(draw(st.sampled_from(ODD_TEXT))) + text[at:]


def _nest(draw: Draw, text: str) -> str:
    """Inserts nested brackets, with a depth at a limit or far beyond it."""
    depth = draw(st.sampled_from((3, 31, 32, 33, 3000)))
    assert isinstance(depth, int)
    bracket = draw(st.sampled_from(("[]", "{}", "()")))
    assert isinstance(bracket, str)
    middle = ("a: " if bracket == "{}" else "").join(["", *[bracket[0]] * depth]) + bracket[1] * depth
    return _replaced(text, _place(draw, list(_VALUE.finditer(text) if ": " in text else _TOKEN.finditer(text))), middle)


def _cut(draw: Draw, text: str) -> str:
    at = draw(st.integers(0, len(text)))
    assert isinstance(at, int)
    return text[:at]


def _near_number(draw: Draw, text: str) -> str:
    """Replaces a number by one of similar size."""
    match = _place(draw, list(re.finditer(r"(?<![\w.\[])[0-9][0-9.]*(?![\w\]])", text)))
    if match is None:
        return text
    factor = draw(st.sampled_from((0.1, 0.5, 0.9, 1.5, 2, 3)))
    assert isinstance(factor, (int, float))
    return _replaced(text, match, f"{float(match[0].rstrip('.').split('.')[0] or 1) * factor:g}")


def _flag(draw: Draw, text: str) -> str:
    match = _place(draw, list(re.finditer(r"\b(?:true|false|reliable|best_effort|up|down|zero|hold|disable)\b", text)))
    others = {
        "true": "false",
        "false": "true",
        "reliable": "best_effort",
        "up": "none",
        "zero": "hold",
        "hold": "disable",
    }
    return _replaced(text, match, others.get(match[0], match[0])) if match else text


def _blank_line(draw: Draw, text: str) -> str:
    lines = text.splitlines(keepends=True)
    at = draw(st.integers(0, len(lines)))
    assert isinstance(at, int)
    return "".join([*lines[:at], str(draw(st.sampled_from(("\n", "   \n", "\n\n\n")))), *lines[at:]])


def _swap(draw: Draw, text: str) -> str:
    """Exchanges two adjacent lines of the same depth."""
    lines = text.splitlines(keepends=True)
    depth = [len(line) - len(line.lstrip()) for line in lines]
    places = [
        i for i in range(len(lines) - 1) if depth[i] == depth[i + 1] and lines[i].strip() and lines[i + 1].strip()
    ]
    if places:
        at = draw(st.sampled_from(places))
        assert isinstance(at, int)
        lines[at], lines[at + 1] = lines[at + 1], lines[at]
    return "".join(lines)


_GENTLE = (_near_number, _near_number, _flag, _blank_line, _swap)
"""Mutations after which a file is often still correct, so that they reach the code behind the checks."""

YAML_MUTATIONS = (
    *(_GENTLE * 3), _rename_everywhere, _value, _value, _other_value, _number, _rename, _line, _token, _insert, _nest,
    _cut,
)  # fmt: skip
TEXT_MUTATIONS = (*(_GENTLE * 2), _token, _token, _line, _insert, _insert, _number, _nest, _cut)


@st.composite
def mutated(draw: Draw, text: str, mutations: Sequence[Callable[[Draw, str], str]], most: int = 3) -> bytes:
    """``text`` after one to ``most`` mutations, sometimes in another encoding or with invalid bytes."""
    for _ in range(draw(st.integers(1, most))):  # type: ignore[call-overload]
        mutation = draw(st.sampled_from(list(mutations)))
        text = mutation(draw, text)  # type: ignore[operator]
    how = draw(st.sampled_from(("utf-8",) * 12 + ("utf-8-sig", "utf-16", "latin-1", "crlf", "bytes")))
    if how == "crlf":
        return text.replace("\n", "\r\n").encode("utf-8", "replace")
    if how == "bytes":
        at = draw(st.integers(0, len(text)))
        assert isinstance(at, int)
        junk = draw(st.binary(min_size=1, max_size=6))
        assert isinstance(junk, bytes)
        return text[:at].encode("utf-8", "replace") + junk + text[at:].encode("utf-8", "replace")
    return text.encode(str(how), "replace")
