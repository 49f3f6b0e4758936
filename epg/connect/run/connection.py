# SPDX-License-Identifier: Apache-2.0
"""The connection of the page to a running target.

The page gets events: points of the plots, numbers of a lease, lines that the target tells, and its state with its age.
This module never answers a number itself: only the page that has enabled the target does, so a page that is closed,
hidden or hangs ends the lease.  A page that gets no values or answers too late cannot move anything.
"""

from __future__ import annotations

import contextlib
import math
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

from epg.connect.body import Refused
from epg.connect.run.captures import Captures
from epg.connect.run.late import BEAT, Late, Lateness
from epg.connect.run.listener import Listener
from epg.connect.run.live_comparison import Driven
from epg.generator import bootstrap
from epg.live import client as protocol
from epg.live.buckets import Buckets
from epg.live.client import Client, Lost, now, words_of
from epg.live.durations import Durations
from epg.live.enabling import CONFIRM, is_unattended
from epg.live.faults import Faults
from epg.live.history import MOST as MOST_BYTES
from epg.live.history import History
from epg.live.open import open_port
from epg.live.rows import File, Recorder, Stream
from epg.runs.csv_file import CsvFile
from epg.runs.mcap_file import McapRows
from epg.runs.recording import Row

WIDTH = 0.01
"""Seconds of a point."""
MOST = 32
"""The largest number of signals in a stream."""
ASK = 0.3
"""Seconds between two questions for the state of a target that has no stream."""
READING = ("get", "stats", "ports", "version", "help", "disable")
"""Commands that a target with another firmware also gets, and a page that gets no values can send."""
OLD = 1.0
"""Seconds without news after which values are old."""
SETTLED = 0.2
"""Seconds after the end of a lease until all has arrived that shows who was late."""


