# SPDX-License-Identifier: Apache-2.0
"""Finds the errors and warnings of a build in the output of CMake, compilers, linkers, Zephyr's tools and EPG.

>>> messages = Messages((Path("/home/me/robot"),))
>>> messages.read("/home/me/robot/main.c:3:5: error: expected ';' before 'return'")
>>> messages.finish(failed=True)[0].message
"expected ';' before 'return'"

Each line is read once, as it arrives.  A message that only reports another failure ("ld returned 1 exit status") is
left out if there is a message about its cause.
"""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from epg.connect.build.cmake_message import CMakeMessage, starts_cmake_message
from epg.generator.dataclass import dataclass

LIMIT = 100
"""The number of messages that are kept for one build; one wrong header can cause thousands."""
TAIL = 12
"""The number of last lines that are shown for a failure without any known message."""


@dataclass(frozen=True)
class BuildMessage:
    """One problem.  ``file`` is absolute if the file was found.  ``line`` and ``column`` count from 1; 0 is unknown."""

    severity: str  # "error" or "warning"
    message: str
    file: str = ""
    line: int = 0
    column: int = 0
    hint: str = ""
    id: str = ""

    def data(self) -> dict[str, Any]:
        return {**asdict(self), "port": None}


_FILE = r"(?P<file>(?:[A-Za-z]:[\\/])?[^:\n]+)"
_EPG = re.compile(
    r"(?P<file>(?:[A-Za-z]:[\\/])?[^:]+)(?::(?P<line>\d+)(?::(?P<column>\d+))?)?: (?P<severity>error|warning): "
    r"(?P<text>.*) \[(?P<id>[a-z0-9]\w*(?:-\w+)+)\]"
)
_COMPILER = re.compile(
    _FILE + r":(?P<line>\d+)(?::(?P<column>\d+))?: (?P<severity>fatal error|error|warning): (?P<text>.*)"
)
_ASSEMBLER = re.compile(_FILE + r":(?P<line>\d+): (?P<severity>Error|Warning): (?P<text>.*)")
_MICROSOFT = re.compile(
    r"(?P<file>[^(\n]+)\((?P<line>\d+)(?:,(?P<column>\d+))?\)\s?: (?P<severity>fatal error|error|warning) "
    r"(?P<id>[A-Z]+\d+): (?P<text>.*)"
)
_REFERENCE = re.compile(
    r"(?:\S*\bld(?:\.\w+)?(?:\.exe)?: )?(?:(?:[A-Za-z]:)?[^:\n]+\.o(?:bj)?:)?"
    + _FILE
    + r":(?:(?P<line>\d+)(?::\([^)]*\))?|\([^)]*\)): "  # binutils 2.44: file.c:4:(.text+0x5)
    r"(?P<text>(?:undefined reference to|multiple definition of|relocation truncated) .*)"
)
_LINKER = re.compile(r"(?:\S*[\\/])?(?:[\w.]+-)*ld(?:\.\w+)?(?:\.exe)?: (?:(?P<severity>error|warning): )?(?P<text>.*)")
_RUNNING = re.compile(
    r"cannot open output file .*\.exe'?: Permission denied|failed to write .*\.exe'?: [Pp]ermission denied"
)
"""GNU ld and lld on Windows, which does not let a running program be replaced."""
_RUNNING_HINT = "the program may be running: end it, and generate again"
_DEVICETREE = re.compile(
    r"devicetree error: (?:" + _FILE + r":(?P<line>\d+)(?: \(column (?P<column>\d+)\))?: )?(?P<text>.*)"
)
_DTC = re.compile(r"Error: (?P<file>[^:\s]+):(?P<line>\d+)\.(?P<column>\d+)(?:-[\d.]+)? (?P<text>.*)")
_KCONFIG = re.compile(r"(?P<severity>error|warning): (?P<text>.*)")
_PROGRAM = re.compile(r"(?:ninja: (?:error|fatal): |g?make(?:\[\d+\])?: \*\*\* |(?:FATAL )?ERROR: )(?P<text>.*)")
_MAKE_STOPS = re.compile(r"g?make(?:\[\d+\])?: \*\*\* (?:\[.*\] (?:Error \d+|Terminated|Interrupt)|Waiting for )")
"""Make prints this after each failed command, once for each Makefile around it."""
_DRIVER = re.compile(r"(?:\S*[\\/])?[\w.+-]+: (?:fatal )?error: (?P<text>.*)")  # collect2: error: ..., cc1: error: ...
_CAUSED = re.compile(
    r"was not generated; the messages above say why|subcommand failed|failed with return code|Child return code"
    r"|execute_process failed|ld returned \d+ exit status|linker command failed|Error \d+$|command exited with status"
    r"|Terminated$|^Aborting due to|^CMAKE_\w+ not set, after EnableLanguage"
)
"""Messages that only report the failure of another command."""
_NOISE = re.compile(
    r"\s*$|-- |See also |\[ *\d+(?:/\d+|%)\] |FAILED: |ninja: build stopped|g?make(?:\[\d+\])?: \*\*\* |Call Stack"
)
_ESCAPES = re.compile(r"\x1b(?:\[[0-?]*[ -/]*[@-~]|\][^\x07\x1b]*(?:\x07|\x1b\\)|.)")
"""Escape sequences of a terminal: colours, movements of the cursor, links."""


