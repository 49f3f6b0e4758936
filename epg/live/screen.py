# SPDX-License-Identifier: Apache-2.0
"""The screen of ``epg live`` in a terminal: values that move, the answers to commands, and a line for the next one."""

from __future__ import annotations

import errno
import shutil
import sys
import textwrap
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable

from epg.live.client import Client, CommandRefused, Lost
from epg.live.enabling import CONFIRM, send
from epg.live.faults import Faults
from epg.live.keyboards import keyboard
from epg.live.rows import Recorder
from epg.runs.recording import Row

PERIOD = 0.1
"""Seconds between two pictures."""
ANSWER = 0.02
"""Seconds between two looks at the keyboard and at the numbers of a lease."""
OLD = 1.0
"""Seconds without news after which the values are old."""
LINES = 8
"""Lines of answers on the screen."""
_BARS = "▁▂▃▄▅▆▇█"
_HISTORY = 30
_END = ("\x03", "\x04")


class Values:
    """A sink of rows that keeps the newest value of each signal, and one value of each past picture."""

    def __init__(self, count: int) -> None:
        self._new: list[list[float]] = [[] for _ in range(count)]
        self.newest = [float("nan")] * count
        self.history: list[deque[float]] = [deque(maxlen=_HISTORY) for _ in range(count)]

    def write(self, rows: Iterable[Row]) -> None:
        for row in rows:
            for values, value in zip(self._new, row.values, strict=True):
                values.append(value)

    def picture(self) -> None:
        """Takes the values since the last picture.  Of them, the history keeps the one farthest from the last one."""
        new, self._new = self._new, [[] for _ in self._new]
        for index, values in enumerate(new):
            if values:
                last = self.newest[index]
                self.history[index].append(max(values, key=lambda value, last=last: abs(value - last)))  # type: ignore[misc]
                self.newest[index] = values[-1]


def sparkline(values: Iterable[float]) -> str:
    """A small curve of block characters.

    >>> sparkline([0.0, 0.5, 1.0])
    '▁▅█'
    """
    finite = [value for value in values if value - value == 0]
    if not finite:
        return ""
    low, high = min(finite), max(finite)
    scale = (len(_BARS) - 1) / (high - low) if high > low else 0.0
    return "".join(_BARS[int((value - low) * scale + 0.5)] for value in finite)


class Screen:
    """The screen and the keyboard.

    The space bar disables the target if the line is empty.  ``enable`` enables it on a lease: the numbers of the target
    come back only while this loop runs.
    """

    def __init__(self, client: Client, names: list[str], values: Values, recording: Recorder, faults: Faults) -> None:
        self._client, self._names, self._values, self._recording = client, names, values, recording
        units = {signal.name: signal.unit for signal in client.description.streamed}
        self._units = [units[name] for name in names]
        self._line = ""
        self._said: deque[str] = deque(maxlen=LINES)
        self._numbers: deque[int] = deque()
        self._shown: dict[str, str] = {}  # the words of the state on the screen
        self._unconfirmed = ""  # a line that the person must confirm
        self._faults = faults
        self.over = False

    def told(self, line: str) -> None:
        """Takes a line that answers no command."""
        self._said.append(line)
        self.over = self.over or line.startswith("lost ")

    def numbered(self, number: int) -> None:
        """Takes a number of a lease."""
        self._numbers.append(number)

    def run(self, end: float, stopped: Callable[[], bool] = lambda: False) -> None:
        """Shows the screen until Ctrl-C, until ``stopped()``, or until the connection or the terminal is lost.

        Ends at the monotonic time ``end``, too.
        """
        try:
            self._run(end, stopped)
            sys.stdout.write("\n")
        except OSError as error:
            if error.errno != errno.EIO or error.filename:
                raise  # not that the terminal has closed

    def _run(self, end: float, stopped: Callable[[], bool]) -> None:
        due = 0.0
        with keyboard() as keys:
            while not self.over and not stopped() and time.monotonic() < end:
                while self._numbers:
                    self._client.respond(self._numbers.popleft())
                self._recording.drain()
                for key in keys.pressed(ANSWER):
                    self._press(key)
                if time.monotonic() >= due:
                    due = time.monotonic() + PERIOD
                    self._values.picture()
                    self._draw()

    def _press(self, key: str) -> None:
        if key in _END:
            self.over = True
        elif key == " " and not self._line:
            self._ask("disable")
        elif key in "\r\n":
            line, self._line = self._line.strip(), ""
            if line:
                self._enter(line)
        elif key in "\x08\x7f":
            self._line = self._line[:-1]
        elif key.isprintable():
            self._line += key

    def _enter(self, line: str) -> None:
        """Sends a line, but asks before it enables without a lease."""
        waits, self._unconfirmed = self._unconfirmed, ""
        if waits:
            self._ask(waits) if line == "yes" else self._said.append("not enabled")
        elif line.split()[:2] == ["enable", "unattended"]:
            self._unconfirmed = line
            self._said.append(f"{CONFIRM}: type yes")
        else:
            self._ask(line)

    def _ask(self, line: str) -> None:
        """Sends a command, and shows its answer when it comes."""
        threading.Thread(target=self._answer, args=(line, self._shown.get("stop", "")), daemon=True).start()

    def _answer(self, line: str, after: str) -> None:
        try:
            if line == "disable":
                self._client.disable()
                self._said.append("ok disable")
                return
            self._said.extend(send(self._client, line, after))
        except CommandRefused as refusal:
            self._said.append(f"error {line.split(' ')[0]} {refusal}")
        except (Lost, UnicodeEncodeError) as problem:
            self._said.append(str(problem))

    def _state(self) -> str:
        """The state, and its age if there is no news."""
        state = " ".join(f"{name}={value}" for name, value in self._shown.items())
        if self._shown.get("enabled") == "1" and "leased" not in self._shown:
            state = f"UNATTENDED {state}"
        return f"VALUES ARE OLD: no news for {self._client.age:.0f} s  {state}" if self._client.age > OLD else state

    def _draw(self) -> None:
        columns, height = shutil.get_terminal_size()
        description = self._client.description
        width = max(map(len, self._names), default=0)
        self._shown = self._client.state
        fault = self._faults.explain(self._shown)
        lines = [f"{description.name}  EPG {description.version}  {self._state()}"]
        lines += [line for text in fault or () for line in textwrap.wrap(text, columns)] + [""]
        room = height - len(lines) - LINES - 4
        for index, name in enumerate(self._names[: max(room, 1)]):
            value = f"{self._values.newest[index]:>12.6g} {self._units[index]:<6}"
            lines.append(f"{name:<{width}} {value} {sparkline(self._values.history[index])}")
        if len(self._names) > room:
            lines.append(f"... {len(self._names) - max(room, 1)} more: the window is too small")
        lines += ["", *self._said, f"> {self._line}", "space: disable   enable: while this runs   help   Ctrl-C: end"]
        sys.stdout.write("\x1b[H" + "".join(f"{line[:columns]}\x1b[K\r\n" for line in lines[:-1]))
        sys.stdout.write(f"{lines[-1][:columns]}\x1b[K\x1b[J")
        sys.stdout.flush()
