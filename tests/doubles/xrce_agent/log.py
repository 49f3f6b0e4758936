# SPDX-License-Identifier: Apache-2.0
"""A log of every frame that passes an agent, and the faults that changed it."""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable, Iterator
from dataclasses import dataclass

from .wire import Id, WireError, split, submessages


@dataclass(frozen=True)
class Frame:
    number: int
    """The number of frames before it."""
    from_board: bool
    peer: Hashable
    data: bytes
    fate: str
    """Empty if it arrived unchanged; "lost", "cut", "late"..."""

    def submessages(self) -> list[Id]:
        """The submessages in the frame; none if it is broken."""
        try:
            return [Id(part.id) for part in submessages(split(self.data)[1])]
        except (WireError, ValueError):
            return []

    def __str__(self) -> str:
        names = " ".join(part.name for part in self.submessages()) or self.data.hex()
        arrow = "->" if self.from_board else "<-"
        return f"{self.number} {arrow} {len(self.data)} {names} {self.fate}".rstrip()


class Log:
    """The newest frames."""

    def __init__(self, kept: int = 100_000) -> None:
        self._frames: deque[Frame] = deque(maxlen=kept)
        self.count = 0

    def add(self, from_board: bool, peer: Hashable, data: bytes, fate: str = "") -> None:
        self._frames.append(Frame(self.count, from_board, peer, data, fate))
        self.count += 1

    def __iter__(self) -> Iterator[Frame]:
        return iter(list(self._frames))

    def clear(self) -> None:
        self._frames.clear()

    def of(self, identity: Id, from_board: bool) -> list[Frame]:
        """The frames with such a submessage."""
        return [frame for frame in self if frame.from_board == from_board and identity in frame.submessages()]
