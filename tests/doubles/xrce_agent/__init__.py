# SPDX-License-Identifier: Apache-2.0
"""An agent of DDS-XRCE 1.0 for tests: boards connect to it, and tests can make it fail in many ways.

>>> with Agent(UdpLink()) as agent:                               # doctest: +SKIP
...     board = start_board(agent.address)                        # any client: a host executable, an emulated Pico
...     agent.topics.wait_for_sample("rt/pan_publisher")
...     agent.topics.publish("rt/pan_subscriber", float64(0.5))
...     agent.to_board.loss = 0.1                                 # from now on every tenth frame is lost
...     agent.restart()                                           # the new agent does not know the board
"""

from .agent import Agent, Refusal
from .faults import Faults
from .links import DeviceLink, Link, PtyLink, UdpLink
from .messages import Diagnostics, float64, read_diagnostics, read_float64
from .topics import Sample, Subscription, Topics
from .wire import Kind, Status

__all__ = [
    "Agent",
    "DeviceLink",
    "Diagnostics",
    "Faults",
    "Kind",
    "Link",
    "PtyLink",
    "Refusal",
    "Sample",
    "Status",
    "Subscription",
    "Topics",
    "UdpLink",
    "float64",
    "read_diagnostics",
    "read_float64",
]
