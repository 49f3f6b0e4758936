# SPDX-License-Identifier: Apache-2.0
"""Runs a build in the background: starts and cancels it, and shows its progress, messages and products.

>>> # build = Build(changed=wake_the_page)
>>> # build.start(job); build.state()["done"], build.state()["messages"], build.lines(0)
"""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Callable
from typing import Any

from epg.catalog.catalog import load_catalog
from epg.check.communication import tools_for
from epg.check.configuration import Configuration
from epg.connect.build.messages import Message, Messages, plain
from epg.connect.build.plan import make_plan
from epg.connect.build.process import Process
from epg.connect.build.products import Made, ask, products
from epg.connect.build.tools import find_tools, missing_tools
from epg.connect.projects import Job
from epg.diagnostics import Diagnostics
from epg.project import Request, load_configuration

KEPT = 20_000
"""The number of lines of output that can be read again; older ones are forgotten."""
WIDEST = 4_000
"""The largest number of characters of a line; longer ones are cut."""
OFTEN = 0.2
"""The least seconds between two calls of ``changed`` for progress alone."""
FORGOTTEN = "..."
_PROGRESS = re.compile(r"\[ *(?P<done>\d+)(?:/(?P<total>\d+)|%)\] (?P<action>.*)")


class Build:
    """One build in a separate thread, idle until its start.  ``changed`` is called when there is something new to show.

    All methods can be called by any thread.  Only :meth:`wait` blocks.
    """

    def __init__(self, changed: Callable[[], None]) -> None:
        self._changed = changed
        self._lock = threading.Lock()
        self._lines: list[str] = []
        self._messages: Messages | None = None
        self._found: list[Message] = []
        self._products: list[Made] = []
        self._state, self._step, self._action = "idle", "", ""
        self._done, self._total = 0, 0
        self._began = self._ended = self._told = 0.0
        self._process: Process | None = None
        self._cancelled = False
        self._thread: threading.Thread | None = None

    @property
    def is_running(self) -> bool:
        return self._state == "running"

    def start(self, job: Job) -> None:
        """Starts the build of ``job``.  It can be called once for each object."""
        with self._lock:
            assert self._thread is None, "a build is started once"
            self._state, self._began = "running", time.monotonic()
            self._thread = threading.Thread(target=self._run, args=(job,), name="build", daemon=True)
        self._thread.start()
        self._changed()

    def cancel(self) -> None:
        """Asks the build and all programs that it has started to end.  The build is over when its state says so."""
        with self._lock:
            self._cancelled = True
            process = self._process
        if process is not None:
            process.cancel()

    def wait(self, seconds: float | None = None) -> bool:
        """Waits at most ``seconds`` for the end of the build.  Returns True if it is over."""
        if self._thread is not None:
            self._thread.join(seconds)
        return self._thread is None or not self._thread.is_alive()

    def state(self) -> dict[str, Any]:
        """The state of the build, with the keys of the page's "build".  ``seconds`` is the time that it has taken."""
        with self._lock:
            now = self._ended or time.monotonic()
            found = self._messages.all if self._messages is not None else self._found
            return {
                "state": self._state,
                "step": self._step,
                "action": self._action,
                "done": self._done,
                "total": self._total,
                "seconds": round(now - self._began, 1) if self._began else 0.0,
                "messages": [message.data() for message in found],
                "products": [{"path": str(made.path), "what": made.what} for made in self._products],
                "lines": len(self._lines),
            }

    def lines(self, start: int) -> list[str]:
        """The lines of output from number ``start`` on; the first has number 0."""
        with self._lock:
            return self._lines[max(start, 0) :]

    # The methods below run in the build's thread. ---------------------------------------------------------------------

    def _run(self, job: Job) -> None:
        state, found = "failed", [Message("error", "the build could not be started", id="build-failed")]
        made: list[Made] = []
        try:
            state, found, made = self._build(job)
        except OSError as error:
            found = [Message("error", f"{error.filename or 'the build'}: {error.strerror or error}", id="build-failed")]
        finally:
            with self._lock:
                self._state, self._found, self._products, self._messages = state, found, made, None
                self._ended, self._action = time.monotonic(), ""
            self._changed()

    def _build(self, job: Job) -> tuple[str, list[Message], list[Made]]:
        request = job.request
        configuration = _configuration(request)
        target = configuration.target if configuration is not None else None
        plan = make_plan(job, target)
        if plan.missing:
            return "failed", list(plan.missing), []
        messages = Messages((plan.source, plan.build))
        with self._lock:
            self._messages = messages
        ask(plan.build)
        for step in plan.steps:
            status = self._run_step(step.name, Process(step.command, step.folder, plan.environment, self._read))
            if self._cancelled:
                return "cancelled", messages.finish(failed=False), []
            if status != 0:
                found = messages.finish(failed=True)
                if step.name == "configure" and configuration is not None:
                    said = " ".join(message.message for message in found)
                    names = sorted(tools_for(configuration.target, configuration.communication))
                    needed = find_tools(names, request.roots, plan.cache)
                    lacking = missing_tools(needed, request.roots, plan.cache)
                    found += [message for title, message in lacking.items() if title not in said]
                return "failed", found, []
        platform = target.platform if target is not None else None
        return "done", messages.finish(failed=False), products(plan.build, request.name, platform, job.executables)

    def _run_step(self, name: str, process: Process) -> int:
        with self._lock:
            self._process, self._step, self._action = process, name, ""
            self._done = self._total = 0
            if self._cancelled:
                return -1
        self._changed()
        return process.run()

    def _read(self, line: str) -> None:
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
            if self._messages is not None and not self._cancelled:  # no messages about the user's own interruption
                self._messages.read(text)
            now = time.monotonic()
            tell = now - self._told > OFTEN
            self._told = now if tell else self._told
        if tell:
            self._changed()


def _configuration(request: Request) -> Configuration | None:
    """The target's configuration; None if it has an error, which the build reports."""
    diagnostics = Diagnostics()
    return load_configuration(request, load_catalog(request.roots, diagnostics), diagnostics)
