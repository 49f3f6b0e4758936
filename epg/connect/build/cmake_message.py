# SPDX-License-Identifier: Apache-2.0
"""One message of CMake: a line that says where, a text in wrapped paragraphs, the calls that led there.

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
    """Gathers a message from its first line on."""

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
        """Whether ``line`` belongs to this message."""
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
            ended = self._after_empty  # two of them; one in the text has two blanks
            self._after_empty = True
            self._lines.append("")
            return not ended
        else:
            return False
        self._after_empty = False
        return True

    @property
    def problems(self) -> list[tuple[str, str]]:
        """What is wrong, and the command that gets what is missing, or "".

        A message with several commands is one problem for each: the paragraph that ends with "Get it:".
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
        """CMake fills lines up to a width: those of a paragraph are one line, indented ones stay."""
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
        """The innermost call that stands in the project itself; else where CMake was when it said this."""
        for file, line in self._calls:
            path = Path(os.path.normpath(project / file))
            if file and path.is_relative_to(project):
                return str(path), line
        return self._calls[0]
