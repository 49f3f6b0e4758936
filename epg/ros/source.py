# SPDX-License-Identifier: Apache-2.0
"""What delivers messages of ROS 2, whichever library they come by."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol


@dataclass(frozen=True)
class Subscription:
    """A topic to listen to: its full ROS name, its type as in ``ros2 topic list -t``, whether reliably."""

    name: str
    type: str
    reliable: bool


@dataclass(frozen=True)
class Sample:
    """A message of subscription number ``subscription`` that arrived at ``time_ns`` of the monotonic clock."""

    time_ns: int
    subscription: int
    message: Any


class Source(Protocol):
    """Something that is subscribed to topics."""

    def take(self, seconds: float) -> list[Sample]:
        """What has arrived since the last call, waiting up to ``seconds`` for something to arrive."""

    def publishers(self) -> list[int]:
        """How many publishers each subscription has found; -1 if there is one whose QoS does not fit."""

    def close(self) -> None: ...
