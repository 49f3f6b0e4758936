# SPDX-License-Identifier: Apache-2.0
"""What happens to frames on their way: loss, delay, duplicates, another order, cut and changed bytes.

All of it can be set at any time.  Chance has a seed, so that the same frames meet the same faults.
"""

from __future__ import annotations

import random
from dataclasses import dataclass


@dataclass
class Faults:
    """Of one direction; probabilities are of each frame."""

    loss: float = 0.0
    duplicate: float = 0.0
    reorder: float = 0.0
    """Held back for 1 to 20 ms, so that others overtake it."""
    truncate: float = 0.0
    """Only a part, of at least one byte, arrives."""
    corrupt: float = 0.0
    """One to four bytes are other ones.  On a serial line the frame's CRC shows that; of datagrams, the system's
    checksums do, so that this is for somebody who forges them."""
    delay: tuple[float, float] = (0.0, 0.0)
    """Least and largest, in seconds; frames keep their order if both are the same."""

    def clear(self) -> None:
        self.__init__()  # type: ignore[misc]

    def arrivals(self, chance: random.Random) -> list[float]:
        """Seconds until a frame arrives, twice if it is doubled; empty if it is lost."""
        if chance.random() < self.loss:
            return []
        copies = 2 if chance.random() < self.duplicate else 1
        return [self._wait(chance) for _ in range(copies)]

    def _wait(self, chance: random.Random) -> float:
        held = chance.uniform(0.001, 0.020) if chance.random() < self.reorder else 0.0
        return held + chance.uniform(*self.delay)

    def damage(self, data: bytes, chance: random.Random) -> bytes:
        """What arrives of ``data``: a datagram, or the bytes of a frame on the line."""
        if len(data) > 1 and chance.random() < self.truncate:
            data = data[: chance.randrange(1, len(data))]
        if chance.random() < self.corrupt:
            changed = bytearray(data)
            for _ in range(chance.randint(1, 4)):
                changed[chance.randrange(len(changed))] ^= chance.randrange(1, 256)
            data = bytes(changed)
        return data
