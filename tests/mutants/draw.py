# SPDX-License-Identifier: Apache-2.0
"""Mutants of one source: each changes one line that occurs once in its file.

Strings and comments are not changed, and of templates only the blocks of Jinja and whole statements of C.
Formatters put a space on both sides of a binary operator in all languages, so that they share most changes.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

SUFFIXES = {".py": "python", ".c": "c", ".h": "c", ".j2": "templates", ".js": "javascript"}
"""The languages, which are the names of the files of the record."""
_STRING = r""""(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'"""
_C = rf"/\*.*?\*/|//[^\n]*|{_STRING}|^[ \t]*#(?:\\\n|[^\n])*"
_SKIPPED = {
    suffix: re.compile(pattern, re.DOTALL | re.MULTILINE)
    for suffix, pattern in {
        ".py": rf'(?:\b[rbfRBF]{{1,2}})?(?:"""(?:\\.|.)*?"""|{_STRING})|#[^\n]*',
        ".c": _C,
        ".h": _C,
        ".js": rf"/\*.*?\*/|//[^\n]*|{_STRING}|`(?:\\.|[^`\\])*`",
        ".j2": rf"\{{#.*?#\}}|/\*.*?\*/|{_STRING}",
    }.items()
}
_SWAPS = {
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "===": "!==", "!==": "===", "&&": "||",
    "||": "&&", "and": "or", "or": "and", "is": "is not", "is not": "is", "in": "not in", "not in": "in", "+": "-",
    "-": "+", "*": "+", "%": "*", "<<": ">>", ">>": "<<", "&": "|", "+=": "-=", "-=": "+=", "|=": "&=",
    "true": "false", "false": "true", "True": "False", "False": "True", "any(": "all(", "all(": "any(",
    "min(": "max(", "max(": "min(", "!": "", "not ": "",
}  # fmt: skip
_TOKEN = re.compile(
    r"""(?<=[\w)\]}]\ )([<>=!]==?|<<|>>|[<>]|&&|\|\||[-+|]=|[-+*%&]|and|or|is\ not|not\ in|is|in)(?=\ [\w(\[{!-])
    |\b(true|false|True|False|any\(|all\(|min\(|max\(|not\ (?!in\b))
    |(!)(?=[\w(])
    |(?<![\w.])(\d+)(?=[uU]?[lL]*(?![\w.]))""",
    re.VERBOSE,
)
_LINES = {
    ".py": {
        r"(raise .*|continue|break|self\.[\w.]+ \+?= .*|(?!super\b)[\w.]+\(.*\))": "pass",
        r"return (?!None$|True$|False$)(.+)": "None",
        r"(?:if|elif|while) (\w.*):": "not (…)",
    },
    ".c": {
        r"((?!return\b|else\b)\*?[\w.>\[\]-]+(?: [-+|&]?= .*|\(.*\)|\+\+|--);)": ";",
        r"(?:\} )?(?:else )?(?:if|while) \((.*)\) \{": "!(…)",
    },
    ".j2": {r"\{%-? (?:if|elif) (.*?) -?%\}": "not (…)"},
}
_LINES[".h"] = _LINES[".js"] = _LINES[".c"]
_LINES[".j2"] |= _LINES[".c"]
_NOT_CHANGED = re.compile(
    r"import |from |export |@|__all__|if TYPE|if __name|.*\bfor \w+(, \w+)* in\b|\w*_?(ASSERT|Static_assert)\b"
)
_ENDS = (";", "{", "}", ":")
"""The end of a line of C or JavaScript after which a statement begins."""


def mutants(source: str, suffix: str) -> Iterator[tuple[str, str]]:
    """The lines before and after each change.  Some mutants are not correct, see :func:`compiles`."""
    masked = _SKIPPED[suffix].sub(lambda found: re.sub(r"[^\n]", " ", found.group()), source)
    previous = ";"
    for whole, shown in zip(source.split("\n"), masked.split("\n")):
        line, code = whole.strip(), shown[len(whole) - len(whole.lstrip()) :].rstrip()
        begins = suffix == ".py" or previous.endswith(_ENDS)
        previous = code.strip() or previous
        if len(line) < 8 or not code.strip() or source.count(line) != 1 or _NOT_CHANGED.match(code):
            continue
        for start, end, new in [*(_of_the_line(code, suffix) if begins else []), *_of_tokens(code, suffix)]:
            yield line, line[:start] + new.replace("…", line[start:end]) + line[end:]


def _of_the_line(code: str, suffix: str) -> Iterator[tuple[int, int, str]]:
    for pattern, new in _LINES[suffix].items():
        if found := re.fullmatch(pattern, code):
            yield *found.span(1), new


def _of_tokens(code: str, suffix: str) -> Iterator[tuple[int, int, str]]:
    blocks = list(re.finditer(r"\{[{%].*?[%}]\}", code))
    for found in _TOKEN.finditer(code):
        inside = suffix != ".j2" or any(block.start() < found.start() < block.end() for block in blocks)
        text = str(found[found.lastindex or 0])
        start, end = found.span(found.lastindex or 0)
        if inside and (suffix != ".py" or text not in ("&", "|=")):
            yield start, end, str(int(text) + 1) if text.isdigit() else _SWAPS[text]


def compiles(source: str, suffix: str) -> bool:
    """False if a source in Python is wrong.  Mutants of other languages nearly always are correct."""
    try:
        if suffix == ".py":
            compile(source, "mutant", "exec", dont_inherit=True)
    except SyntaxError:
        return False
    return True
