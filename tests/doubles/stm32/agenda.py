# SPDX-License-Identifier: Apache-2.0
"""The time of the machine, and the events that are due at some time.

Time is a whole number of units; 4.8 GHz is a multiple of nearly all frequencies that firmware gives its clocks.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable

UNITS = 4_800_000_000
"""Units of time in a second."""
NEVER = 1 << 200


class Agenda:
    """At most one event per key."""

    def __init__(self) -> None:
        self.events: dict[Hashable, tuple[int, Callable[[], None]]] = {}
        self.next = NEVER
        self.sooner: Callable[[int], None] = lambda time: None
        """Called with the time of an event that is sooner than all others."""

    def set(self, key: Hashable, time: int | None, due: Callable[[], None]) -> None:
        """Calls ``due`` at ``time``, in place of the earlier event of ``key``.  None: never."""
        if time is None:
            if self.events.pop(key, None) is not None:
                self.next = min((event[0] for event in self.events.values()), default=NEVER)
            return
        self.events[key] = (time, due)
        before = self.next
        self.next = min(event[0] for event in self.events.values())
        if self.next < before:
            self.sooner(self.next)

    def deliver(self, now: int) -> None:
        """Calls all events that are due, in the order of their times."""
        while self.next <= now:
            key, (_, due) = min(self.events.items(), key=lambda item: item[1][0])
            del self.events[key]
            self.next = min((event[0] for event in self.events.values()), default=NEVER)
            due()
