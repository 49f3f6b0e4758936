# SPDX-License-Identifier: Apache-2.0
"""Prints tables on the terminal, and writes them with a description of the computer into ``docs/benchmarks.md``."""

from __future__ import annotations

import argparse
import os
import platform
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from measure import ROOT

PAGE = ROOT / "docs" / "benchmarks.md"


@dataclass(frozen=True)
class Table:
    """Rows of text below a head.  Columns of numbers are aligned to the right."""

    title: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    notes: Sequence[str] = ()

    def plain(self) -> str:
        """The table as text for the terminal."""
        lines = [list(self.head), *map(list, self.rows)]
        widths = [max(len(line[column]) for line in lines) for column in range(len(self.head))]
        right = [column > 0 and all(_is_number(row[column]) for row in self.rows) for column in range(len(widths))]
        out = [self.title, "-" * len(self.title)]
        for line in lines:
            cells = [cell.rjust(width) if r else cell.ljust(width) for cell, width, r in zip(line, widths, right)]
            out.append("  ".join(cells).rstrip())
        return "\n".join([*out, *self.notes])

    def markdown(self) -> str:
        """The table in Markdown for the page."""
        right = [column > 0 and all(_is_number(row[column]) for row in self.rows) for column in range(len(self.head))]
        out = [f"### {self.title}", "", _row(self.head), f"|{'|'.join('---:' if r else '---' for r in right)}|"]
        out += [_row(row) for row in self.rows]
        return "\n".join([*out, *(f"\n{note}" for note in self.notes)])


def arguments(description: str, **counts: int) -> argparse.Namespace:
    """Parses the command line of a benchmark: ``--write``, and an option with a default for each of ``counts``."""
    parser = argparse.ArgumentParser(description=description.split("\n\n")[0])
    parser.add_argument("--write", action="store_true", help="put the tables into docs/benchmarks.md")
    for name, value in counts.items():
        parser.add_argument(f"--{name}", type=int, default=value, help=f"default: {value}")
    return parser.parse_args()


def show(name: str, tables: Sequence[Table], write: bool, command: str) -> None:
    """Prints ``tables``.  With ``write``, also replaces the section ``name`` of the page."""
    print("\n\n".join(table.plain() for table in tables))
    if not write:
        return
    text = PAGE.read_text(encoding="utf-8")
    begin, end = f"<!-- begin {name} -->", f"<!-- end {name} -->"
    body = [f"Command: `{command}`.", *(table.markdown() for table in tables)]
    head = " ".join(text.partition("<!-- begin")[0].split())
    if machine() not in head:  # the top of the page states the usual machine
        body[0] += f" Machine: {machine()}."
    section = "\n\n".join([begin, *body, end])
    if begin not in text:
        raise SystemExit(f"{PAGE.name} has no section '{name}': write '{begin}' and '{end}' where it belongs")
    text = re.sub(f"{begin}.*?{end}", lambda _: section, text, flags=re.DOTALL)
    PAGE.write_text(text, encoding="utf-8", newline="\n")


def machine() -> str:
    """The facts on which the numbers depend: processor, system, Python, and the installed tools."""
    parts = [f"{_processor()}, {os.cpu_count()} of its threads, shared", platform.system() + " " + platform.machine()]
    parts.append(f"Python {platform.python_version()}")
    for program, pattern in (("cmake", r"version (\S+)"), ("gcc", r"(\d+\.\d+\.\d+)\s*$"), ("valgrind", r"-(\S+)")):
        found = _version(program, pattern)
        if found:
            parts.append(f"{program} {found}")
    return ", ".join(parts)


def milliseconds(seconds: float) -> str:
    return f"{seconds * 1000:.1f}"


def _processor() -> str:
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return platform.processor() or platform.machine()
    found = re.search(r"model name\s*:\s*(.+)", text)
    return found[1].strip() if found else platform.machine()


def _version(program: str, pattern: str) -> str:
    path = shutil.which(program)
    if path is None:
        return ""
    first = subprocess.run([path, "--version"], capture_output=True, text=True, check=False).stdout.split("\n")[0]
    found = re.search(pattern, first)
    return found[1] if found else ""


def _row(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def _is_number(cell: str) -> bool:
    return cell == "" or re.match(r"[-+]?[\d.,]+( ?[x%]| of .*)?$", cell) is not None


def command_line(program: str) -> str:
    """``python benchmarks/<program>.py`` with the arguments of this run, without ``--write``."""
    return " ".join(["python", f"benchmarks/{program}.py", *(a for a in sys.argv[1:] if a != "--write")])