class LiveConnection:
    """An open port with its client, and the pages that listen."""

    def __init__(self, path: Path, expected: str, baud: int, faults: Faults, changed: Callable[[str], None]) -> None:
        self._changed, self._faults = changed, faults
        self._path, self._expected = path, expected
        self._owner = ""  # the page that has enabled the target
        self._mover = ""  # the page that has moved it by hand
        self._enabled = self._leased = False
        self._ended: float | None = None  # the time at which a lease has ended, until it is known who was late
        self._late: Late | None = None
        self._listeners: list[Listener] = []
        self._over = threading.Event()
        self._clock: float | None = None  # the monotonic time at the first row of the stream
        self._enabled_at: float | None = None  # the time in the stream at which the target was enabled
        self._disabled_at = math.inf
        self._newest: dict[str, float] = {}  # the setpoints that were sent last
        self._setpoints: list[tuple[float, str, float]] = []  # those since enabling, with their times in the stream
        self._port = open_port(path, baud)
        try:
            self._client = Client(self._port, self._told, self._numbered)
        except BaseException:
            self._port.close()
            raise
        try:
            self._captures = Captures(self._client, self._over, lambda: changed(""))
            self._enabled = self._client.state.get("enabled") == "1"
            self._setpoints_now = self._client.description.setpoints
            self._parameters = self._client.description.parameters
            description = self._client.description
            self._signals = description.signals[: MOST - len(description.loop)] + description.loop
            self._names = [signal.name for signal in self._signals]
            self._buckets = Buckets(len(self._names), WIDTH)
            self._folder = _folder()
            self._history = History(len(self._names), folder=self._folder)
            self._saving: float | None = None  # the part of a file that is written
            self._durations = Durations([self._names.index(signal.name) for signal in description.loop])
            stream = Stream(self._names)
            self._lateness = Lateness(stream)
            self._recording = Recorder(stream, [self._buckets, self._history, self._durations, self._lateness])
            self._every = 0
            if self._names:
                indices = [description.streamed.index(signal) for signal in self._signals]
                with contextlib.suppress(protocol.CommandRefused):  # a target without memory for streams
                    self._every = self._recording.start(self._client, indices, 1)
        except BaseException:
            self.close()
            raise
        for act in (self._collect, self._ask):
            threading.Thread(target=act, name="live", daemon=True).start()

    @property
    def _matches(self) -> bool:
        return self._expected in ("", self._client.description.hash)

    def state(self) -> dict[str, Any]:
        description = self._client.description
        state = self._words()
        return {
            "path": str(self._path),
            "name": description.name,
            "version": description.version,
            "hash": description.hash,
            "matches": self._matches,
            "period": description.period,
            "every": self._every,
            "state": state,
            "fault": self._fault(state),
            "signals": [
                {"name": signal.name, "unit": signal.unit, "loop": signal in description.loop}
                for signal in self._signals
            ],
            "capture": dict(self._captures.state),
            "setpoints": [asdict(setpoint) for setpoint in self._setpoints_now],
            "actuators": list(description.actuators),
            "parameters": [asdict(parameter) for parameter in self._parameters],
        }

    def command(self, page: str, line: str, after: str, *, unattended: bool) -> list[str]:
        """Sends a line of ``page``.  ``enable`` is on a lease; ``unattended``: the user has agreed to go without.

        ``after`` is the number of the newest stop that the page showed.
        """
        command, *_ = line.split() or [""]
        self._check(command)
        if command not in (*READING, "capture"):
            self._check_page(page, leases=command in ("enable", "jog"))
        with _refusals():
            enabling = is_unattended(line)
        if enabling is None:
            return self._sent(line)
        if enabling and not unattended:
            raise Refused("'enable unattended' must be confirmed", CONFIRM, 409)
        return self._enable(page, after, unattended=enabling)

    def enable(self, page: str, after: str) -> None:
        self.command(page, "enable", after, unattended=False)

    def _enable(self, page: str, after: str, *, unattended: bool) -> list[str]:
        before, self._owner = self._owner, page
        self._lateness.begin()
        try:
            with _refusals():
                return self._client.enable(after, unattended=unattended)
        except Refused:
            self._owner = before
            raise

    def _sent(self, line: str) -> list[str]:
        with _refusals():
            begin = self._now()
            answer = self._client.command(line)
        if answer[-1] == "ok setpoint":
            self._keep_setpoints(line, begin)
        if line.startswith("set "):
            self._parameters = self._client.parameters()
            self._changed("")
        if line.startswith("capture "):
            self._captures.begun(answer[-1])
        return answer

    def look(self) -> None:
        """Asks where the target will move when it is enabled."""
        with _refusals():
            setpoints = self._client.setpoints()
        if setpoints != self._setpoints_now:
            self._setpoints_now = setpoints
            self._changed("")

    def respond(self, page: str, number: int) -> None:
        at = now()
        for listener in list(self._listeners):
            if listener.page == page:
                listener.answers.returned(number, at)
        if page == self._owner and 0 <= number < 1 << 32:
            self._client.respond(number)
            self._lateness.answered(number, at)

    def move(self, page: str, actuator: str, duty: float, number: int) -> None:
        self._check("jog")
        self._check_page(page, leases=True)
        if actuator not in self._client.description.actuators:
            raise Refused(f"there is no actuator '{actuator}'", status=404)
        if not 0 <= number < 1 << 32:
            raise Refused("'number' must be one that the target has sent")
        self._mover = page
        self._client.move(actuator, duty, number)

    def stop(self) -> None:
        try:
            self._client.disable()
        except (Lost, protocol.CommandRefused) as problem:
            raise Refused(str(problem), "switch the actuators' supply off", 409) from None

    def events(self, page: str) -> Iterator[dict[str, Any]]:
        listener = Listener(page)
        self._listeners.append(listener)
        try:
            while not self._over.is_set():
                event = listener.next(probes=not (self._leased and page == self._owner))
                yield {
                    **event,
                    "age": self._client.age,
                    "old": self._is_old,
                    "state": self._words(),
                    "kept": self._kept(),
                }
        finally:
            self._listeners.remove(listener)

    def _kept(self) -> dict[str, Any]:
        """The rows that can be saved, in the events of the page."""
        return {
            "since": self._history.since / 1e9,
            "size": self._history.size,
            "most": MOST_BYTES,
            "problem": self._history.problem,
            "saving": self._saving,
        }

    @contextlib.contextmanager
    def save(self, what: str, form: str) -> Iterator[Path]:
        """A file with the rows, as long as the context lasts."""
        if what == "capture":
            recorded = self._captures.last()
            names, rows, begin, count = recorded.names, iter(recorded.rows), time.time_ns(), len(recorded.rows)
        else:
            names, rows, begin = tuple(self._names), self._history.rows(), self._history.begin
            count = self._history.count
        if form == "mcap":
            try:
                bootstrap.ensure("mcap")
            except bootstrap.MissingPackages as problem:
                raise Refused("a package for MCAP files is missing", str(problem), 409) from None
        with tempfile.TemporaryDirectory(dir=self._folder) as folder:
            path = Path(folder) / "rows"
            topic = f"/{self._client.description.node or 'target'}"
            try:
                file: File = CsvFile(path, names) if form == "csv" else McapRows(path, names, topic, begin)
                file.write(self._counted(rows, count))
                file.close()
            except OSError as error:
                raise Refused(f"the file cannot be written: {error.strerror}", "make room on the disk", 409) from None
            finally:
                self._saving = None
            yield path

    def _counted(self, rows: Iterable[Row], count: int) -> Iterator[Row]:
        """``rows``, of which there are about ``count``; the page is told how many have been taken."""
        for number, row in enumerate(rows):
            if number % 1000 == 0:
                self._saving = number / count
            yield row

    def driven(self) -> Driven:
        begin = self._enabled_at
        if begin is None:
            message = "the target was not enabled while the page was connected"
            raise Refused(message, "stop it, enable it, move it, and compare then", 409)
        rows = [Row(row.time - begin, row.values) for row in self._history.rows(begin) if row.time < self._disabled_at]
        if not rows or rows[0].time > 1.0:
            raise Refused("the values since enabling are not kept any more", "stop and enable the target again", 409)
        setpoints = [(time - begin, name, value) for time, name, value in self._setpoints]
        changed = tuple(each.name for each in self._parameters if each.value != each.generated)
        return Driven(tuple(self._names), rows, setpoints, changed)

    def recorded(self) -> dict[str, Any]:
        recorded = self._captures.last()
        columns = zip(*(row.values for row in recorded.rows), strict=True)
        return {
            "names": recorded.names,
            "times": [row.time for row in recorded.rows],
            "columns": [[value if math.isfinite(value) else None for value in column] for column in columns],
            "triggered": recorded.triggered,
        }

    def durations(self) -> dict[str, Any]:
        names = [signal.name for signal in self._client.description.loop]
        return {name: found.data() for name, found in zip(names, self._durations.histograms, strict=True)}

    def close(self) -> None:
        self._over.set()
        self._client.stop()
        self._port.close()
        self._history.close()

    def _now(self) -> float:
        """The time in the stream."""
        return time.monotonic() - self._clock if self._clock is not None else 0.0

    def _keep_setpoints(self, line: str, now: float) -> None:
        """Keeps the setpoints of a line for a comparison with the simulation."""
        known = [setpoint.name for setpoint in self._client.description.setpoints]
        values = {name if name in known else f"/{name}": float(value) for name, value in words_of(line)}
        self._newest |= values
        if now < self._disabled_at:
            self._setpoints += [(now, name, value) for name, value in values.items()]

    def _keep_state(self, enabled: bool) -> None:
        now = self._now()
        if enabled:
            self._enabled_at, self._disabled_at = now, math.inf
            self._setpoints = [(now, name, value) for name, value in self._newest.items()]
        elif self._enabled_at is not None:
            self._disabled_at = min(self._disabled_at, now)

    def _words(self) -> dict[str, str]:
        """The words of the target's state."""
        return self._client.state or {"enabled": "0"}

    def _fault(self, state: dict[str, str]) -> dict[str, str] | None:
        """The latched fault in words; if a lease has ended, also who was late."""
        fault = self._faults.explain(state)
        if fault is None:
            return None
        late = self._late if state["fault"] == "operator" else None
        return {"text": f"{fault.text} {late.text}", "remedy": late.remedy} if late is not None else fault._asdict()

    @property
    def _is_old(self) -> bool:
        every = max(self._every, 1) * self._client.description.period
        return self._client.age > max(OLD, 3 * every)

    def _check_page(self, page: str, *, leases: bool) -> None:
        """Raises Refused if the page gets no values of the target, or does not answer; ``leases``: in time."""
        if self._is_old:
            raise Refused("the values are old", "look at the target and its cable, or connect again", 409)
        found = [listener.answers for listener in list(self._listeners) if listener.page == page]
        if not any(each.are_in_time(now()) if leases else each.are_coming(now()) for each in found):
            message = "this page does not answer in time: a target that it enables would be disabled at once"
            raise Refused(message, "wait two seconds; show fewer plots, and close other pages and programs", 409)

    def _check(self, command: str) -> None:
        if not self._matches and command not in READING:
            message = (
                f"the target has the firmware {self._client.description.hash}, not {self._expected} of the last build"
            )
            raise Refused(message, "flash it, or generate again", 409)

    def _collect(self) -> None:
        while not self._over.wait(BEAT):
            self._lateness.beat(now())
            self._recording.drain()
            if self._history.newest is not None:
                # The first row arrived at the latest when the quickest row says so.
                clock = time.monotonic() - self._history.newest
                self._clock = clock if self._clock is None else min(self._clock, clock)
            found = self._buckets.take()
            stream = self._recording.stream
            for listener in list(self._listeners):
                listener.add_points(found, stream.dropped)
            ended, at = self._ended, now()
            if ended is not None and at > ended + SETTLED:
                self._ended, self._late = None, self._lateness.find(ended, at)
                self._changed("")

    def _ask(self) -> None:
        """Asks for the state of a target without a stream, which would otherwise tell nothing for long."""
        while not self._every and not self._over.wait(ASK):
            with contextlib.suppress(Lost, protocol.CommandRefused):
                self._client.command("stats")

    def _told(self, line: str) -> None:
        if line.startswith("state "):
            self._state_told(self._client.state)
        lost = line.removeprefix("lost ") if line.startswith("lost ") else ""
        for listener in list(self._listeners):
            listener.add_line(line)
        if line.startswith(("state ", "lost ")):
            if lost:
                self._over.set()
            self._changed(lost)

    def _state_told(self, state: dict[str, str]) -> None:
        enabled = state.get("enabled") == "1"
        if enabled != self._enabled:
            self._enabled = enabled
            self._keep_state(enabled)
        if self._leased and not enabled:
            self._late = None
            self._ended = now() if state.get("fault") == "operator" else None
        self._leased = "leased" in state

    def _numbered(self, number: int) -> None:
        at = now()
        self._lateness.arrived(number, at)
        for listener in list(self._listeners):
            if listener.page == self._owner:
                listener.add_number(number, at)
            if listener.page == self._mover:
                listener.add_moving(number)


def _folder() -> Path | None:
    """The folder for the rows: EPG's cache, because the folder for temporary files is in the memory of many systems.

    None for the latter, if the cache cannot be used.
    """
    try:
        bootstrap.check_cache()
        folder = bootstrap.cache_folder()
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except (bootstrap.MissingPackages, OSError):
        return None


@contextlib.contextmanager
def _refusals() -> Iterator[None]:
    """Raises Refused for an answer of the target that is an error, or if there is none."""
    try:
        yield
    except protocol.CommandRefused as refusal:
        raise Refused(str(refusal), "'help' lists the commands", 409) from None
    except UnicodeEncodeError:
        raise Refused("a command has ASCII characters only") from None
    except Lost as problem:
        raise Refused(str(problem), "look at the cable", 409) from None