def plain(line: str) -> str:
    """``line`` without colours and other control characters; only the part after its last carriage return."""
    text = _ESCAPES.sub("", line).rpartition("\r")[2]
    return "".join(char for char in text if char.isprintable() or char == "\t")


class Messages:
    """Reads output line by line.  Names of files are searched in ``folders``; the first is the project's own."""

    def __init__(self, folders: Sequence[Path]) -> None:
        self._folders = folders
        self._found: dict[tuple[str, str, int, str], BuildMessage] = {}
        self._tail: deque[str] = deque(maxlen=TAIL)
        self._more: Callable[[str], bool] | None = None  # reads the further lines of a message until it returns False
        self._perhaps: list[tuple[str, str, int, str]] = []  # warnings that Kconfig may treat as errors

    def read(self, line: str) -> None:
        """Reads the next line, as :func:`plain` returns it."""
        if not _NOISE.match(line):
            self._tail.append(line)
        if self._more is not None and self._more(line):
            return
        self._more = None
        if starts_cmake_message(line):
            self._start_cmake(line)
        elif line.startswith("Traceback (most recent call last):"):
            self._more = self._traceback
        elif not self._simple(line):
            self._kconfig(line)

    def finish(self, *, failed: bool) -> list[BuildMessage]:
        """All messages, after the last line.  If the build failed without any error, the last lines are the message."""
        if self._more is not None:
            self._more("")
            self._more = None
        if failed and not any(message.severity == "error" for message in self._found.values()):
            text = "\n".join(self._tail) or "the build failed without a message"
            self._add(BuildMessage("error", text, id="build-failed"))
        return self.all

    @property
    def all(self) -> list[BuildMessage]:
        """The messages so far, each once.  Messages that only report another failure are left out."""
        messages = list(self._found.values())
        if any(message.severity == "error" and not _CAUSED.search(message.message) for message in messages):
            messages = [message for message in messages if not _CAUSED.search(message.message)]
        return messages

    def _simple(self, line: str) -> bool:
        """Reads a message of one line; only EPG's own messages have further lines.  Returns False for other lines."""
        if match := _EPG.fullmatch(line):
            self._start_epg(self._message(match, id=match["id"]))
        elif match := _REFERENCE.fullmatch(line) or _DEVICETREE.fullmatch(line) or _DTC.fullmatch(line):
            self._add(self._message(match, severity="error"))
        elif match := _COMPILER.fullmatch(line) or _ASSEMBLER.fullmatch(line):
            self._add_of_compiler(match)
        elif match := _MICROSOFT.fullmatch(line):
            self._add(self._message(match, id=match["id"]))
        elif match := _LINKER.fullmatch(line):
            # such a line names only the function; the next line is the message
            if not re.search(r"in function [`'\"‘].*:$", line):
                hint = _RUNNING_HINT if _RUNNING.search(match["text"]) else ""
                severity = match["severity"] or _severity_of(match["text"])
                self._add(BuildMessage(severity, _without_path(match["text"]), hint=hint))
        elif match := _DRIVER.fullmatch(line) or _PROGRAM.fullmatch(line):
            if not _MAKE_STOPS.match(line):
                self._add(BuildMessage("error", match["text"]))
        else:
            return False
        return True

    def _add_of_compiler(self, match: re.Match[str]) -> None:
        text, _, option = match["text"].partition(" [-W")
        message = self._message(match, text=text, id=f"-W{option[:-1]}" if option.endswith("]") else "")
        self._add(message)
        if not message.id and message.severity == "warning":
            self._perhaps.append(_key(message))

    def _message(
        self, match: re.Match[str], *, severity: str = "", text: str | None = None, id: str = ""
    ) -> BuildMessage:
        named = match.groupdict()
        how = severity or (named.get("severity") or "error").lower().removeprefix("fatal ")
        line, column = int(named.get("line") or 0), int(named.get("column") or 0)
        return BuildMessage(
            how, match["text"] if text is None else text, self._place(named["file"]), line, column, id=id
        )

    def _place(self, file: str | None) -> str:
        """The path of a file that a program names: absolute if one of the folders contains it."""
        if not file or Path(file).is_absolute():
            return file or ""
        return next((str(folder / file) for folder in self._folders if (folder / file).exists()), file)

    def _add(self, message: BuildMessage) -> None:
        # one position is enough for a symbol that is missing or defined twice
        key = ("", "", 0, message.message) if _REFERS.match(message.message) else _key(message)
        if len(self._found) < LIMIT:
            self._found.setdefault(key, message)

    def _start_epg(self, message: BuildMessage) -> None:
        """Reads the further lines of EPG's message: the line with a caret, notes, the hint."""
        self._add(message)

        def more(line: str) -> bool:
            if line.startswith("hint: "):
                if _key(message) in self._found:
                    self._found[_key(message)] = replace(message, hint=line.removeprefix("hint: "))
                return True
            return bool(re.match(r" *\d* \| ", line + " ") or re.search(r": note: ", line))

        self._more = more

    def _start_cmake(self, line: str) -> None:
        block = CMakeMessage(line)

        def more(line: str) -> bool:
            if block.read(line):
                return True
            file, number = block.place(self._folders[0])
            for text, hint in block.problems:
                self._add(BuildMessage(block.severity, text, self._place(file), number, hint=hint))
            return False

        self._more = more

    def _kconfig(self, line: str) -> None:
        """Reads a message of Kconfig: it begins without a file, and is wrapped until an empty line."""
        match = _KCONFIG.fullmatch(line)
        if match is None:
            return
        severity, text = match["severity"], [match["text"]]

        def more(line: str) -> bool:
            if line.strip() and not starts_cmake_message(line) and not line.startswith("-- "):
                text.append(line.strip())
                return True
            message = BuildMessage(severity, " ".join(text))
            self._add(message)
            if severity == "warning":
                self._perhaps.append(_key(message))
            elif message.message.startswith("Aborting due to"):
                self._take_for_errors()
            return False

        self._more = more

    def _traceback(self, line: str) -> bool:
        """Reads the further lines of a Python traceback: its last line is the message."""
        if not line.strip() or line.startswith((" ", "Traceback ", "During handling ", "The above exception ")):
            return True
        self._add(BuildMessage("error", line))
        return False

    def _take_for_errors(self) -> None:
        """Turns warnings into errors: Kconfig aborts because of its warnings.

        If some warnings have a position, only those are turned.
        """
        placed = [key for key in self._perhaps if key[1]]
        for key in placed or self._perhaps:
            if key in self._found:
                self._found[key] = replace(self._found[key], severity="error")


_REFERS = re.compile(r"undefined reference to |multiple definition of ")


def _key(message: BuildMessage) -> tuple[str, str, int, str]:
    return message.severity, message.file, message.line, message.message


def _severity_of(text: str) -> str:
    """The severity of a linker's message: linkers mark warnings, but not always errors."""
    return "warning" if re.search(r"(?:^|: )warning: ", text) else "error"


def _without_path(text: str) -> str:
    return re.sub(r"^(?:\S+: )?warning: ", "", text)
