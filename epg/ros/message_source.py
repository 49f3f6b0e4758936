# SPDX-License-Identifier: Apache-2.0
"""The interface of the libraries that receive messages of ROS 2."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from epg.generator.dataclass import dataclass
from epg.generator.messages.library import Library


@dataclass(frozen=True)
class Subscription:
    """A topic to subscribe to.

    ``name`` is the full name in ROS, ``type`` the type as in ``ros2 topic list -t``, which ``library`` has loaded.
    ``reliable`` is True for the QoS reliable, False for best effort.
    """

    name: str
    type: str
    reliable: bool
    library: Library


@dataclass(frozen=True)
class Sample:
    """A received message.

    ``subscription`` is the index of its subscription.  ``time_ns`` is its arrival by the monotonic clock.
    ``published_ns`` is the instant at which its publisher sent it, in nanoseconds since 1970 by the publisher's clock,
    or 0 if it is not known.  ``cdr()`` is the serialized message with its encapsulation header.
    """

    time_ns: int
    subscription: int
    message: Any
    published_ns: int
    cdr: Callable[[], bytes]


class MessageSource(Protocol):
    """A set of subscriptions that receives messages."""

    def take(self, seconds: float) -> list[Sample]:
        """The messages that arrived since the last call.  Waits up to ``seconds`` for the first one."""

    def publishers(self) -> list[int]:
        """The number of publishers that each subscription found; -1 if one of them has an incompatible QoS."""

    def close(self) -> None: ...
