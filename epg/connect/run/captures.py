# SPDX-License-Identifier: Apache-2.0
"""The recordings of every cycle that the target of a page makes in its memory."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable
from typing import Any

from epg.connect.body import Refused
from epg.live import client as protocol
from epg.live.capture import Capture, progress_of, recorded_of
from epg.live.client import Client, Lost, words_of

ASK = 0.3
"""Seconds between two looks at the progress of a recording."""


class Captures:
    """The last recording, and the progress of the next one in ``state``.  ``changed`` is called when that differs."""

    def __init__(self, client: Client, over: threading.Event, changed: Callable[[], None]) -> None:
        self._client, self._over, self._changed = client, over, changed
        self.state: dict[str, Any] = {"state": "none", "rows": 0, "wanted": 0, "number": 0}
        self._recorded: Capture | None = None
        self._follower: threading.Thread | None = None

    def begun(self, answer: str) -> None:
        """Follows a recording, if that is what the target has answered."""
        wanted = dict(words_of(answer)).get("rows")
        if wanted is not None and (self._follower is None or not self._follower.is_alive()):
            self.state |= {"state": "recording", "rows": 0, "wanted": int(wanted)}
            self._follower = threading.Thread(target=self._follow, name="capture", daemon=True)
            self._follower.start()
            self._changed()

    def last(self) -> Capture:
        """The last recording.  Raises Refused."""
        recorded = self._recorded
        if recorded is None:
            raise Refused("nothing has been recorded", "start a recording first", 409)
        return recorded

    def _follow(self) -> None:
        """Shows the progress of a recording, and reads it when it is complete."""
        with contextlib.suppress(Lost):
            while not self._over.is_set():
                progress = progress_of(self._client.command("capture")[-1])
                if not progress.recording:
                    with contextlib.suppress(protocol.CommandRefused):  # another one has begun
                        self._recorded = recorded_of(self._client.command("capture read"), progress.trigger)
                        number = self.state["number"] + 1
                        self.state |= {"state": "ready", "rows": progress.rows, "number": number}
                        break
                elif progress.rows != self.state["rows"]:
                    self.state["rows"] = progress.rows
                    self._changed()
                self._over.wait(ASK)
            self._changed()
