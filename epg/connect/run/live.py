# SPDX-License-Identifier: Apache-2.0
"""The page's access to a running target: at most one connection at a time.

>>> # live = Live(changed=wake_the_page)
>>> # live.connect(Path("/dev/ttyACM0"), expected="a30d631d6d9f2052"); live.command("set Pan\\\\PID\\\\kp=2.2")
"""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from epg.connect.body import Refused
from epg.connect.projects import Job
from epg.connect.run.compare import Driven
from epg.connect.run.connection import Connection
from epg.live import client as protocol
from epg.live.client import Lost
from epg.live.faults import Faults
from epg.live.found import ports
from epg.live.port import PortError


def built_hash(job: Job) -> str:
    """The hash of the firmware that was built last for a target; empty if there is none."""
    if job.build_dir is None:
        return ""
    name = job.request.name
    try:
        description = json.loads((job.build_dir / "epg" / name / f"{name}.json").read_text(encoding="utf-8"))
        return str(description["hash"])
    except (OSError, ValueError, KeyError, TypeError):
        return ""


class Live:
    """One connection to a target.  ``changed`` is called, by any thread, when :meth:`state` has changed."""

    def __init__(self, changed: Callable[[], None]) -> None:
        self._changed = changed
        self._lock = threading.Lock()
        self._connected: Connection | None = None
        self._problem: dict[str, str] | None = None

    def connect(self, path: Path, expected: str, baud: int = 115200, roots: Sequence[Path] = ()) -> None:
        """Connects with the target behind ``path``.  ``expected`` is the hash of the firmware that was built; "": none.

        ``roots`` are the folders of targets that describe its faults.  Raises Refused.
        """
        with self._lock:
            if self._connected is not None:
                raise Refused("a target is connected", "disconnect it first", 409)
            self._problem = None
            try:
                self._connected = Connection(path, expected, baud, Faults(roots), self._state_changed)
            except PortError as problem:
                raise Refused(str(problem), problem.hint, 409) from None
            except (Lost, protocol.Refused) as problem:
                hint = "the firmware needs the console on this port; reset the board, look at the cable"
                raise Refused(str(problem), hint, 409) from None
        self._changed()

    def disconnect(self) -> None:
        """Ends the connection.  A target that the page has enabled becomes disabled."""
        with self._lock:
            connected, self._connected = self._connected, None
        if connected is not None:
            connected.close()
            self._changed()

    def command(self, line: str) -> list[str]:
        """Sends a command to the target and returns its answer.  Raises Refused."""
        return self._now().command(line)

    def enable(self, page: str) -> None:
        """Enables the target as long as ``page`` answers.  Raises Refused."""
        self._now().enable(page)

    def respond(self, page: str, number: int) -> None:
        """Passes on the answer of a page to a number.  Only the page that has enabled the target is heard."""
        connected = self._connected
        if connected is not None:
            connected.respond(page, number)

    def move(self, actuator: str, duty: float) -> None:
        """Moves an actuator for at most 250 ms, or prolongs its movement.  Raises Refused."""
        self._now().move(actuator, duty)

    def stop(self) -> None:
        """Disables the target, also if another program has enabled it.  Raises Refused."""
        self._now().stop()

    def events(self) -> Iterator[dict[str, Any]]:
        """The events of the connection, until it ends.  Raises Refused if there is none."""
        return self._now().events()

    def save(self, what: str, form: str) -> bytes:
        """A file with the newest rows (``what`` is "stream") or with the last recording ("capture").

        ``form`` is "csv" or "mcap".  Raises Refused.
        """
        connected = self._now()
        if what not in ("stream", "capture") or form not in ("csv", "mcap"):
            raise Refused(f"there is no file '{what}.{form}'", status=404)
        return connected.save(what, form)

    def recorded(self) -> dict[str, Any]:
        """The last recording of every cycle: names, times, and the values of each signal.  Raises Refused."""
        return self._now().recorded()

    def driven(self) -> Driven:
        """The motion since the page has seen the target being enabled.  Raises Refused."""
        return self._now().driven()

    def durations(self) -> dict[str, Any]:
        """The histograms of the loop's durations since the connection, by name.  Raises Refused."""
        return self._now().durations()

    def state(self, program: str) -> dict[str, Any]:
        """The connection for the page's state.  ``program`` is the terminal of a program that runs, or empty."""
        connected = self._connected
        found = [(program, "the program that runs")] if program else []
        found += [(str(path), device) for path, device in ports().items()]
        return {
            "ports": [{"path": path, "device": device} for path, device in found],
            "target": connected.state() if connected is not None else None,
            "problem": self._problem,
        }

    def _now(self) -> Connection:
        connected = self._connected
        if connected is None:
            raise Refused("no target is connected", "choose a port first", 409)
        return connected

    def _state_changed(self, lost: str) -> None:
        if lost:
            self._problem = {"message": lost, "hint": "look at the cable and at the program, and connect again"}
            threading.Thread(target=self.disconnect, daemon=True).start()
        self._changed()
