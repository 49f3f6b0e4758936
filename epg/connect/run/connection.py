# SPDX-License-Identifier: Apache-2.0
"""The connection of the page to a running target.

The page gets events: points of the plots, numbers of a lease, and lines that the target tells.  This module never
answers a number itself: only the page that has enabled the target does, so a page that is closed, hidden or hangs ends
the lease.
"""

from __future__ import annotations

import contextlib
import math
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from epg import bootstrap
from epg.connect.body import Refused
from epg.connect.run.compare import Driven
from epg.connect.run.listener import PERIOD, Listener
from epg.live import client as protocol
from epg.live.buckets import Buckets
from epg.live.capture import Recorded, progress_of, recorded_of
from epg.live.client import Client, Lost, words_of
from epg.live.durations import Durations
from epg.live.faults import Faults
from epg.live.history import History
from epg.live.open import open_port
from epg.live.rows import CsvFile, McapFile, Recording, Row, Sink, Stream

WIDTH = 0.01
"""Seconds of a point."""
MOST = 32
"""The largest number of signals in a stream."""
ASK = 0.3
"""Seconds between two looks at the progress of a recording."""
READING = ("get", "stats", "ports", "version", "help", "disable")
"""Commands that a target with another firmware also gets."""


class Connection:
    """An open port with its client, and the pages that listen."""

    def __init__(self, path: Path, expected: str, baud: int, faults: Faults, changed: Callable[[str], None]) -> None:
        self._changed, self._faults = changed, faults
        self._path, self._expected = path, expected
        self._owner = ""  # the page that has enabled the target
        self._state = "enabled=0"
        self._listeners: list[Listener] = []
        self._over = threading.Event()
        self._clock: float | None = None  # the monotonic time at the first row of the stream
        self._enabled_at: float | None = None  # the time in the stream at which the target was enabled
        self._disabled_at = math.inf
        self._newest: dict[str, float] = {}  # the setpoints that were sent last
        self._setpoints: list[tuple[float, str, float]] = []  # those since enabling, with their times in the stream
        self._capture: dict[str, Any] = {"state": "none", "rows": 0, "wanted": 0, "number": 0}
        self._recorded: Recorded | None = None
        self._follower: threading.Thread | None = None
        self._port = open_port(path, baud)
        try:
            self._client = Client(self._port, self._told, self._numbered)
        except BaseException:
            self._port.close()
            raise
        try:
            self._state = self._client.command("stats")[0].removeprefix("stat ")
            self._parameters = self._client.description.parameters
            found = self._client.description
            self._signals = found.signals[: MOST - len(found.loop)] + found.loop
            self._names = [signal.name for signal in self._signals]
            self._buckets = Buckets(len(self._names), WIDTH)
            self._history = History(len(self._names))
            self._durations = Durations([self._names.index(signal.name) for signal in found.loop])
            self._recording = Recording(Stream(self._names), [self._buckets, self._history, self._durations])
            self._every = 0
            if self._names:
                indices = [found.streamed.index(signal) for signal in self._signals]
                with contextlib.suppress(protocol.Refused):  # a target without memory for streams
                    self._every = self._recording.start(self._client, indices, 1)
        except BaseException:
            self.close()
            raise
        self._thread = threading.Thread(target=self._collect, name="live", daemon=True)
        self._thread.start()

    @property
    def _matches(self) -> bool:
        return self._expected in ("", self._client.description.hash)

    def state(self) -> dict[str, Any]:
        found = self._client.description
        state = dict(words_of(self._state))
        fault = self._faults.explain(state)
        return {
            "path": str(self._path),
            "name": found.name,
            "version": found.version,
            "hash": found.hash,
            "matches": self._matches,
            "period": found.period,
            "every": self._every,
            "state": state,
            "fault": fault._asdict() if fault is not None else None,
            "signals": [
                {"name": signal.name, "unit": signal.unit, "loop": signal in found.loop} for signal in self._signals
            ],
            "capture": dict(self._capture),
            "setpoints": list(found.setpoints),
            "actuators": list(found.actuators),
            "parameters": [
                {
                    "name": each.name,
                    "value": each.value,
                    "generated": each.generated,
                    "unit": each.unit,
                    "low": each.low,
                    "high": each.high,
                }
                for each in self._parameters
            ],
        }

    def command(self, line: str) -> list[str]:
        self._check(line.split(" ")[0])
        try:
            now = self._now()
            answer = self._client.command(line)
            if answer[-1] == "ok setpoint":
                self._keep_setpoints(line, now)
            if line.startswith("set "):
                self._parameters = self._client.parameters()
                self._changed("")
            wanted = dict(words_of(answer[-1])).get("rows") if line.startswith("capture ") else None
            if wanted is not None and (self._follower is None or not self._follower.is_alive()):
                self._capture |= {"state": "recording", "rows": 0, "wanted": int(wanted)}
                self._follower = threading.Thread(target=self._follow_capture, name="capture", daemon=True)
                self._follower.start()
                self._changed("")
            return answer
        except protocol.Refused as refusal:
            raise Refused(str(refusal), "'help' lists the commands", 409) from None
        except UnicodeEncodeError:
            raise Refused("a command has ASCII characters only") from None
        except Lost as problem:
            raise Refused(str(problem), "look at the cable", 409) from None

    def enable(self, page: str) -> None:
        self._check("enable")
        self._owner = page
        self.command("enable leased")

    def respond(self, page: str, number: int) -> None:
        if page == self._owner and 0 <= number < 1 << 32:
            self._client.respond(number)

    def move(self, actuator: str, duty: float) -> None:
        self._check("jog")
        if actuator not in self._client.description.actuators:
            raise Refused(f"there is no actuator '{actuator}'", status=404)
        self._client.move(actuator, duty)

    def stop(self) -> None:
        try:
            self._client.disable()
        except (Lost, protocol.Refused) as problem:
            raise Refused(str(problem), "switch the actuators' supply off", 409) from None

    def events(self) -> Iterator[dict[str, Any]]:
        listener = Listener()
        self._listeners.append(listener)
        try:
            while not self._over.is_set():
                yield listener.next()
        finally:
            self._listeners.remove(listener)

    def save(self, what: str, form: str) -> bytes:
        if what == "capture":
            recorded = self._last_recorded()
            names, rows, begin = recorded.names, iter(recorded.rows), time.time_ns()
        else:
            names, rows, begin = tuple(self._names), self._history.rows(), self._history.begin
        if form == "mcap":
            try:
                bootstrap.ensure("mcap")
            except bootstrap.MissingPackages as problem:
                raise Refused("a package for MCAP files is missing", str(problem), 409) from None
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "rows"
            topic = f"/{self._client.description.node or 'target'}"
            sink: Sink = CsvFile(path, names) if form == "csv" else McapFile(path, names, topic, begin)
            sink.write(rows)
            sink.close()
            return path.read_bytes()

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
        recorded = self._last_recorded()
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

    def _now(self) -> float:
        """The time in the stream."""
        return time.monotonic() - self._clock if self._clock is not None else 0.0

    def _keep_setpoints(self, line: str, now: float) -> None:
        """Keeps the setpoints of a line for a comparison with the simulation."""
        known = self._client.description.setpoints
        found = {name if name in known else f"/{name}": float(value) for name, value in words_of(line)}
        self._newest |= found
        if now < self._disabled_at:
            self._setpoints += [(now, name, value) for name, value in found.items()]

    def _keep_state(self, enabled: bool) -> None:
        now = self._now()
        if enabled:
            self._enabled_at, self._disabled_at = now, math.inf
            self._setpoints = [(now, name, value) for name, value in self._newest.items()]
        elif self._enabled_at is not None:
            self._disabled_at = min(self._disabled_at, now)

    def _last_recorded(self) -> Recorded:
        recorded = self._recorded
        if recorded is None:
            raise Refused("nothing has been recorded", "start a recording first", 409)
        return recorded

    def _follow_capture(self) -> None:
        """Shows the progress of a recording, and reads it when it is complete."""
        with contextlib.suppress(Lost):
            while not self._over.is_set():
                progress = progress_of(self._client.command("capture")[-1])
                if not progress.recording:
                    with contextlib.suppress(protocol.Refused):  # another one has begun
                        self._recorded = recorded_of(self._client.command("capture read"), progress.trigger)
                        number = self._capture["number"] + 1
                        self._capture |= {"state": "ready", "rows": progress.rows, "number": number}
                        break
                elif progress.rows != self._capture["rows"]:
                    self._capture["rows"] = progress.rows
                    self._changed("")
                self._over.wait(ASK)
            self._changed("")

    def _check(self, command: str) -> None:
        if not self._matches and command not in READING:
            message = (
                f"the target has the firmware {self._client.description.hash}, not {self._expected} of the last build"
            )
            raise Refused(message, "flash it, or generate again", 409)

    def _collect(self) -> None:
        while not self._over.wait(PERIOD):
            self._recording.drain()
            if self._history.newest is not None:
                # The first row arrived at the latest when the quickest row says so.
                clock = time.monotonic() - self._history.newest
                self._clock = clock if self._clock is None else min(self._clock, clock)
            found = self._buckets.take()
            stream = self._recording.stream
            for listener in list(self._listeners):
                listener.add_points(found, stream.dropped)

    def _told(self, line: str) -> None:
        if line.startswith("state "):
            before, self._state = self._state, line.removeprefix("state ")
            if ("enabled=1" in before) != ("enabled=1" in self._state):
                self._keep_state("enabled=1" in self._state)
        lost = line.removeprefix("lost ") if line.startswith("lost ") else ""
        for listener in list(self._listeners):
            listener.add_line(line)
        if line.startswith(("state ", "lost ")):
            if lost:
                self._over.set()
            self._changed(lost)

    def _numbered(self, number: int) -> None:
        for listener in list(self._listeners):
            listener.add_number(number)
