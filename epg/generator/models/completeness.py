# SPDX-License-Identifier: Apache-2.0
"""Finds variables and methods that are missing in an export, for example because the user deleted a file.

Without this check, the user would only see an error of the compiler or of the linker.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from epg.generator.diagnostics import Diagnostics
from epg.generator.models.c_code import KEYWORDS, CFile
from epg.generator.models.declarations import end_of_block
from epg.generator.models.link import Linked
from epg.generator.source import Span

_EXTERN = re.compile(r"\bextern\s[^;(){}]{0,300};")
_VIRTUAL = r"\bvirtual\s[^;(){}]{0,200}?(~?\w{1,255})\s{0,80}\("
_HINT = "check that all files are there as 20-sim exported them, or export the model again"


def check_variables(linked: Linked, prefix: str, diagnostics: Diagnostics) -> None:
    """Reports variables with the model's ``prefix`` that are used, but that no file defines.

    Checks all functions, because the linker also needs the variables of code that never runs.
    """
    if len(prefix) < 2:
        return
    known = {variable.name for code in linked.all for variable in code.variables}
    known |= {function.name for code in linked.all for function in code.functions} | linked.macro_names()
    pattern = re.compile(rf"(?<![\w.>]){re.escape(prefix)}\w{{0,255}}", re.ASCII)
    missing: dict[str, Span] = {}
    for code in linked.units:
        for function in code.functions:
            for match in pattern.finditer(code.file.code, function.body_start, function.body_end):
                name = match[0]
                if name not in known and not _is_declared(name, linked, code):
                    missing[name] = code.file.span(match.start(), match.end())
                known.add(name)
    _report(missing, "used", diagnostics)


def check_methods(linked: Linked, class_name: str, diagnostics: Diagnostics) -> None:
    """Reports methods that a class declares and the linker needs, but that no file defines."""
    defined = {function.name for _, function in linked.functions() if function.owner == class_name}
    wanted = {class_name, f"~{class_name}", "Initialize", "Step"}  # the linker needs virtual methods even if not called
    for header in linked.headers:
        wanted |= {match[1] for match in re.finditer(_VIRTUAL, header.file.code, re.ASCII)}
    missing: dict[str, Span] = {}
    for header in linked.headers:
        for start, body in _bodies(class_name, header):
            for match in re.finditer(r"(?<![\w~])(~?\w{1,255})\s{0,80}\([^(){};]{0,500}\)[^(){};=]{0,80};", body):
                if match[1] in wanted - defined:
                    missing[match[1]] = header.file.span(start + match.start(1), start + match.end(1))
    _report(missing, "declared", diagnostics)


def _report(missing: dict[str, Span], what: str, diagnostics: Diagnostics) -> None:
    if missing:
        name, *others = missing
        also = f" (nor {', '.join(repr(other) for other in others[:6])})" if others else ""
        message = f"'{name}' is {what}, but no file of the export defines it{also}"
        diagnostics.error("model-incomplete", missing[name], message, hint=_HINT)


def _is_declared(name: str, linked: Linked, code: CFile) -> bool:
    """True if a header, or a declaration in a function, declares ``name`` other than as ``extern``."""
    for header in linked.headers:
        if name in header.identifiers and re.search(rf"\b{name}\b", _EXTERN.sub("", header.file.code)):
            return True
    text = _EXTERN.sub("", code.file.code)
    begin = r"[;{}(,]\s{0,80}(?:(?:static|const|register|volatile)\s{1,80}){0,3}"
    declaration = re.compile(rf"{begin}(\w{{1,255}})[\s*]{{1,80}}{name}\s{{0,80}}[\[=;,]", re.ASCII)
    return any(match[1] not in KEYWORDS or match[1] in _TYPES for match in declaration.finditer(text))


_TYPES = frozenset("double float int char long short unsigned signed".split())


def _bodies(class_name: str, header: CFile) -> Iterable[tuple[int, str]]:
    """The offset and the text between the braces of the class in ``header``; nothing if it is not declared there."""
    text = header.file.code
    for match in re.finditer(rf"\bclass\s{{1,80}}{re.escape(class_name)}\b[^;{{}}]{{0,500}}\{{", text):
        yield match.end(), text[match.end() : end_of_block(text, match.end())]
        return
