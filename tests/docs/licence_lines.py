# SPDX-License-Identifier: Apache-2.0
"""The sources that must name the licence at their beginning, and the form of that line.

Excluded are libraries of others, files without comments, and inputs and models of tests and examples, because tests
count their lines.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import PurePosixPath

LINE = "SPDX-License-Identifier: Apache-2.0"
EVERYTHING = ("epg", "cmake", "targets", "integration", "zephyr", "zephyr_module", "benchmarks")
"""Folders in which every source needs the line; in other folders, only scripts do."""
SCRIPTS = (".py", ".mjs")
LOOKED_AT = 6
"""The line must be among this many first lines of a file."""
COMMENTS = {
    (".py", ".cmake"): "# {}",
    (".c", ".h", ".cpp", ".hpp", ".S", ".ld", ".css", ".overlay"): "/* {} */",
    (".js", ".mjs"): "// {}",
    (".j2",): "{{# {} #}}",
    (".html",): "<!-- {} -->",
    (".pio",): "; {}",
}
_BEFORE = re.compile(r"(?:#!.*\n|(?i:<!doctype [^>]*>\n?))")
"""Lines that must stay the first line."""


def sources(names: Iterable[str]) -> list[str]:
    """The files among ``names``, relative to the repository, that must have the line."""
    return [name for name in names if comment(name) and _counts(PurePosixPath(name))]


def comment(name: str) -> str:
    """The line as a comment in the file's language, or ""."""
    path = PurePosixPath(name)
    hashes = path.name == "CMakeLists.txt" or path.name.split(".")[0] == "Kconfig"
    form = "# {}" if hashes else next((form for ends, form in COMMENTS.items() if path.suffix in ends), "")
    return form.format(LINE) if form else ""


def with_line(name: str, text: str) -> str:
    """``text`` with the line added, if it lacks the line and is not empty."""
    if not text.strip() or LINE in "\n".join(text.split("\n")[:LOOKED_AT]):
        return text
    match = _BEFORE.match(text)
    start = match.end() if match else 0
    return f"{text[:start]}{comment(name)}\n{text[start:]}"


def _counts(path: PurePosixPath) -> bool:
    if "vendor" in path.parts:
        return False  # libraries of others
    if path.parts[0] in EVERYTHING or path.name == "epg_import.cmake":
        return True
    return path.suffix in SCRIPTS and not {"wrong", "cases"}.intersection(path.parts)
