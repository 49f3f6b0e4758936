# SPDX-License-Identifier: Apache-2.0
"""Faults of frames on their way: loss, delay, duplicates, another order, cut and changed bytes.

A test can change each of them at any time.  The random generator has a seed: the same frames meet the same faults.
"""

from __future__ import annotations

import random
from dataclasses import dataclass


@dataclass
class Faults:
    """The faults of one direction; each probability is per frame."""

    loss: float = 0.0
    duplicate: float = 0.0
    reorder: float = 0.0
    """Delays a frame by 1 to 20 ms, so that later frames overtake it."""
    truncate: float = 0.0
    """Only a part of the frame arrives, at least one byte."""
    corrupt: float = 0.0
    """Changes one to four bytes.  On a serial line the frame's CRC detects this.  For datagrams the system's checksums
    detect it: there, this fault imitates an attacker who forges datagrams."""
    delay: tuple[float, float] = (0.0, 0.0)
    """Shortest and longest delay, in seconds; frames keep their order if both are equal."""

    def clear(self) -> None:
        self.__init__()  # type: ignore[misc]

    def arrivals(self, chance: random.Random) -> list[float]:
        """Seconds until each arrival of a frame: two for a duplicated frame, none for a lost frame."""
        if chance.random() < self.loss:
            return []
        copies = 2 if chance.random() < self.duplicate else 1
        return [self._wait(chance) for _ in range(copies)]

    def _wait(self, chance: random.Random) -> float:
        held = chance.uniform(0.001, 0.020) if chance.random() < self.reorder else 0.0
        return held + chance.uniform(*self.delay)

    def damage(self, data: bytes, chance: random.Random) -> bytes:
        """The part of ``data`` that arrives; ``data`` is a datagram, or the bytes of a frame on the line."""
        if len(data) > 1 and chance.random() < self.truncate:
            data = data[: chance.randrange(1, len(data))]
        if chance.random() < self.corrupt:
            changed = bytearray(data)
            for _ in range(chance.randint(1, 4)):
                changed[chance.randrange(len(changed))] ^= chance.randrange(1, 256)
            data = bytes(changed)
        return data
