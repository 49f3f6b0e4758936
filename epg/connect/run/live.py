# SPDX-License-Identifier: Apache-2.0
"""The page's access to a running target: at most one connection at a time.

>>> # live = Live(changed=wake_the_page)
>>> # live.connect(Path("/dev/ttyACM0"), expected="a30d631d6d9f2052"); live.command("set Pan\\\\PID\\\\kp=2.2")
"""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from epg.connect.body import Refused
from epg.connect.projects import Job
from epg.connect.run.connection import LiveConnection
from epg.connect.run.live_comparison import Driven
from epg.live import client as protocol
from epg.live.client import Client, Lost
from epg.live.faults import Faults
from epg.live.found import ports
from epg.live.open import open_port
from epg.live.port import PortError
from epg.live.udp import PortLocked, disable, is_udp
from epg.live.udp_keys import keep_key


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


@dataclass(frozen=True)
class _Lost:
    """A target whose connection was lost.  It can still move."""

    path: Path
    baud: int
    name: str
    words: dict[str, str]

    def state(self) -> dict[str, Any]:
        return {"name": self.name, "state": self.words}

    def stop(self) -> None:
        """Disables it, if it is there again.  Raises Refused."""
        try:
            if is_udp(self.path):
                disable(self.path)
                return
            with open_port(self.path, self.baud) as port:
                client = Client(port)
                try:
                    client.disable()
                finally:
                    client.stop()
        except (PortError, Lost, protocol.CommandRefused) as problem:
            raise Refused(str(problem), "switch the actuators' supply off", 409) from None


class Live:
    """One connection to a target.  ``changed`` is called, by any thread, when :meth:`state` has changed."""

    def __init__(self, changed: Callable[[], None]) -> None:
        self._changed = changed
        self._lock = threading.Lock()
        self._connected: LiveConnection | None = None
        self._problem: dict[str, str] | None = None
        self._lost: _Lost | None = None
        self._opened = (Path(), 0)
        self._locked = ""

    def give_key(self, path: Path, key: str) -> None:
        """Keeps the key that the user has typed for the port ``path``.  Raises Refused."""
        try:
            keep_key(path, key)
        except PortError as problem:
            raise Refused(str(problem), problem.hint) from None

    def connect(self, path: Path, expected: str, baud: int = 115200, roots: Sequence[Path] = ()) -> None:
        """Connects with the target behind ``path``.  ``expected`` is the hash of the firmware that was built; "": none.

        ``roots`` are the folders of targets that describe its faults.  Raises Refused.
        """
        with self._lock:
            if self._connected is not None:
                raise Refused("a target is connected", "disconnect it first", 409)
            self._problem = self._lost = None
            try:
                self._connected = LiveConnection(path, expected, baud, Faults(roots), self._state_changed)
                self._opened = path, baud
                self._locked = ""
            except PortLocked as problem:
                self._locked = str(path)
                self._changed()
                raise Refused(str(problem), "type the key that its program has printed", 409) from None
            except PortError as problem:
                raise Refused(str(problem), problem.hint, 409) from None
            except (Lost, protocol.CommandRefused) as problem:
                hint = "the firmware needs the console on this port; reset the board, look at the cable"
                raise Refused(str(problem), hint, 409) from None
        self._changed()

    def disconnect(self) -> None:
        """Ends the connection.  A target that the page has enabled becomes disabled."""
        if self._lost is not None:
            self._lost = None  # the user knows that the target cannot be reached
            self._changed()
        self._close()

    def leave(self, path: Path) -> None:
        """Ends the connection if it is with the target behind ``path``."""
        if self._connected is not None and self._opened[0] == path:
            self._close()

    def _close(self) -> None:
        with self._lock:
            connected, self._connected = self._connected, None
        if connected is not None:
            connected.close()
            self._changed()

    def command(self, page: str, line: str, after: str = "", *, unattended: bool = False) -> list[str]:
        """Sends a command of ``page`` to the target and returns its answer.  Raises Refused.

        ``enable`` enables it as long as the page answers; ``unattended``: the user has agreed to ``enable unattended``.
        """
        return self._now().command(page, line, after, unattended=unattended)

    def enable(self, page: str, after: str = "") -> None:
        """Enables the target as long as ``page`` answers.  Raises Refused.

        ``after`` is the number of the newest stop that the page showed: the target refuses after a newer one.
        """
        self._now().enable(page, after)

    def look(self) -> None:
        """Asks where the target will move when it is enabled.  Raises Refused."""
        self._now().look()

    def respond(self, page: str, number: int) -> None:
        """Passes on the answer of a page to a number.  Only the page that has enabled the target is heard."""
        connected = self._connected
        if connected is not None:
            connected.respond(page, number)

    def move(self, page: str, actuator: str, duty: float, number: int) -> None:
        """Moves an actuator for at most 250 ms, or prolongs its movement.  Raises Refused.

        The movement ends at most 300 ms after the target has sent ``number``, the newest that ``page`` has got.  0: the
        page has none; nothing moves, and the target sends numbers, which the events of the page contain.
        """
        self._now().move(page, actuator, duty, number)

    def stop(self) -> None:
        """Disables the target, also if another program has enabled it.  Raises Refused.

        If the connection was lost, it looks for the target at its old place.
        """
        lost = self._lost
        if lost is None:
            self._now().stop()
            return
        lost.stop()
        self._lost = replace(lost, words={**lost.words, "enabled": "0"})
        self._changed()

    def events(self, page: str) -> Iterator[dict[str, Any]]:
        """The events of the connection for ``page``, until it ends.  Raises Refused if there is none."""
        return self._now().events(page)

    def save(self, what: str, form: str) -> AbstractContextManager[Path]:
        """A file with the rows since the connection (``what`` is "stream") or with the last recording ("capture").

        ``form`` is "csv" or "mcap".  The file is there as long as the context lasts.  Raises Refused.
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
        places = [(program, "the program that runs")] if program else []
        places += [(str(path), device) for path, device in ports().items()]
        return {
            "locked": self._locked,
            "ports": [{"path": path, "device": device} for path, device in places],
            "target": connected.state() if connected is not None else None,
            "problem": self._problem,
            "lost": self._lost.state() if self._lost is not None else None,
        }

    def _now(self) -> LiveConnection:
        connected = self._connected
        if connected is None:
            raise Refused("no target is connected", "choose a port first", 409)
        return connected

    def _state_changed(self, lost: str) -> None:
        connected = self._connected
        if lost and connected is not None:
            target = connected.state()
            self._lost = _Lost(*self._opened, target["name"], target["state"])
        if lost:
            self._problem = {"message": lost, "hint": "look at the cable and at the program, and connect again"}
            threading.Thread(target=self._close, daemon=True).start()
        self._changed()
