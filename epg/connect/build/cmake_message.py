# SPDX-License-Identifier: Apache-2.0
"""Reads one message of CMake: a line with the position, a text in wrapped paragraphs, and the call stack.

::

    CMake Error at /opt/epg/cmake/EPGSdk.cmake:17 (message):
      Raspberry Pi Pico SDK was not found.  Get it:

        git clone https://github.com/raspberrypi/pico-sdk.git

    Call Stack (most recent call first):
      CMakeLists.txt:12 (epg_import_pico_sdk)
"""

from __future__ import annotations

import os
import re
from pathlib import Path

_START = re.compile(
    r"CMake (?P<kind>(?:Internal )?Error|(?:Deprecation |Debug )?Warning)(?: \(dev\))?"
    r"(?:: (?P<text>.+)| (?:at|in) (?P<file>(?:[A-Za-z]:)?[^:]+)(?::(?P<line>\d+))?(?: \([^)]*\))?:)"
)
_CALL = re.compile(r"  (?P<file>(?:[A-Za-z]:)?[^:]+):(?P<line>\d+) \([^)]*\)")
_GET = re.compile(r"(?:^|\s+)Get it:\n+ +(?P<command>\S.*)$", re.MULTILINE)


def starts_cmake_message(line: str) -> bool:
    return line.startswith("CMake ") and _START.fullmatch(line) is not None


class CMakeMessage:
    """One message, read line by line; ``first`` is its first line."""

    def __init__(self, first: str) -> None:
        match = _START.fullmatch(first)
        assert match is not None, "the caller has asked starts_cmake_message()"
        self.severity = "error" if match["kind"].endswith("Error") else "warning"
        self._calls = [(match["file"] or "", int(match["line"] or 0))]
        self._lines = [match["text"]] if match["text"] else []
        self._short = bool(match["text"])  # "CMake Error: ...": the text is one line
        self._in_stack = False
        self._after_empty = False

    def read(self, line: str) -> bool:
        """Reads the next line.  Returns False if ``line`` does not belong to this message."""
        if line.startswith("Call Stack (most recent call first):"):
            self._in_stack = True
        elif self._in_stack:
            match = _CALL.fullmatch(line)
            if match is None:
                return False
            self._calls.append((match["file"], int(match["line"])))
        elif self._short:
            return False
        elif line.startswith("  "):
            self._lines.append(line[2:])
        elif not line:
            ended = self._after_empty  # two empty lines end a message; in its text they are single or have two blanks
            self._after_empty = True
            self._lines.append("")
            return not ended
        else:
            return False
        self._after_empty = False
        return True

    @property
    def problems(self) -> list[tuple[str, str]]:
        """The problems of the message: for each its text, and a hint with the command that installs a tool, or "".

        A message with several commands has one problem for each: the paragraph that ends with "Get it:".
        """
        commands = list(_GET.finditer(self._whole))
        if len(commands) <= 1:
            hint = f"get it: {commands[0]['command']}" if commands else ""
            return [(re.sub(r"\n{3,}", "\n\n", _GET.sub("", self._whole)).strip(), hint)]
        problems = []
        start = 0
        for match in commands:
            text = self._whole[start : match.start()].strip().rpartition("\n")[2]
            problems.append((text, f"get it: {match['command']}"))
            start = match.end()
        return problems

    @property
    def _whole(self) -> str:
        """The whole text.  CMake wraps paragraphs: their lines are joined here, and indented lines are kept."""
        paragraphs: list[str] = []
        go_on = False
        for line in (line.rstrip() for line in self._lines):
            filled = bool(line) and not line.startswith(" ")
            if filled and go_on:
                paragraphs[-1] += f" {line}"
            else:
                paragraphs.append(line)
            go_on = filled
        return "\n".join(paragraphs).strip("\n")

    def place(self, project: Path) -> tuple[str, int]:
        """File and line of the innermost call in the folder ``project``; else the position in CMake's first line."""
        for file, line in self._calls:
            path = Path(os.path.normpath(project / file))
            if file and path.is_relative_to(project):
                return str(path), line
        return self._calls[0]
