# SPDX-License-Identifier: Apache-2.0
"""Work in the background that starts programs: a build, a simulation, a run of a program, flashing.

>>> # build = Build(changed=wake_the_page)
>>> # build.start(job); build.state()["done"], build.state()["messages"], build.lines(0)
"""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from pathlib import Path
from typing import Any, ClassVar

from epg.connect.build.build_messages import BuildMessage, Messages, plain
from epg.connect.build.process import Process
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import UserError

KEPT = 20_000
"""The number of lines of output that can be read again; older ones are forgotten."""
WIDEST = 4_000
"""The largest number of characters of a line; longer ones are cut."""
OFTEN = 0.2
"""The least seconds between two calls of ``changed`` for progress alone."""
FORGOTTEN = "..."
_PROGRESS = re.compile(r"\[ *(?P<done>\d+)(?:/(?P<total>\d+)|%)\] (?P<action>.*)")


@dataclass(frozen=True)
class Outcome:
    """The end of an activity.  ``state`` is "done", "failed" or "cancelled".  ``more`` are other values to show."""

    state: str
    messages: Sequence[BuildMessage] = ()
    more: Mapping[str, Any] = field(default_factory=dict)


class Activity:
    """Work in a separate thread, idle until its start.  ``changed`` is called when there is something new to show.

    All methods can be called by any thread.  Only :meth:`wait` blocks.
    """

    more: ClassVar[Mapping[str, Any]] = {}
    """The values of :attr:`Outcome.more` until the end: the initial value of ``shown``."""

    def __init__(self, changed: Callable[[], None]) -> None:
        self._changed = changed
        self.shown = dict(self.more)
        self._lock = threading.Lock()
        self._lines: list[str] = []
        self._reader: Messages | None = None
        self._outcome = Outcome("idle")
        self._step, self._action = "", ""
        self._done, self._total = 0, 0
        self._began = self._ended = self._told = 0.0
        self._process: Process | None = None
        self._cancelled = False
        self._thread: threading.Thread | None = None

    @property
    def is_running(self) -> bool:
        return self._outcome.state == "running"

    @property
    def is_cancelled(self) -> bool:
        return self._cancelled

    def cancel(self) -> None:
        """Asks all programs that the activity has started to end.  It is over when its state says so."""
        with self._lock:
            self._cancelled = True
            process = self._process
        if process is not None:
            process.cancel()

    def wait(self, seconds: float | None = None) -> bool:
        """Waits at most ``seconds`` for the end.  Returns True if the activity is over."""
        if self._thread is not None:
            self._thread.join(seconds)
        return self._thread is None or not self._thread.is_alive()

    def state(self) -> dict[str, Any]:
        """The state for the page.  ``seconds`` is the time that the activity has taken."""
        with self._lock:
            now = self._ended or time.monotonic()
            found = self._reader.all if self._reader is not None else self._outcome.messages
            return {
                "state": self._outcome.state,
                "step": self._step,
                "action": self._action,
                "done": self._done,
                "total": self._total,
                "seconds": round(now - self._began, 1) if self._began else 0.0,
                "messages": [message.data() for message in found],
                "lines": len(self._lines),
                **self.shown,
                **self._outcome.more,
            }

    def lines(self, start: int) -> list[str]:
        """The lines of output from number ``start`` on; the first has number 0."""
        with self._lock:
            return self._lines[max(start, 0) :]

    def begin(self, work: Callable[[], Outcome]) -> None:
        """Does ``work`` in the background.  It can be called once for each object."""
        with self._lock:
            assert self._thread is None, "an activity is started once"
            self._outcome, self._began = Outcome("running"), time.monotonic()
            self._thread = threading.Thread(target=self._do, args=(work,), name=type(self).__name__, daemon=True)
        self._thread.start()
        self._changed()

    # The methods below are for the activity's thread. -----------------------------------------------------------------

    def read_messages(self, reader: Messages) -> None:
        """Lets ``reader`` read the output from now on, and shows its messages."""
        with self._lock:
            self._reader = reader

    def found_messages(self) -> list[BuildMessage]:
        """The messages in the output of a program that has failed."""
        return self._reader.finish(failed=True) if self._reader is not None else []

    def run(
        self,
        step: str,
        command: Sequence[str],
        folder: Path,
        environment: Mapping[str, str],
        *,
        patience: float | None = None,
        line: Callable[[str], None] | None = None,
        modest: bool = False,
        bound: bool = False,
    ) -> int:
        """Runs a program as the step called ``step``.  Returns its exit status.  Raises OSError.

        ``patience`` is the time in seconds after which the program is ended; None for no limit.  ``line`` gets its
        lines of output in place of :meth:`read`.  ``modest`` and ``bound`` are those of :class:`Process`.
        """
        process = Process(command, folder, environment, line or self.read, modest=modest, bound=bound)
        with self._lock:
            self._process, self._step, self._action = process, step, ""
            self._done = self._total = 0
            if self._cancelled:
                return -1
        self._changed()
        timer = threading.Timer(patience, process.cancel) if patience is not None else None
        if timer is not None:
            timer.daemon = True
            timer.start()
        try:
            return process.run()
        finally:
            if timer is not None:
                timer.cancel()

    def progress(self, step: str, done: int, total: int) -> None:
        """Shows the progress of work without a program."""
        with self._lock:
            self._step, self._done, self._total = step, done, total
        self._changed()

    def read(self, line: str) -> None:
        """Keeps a line of output, and takes progress and messages from it."""
        text = plain(line[: 2 * WIDEST])[:WIDEST]
        progress = _PROGRESS.match(text)
        with self._lock:
            self._lines.append(text)
            if len(self._lines) > KEPT:
                self._lines[len(self._lines) - KEPT - 1] = FORGOTTEN
            if progress is not None:
                self._done, self._total = int(progress["done"]), int(progress["total"] or 100)
                self._action = progress["action"]
            elif text.startswith("-- "):
                self._action = text.removeprefix("-- ")
            if self._reader is not None and not self._cancelled:  # no messages about the user's own interruption
                self._reader.read(text)
            now = time.monotonic()
            tell = now - self._told > OFTEN
            self._told = now if tell else self._told
        if tell:
            self._changed()

    def _do(self, work: Callable[[], Outcome]) -> None:
        outcome = Outcome(
            "failed", [BuildMessage("error", "this is a bug in EPG: the terminal shows it", id="run-failed")]
        )
        try:
            outcome = work()
        except UserError as problem:
            outcome = Outcome("failed", [message_of(each.data()) for each in problem.diagnostics])
        except OSError as error:
            text = f"{error.filename or 'the program'}: {error.strerror or error}"
            outcome = Outcome("failed", [BuildMessage("error", text, id="run-failed")])
        finally:
            with self._lock:
                self._outcome, self._reader, self._process = outcome, None, None
                self._ended, self._action = time.monotonic(), ""
            self._changed()


def message_of(data: Mapping[str, Any]) -> BuildMessage:
    """A diagnostic of the command line, from its JSON, as a message."""
    keys = ("severity", "message", "file", "line", "column", "hint", "id")
    return BuildMessage(**{key: data[key] for key in keys if data.get(key) is not None})
