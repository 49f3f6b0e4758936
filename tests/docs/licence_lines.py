# SPDX-License-Identifier: Apache-2.0
"""Which sources name the licence at their beginning, and how.

Left out are inputs and models of tests and examples, whose lines are counted, and files that can have no comment.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import PurePosixPath

LINE = "SPDX-License-Identifier: Apache-2.0"
EVERYTHING = ("epg", "cmake", "targets", "integration", "zephyr", "zephyr_module", "benchmarks")
"""Folders of which every source counts; of the others, scripts alone."""
SCRIPTS = (".py", ".mjs")
LOOKED_AT = 6
"""So many lines at the beginning of a file may hold the line."""
COMMENTS = {
    (".py", ".cmake"): "# {}",
    (".c", ".h", ".cpp", ".hpp", ".S", ".ld", ".css", ".overlay"): "/* {} */",
    (".js", ".mjs"): "// {}",
    (".j2",): "{{# {} #}}",
    (".html",): "<!-- {} -->",
    (".pio",): "; {}",
}
_BEFORE = re.compile(r"(?:#!.*\n|(?i:<!doctype [^>]*>\n?))")
"""What has to stay the first line."""


def sources(names: Iterable[str]) -> list[str]:
    """Those of ``names``, relative to the repository, that must have the line."""
    return [name for name in names if comment(name) and _counts(PurePosixPath(name))]


def comment(name: str) -> str:
    """The line as a comment of the file's language, or ""."""
    path = PurePosixPath(name)
    hashes = path.name == "CMakeLists.txt" or path.name.split(".")[0] == "Kconfig"
    form = "# {}" if hashes else next((form for ends, form in COMMENTS.items() if path.suffix in ends), "")
    return form.format(LINE) if form else ""


def with_line(name: str, text: str) -> str:
    """``text`` with the line, if it lacks that and is not empty."""
    if not text.strip() or LINE in "\n".join(text.split("\n")[:LOOKED_AT]):
        return text
    match = _BEFORE.match(text)
    start = match.end() if match else 0
    return f"{text[:start]}{comment(name)}\n{text[start:]}"


def _counts(path: PurePosixPath) -> bool:
    if path.parts[0] in EVERYTHING or path.name == "epg_import.cmake":
        return True
    return path.suffix in SCRIPTS and not {"wrong", "cases"}.intersection(path.parts)
