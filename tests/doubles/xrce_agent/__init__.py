# SPDX-License-Identifier: Apache-2.0
"""An agent of DDS-XRCE 1.0 for tests: boards connect to it, and tests can make it fail in many ways.

>>> with Agent(UdpLink()) as agent:                               # doctest: +SKIP
...     board = start_board(agent.address)                        # any client: a host executable, an emulated Pico
...     agent.topics.wait_for_sample("rt/pan_publisher")
...     agent.topics.publish("rt/pan_subscriber", float64(0.5))
...     agent.to_board.loss = 0.1                                 # from now on every tenth frame is lost
...     agent.restart()                                           # the new agent does not know the board

It behaves like eProsima's agent wherever a client can detect a difference, also where that is difficult for clients:

- A board that connects again with its old key keeps its entities and readers.  Samples for the old session therefore
  arrive while the new session is being made.  The agent also keeps the fragments that it has collected.
- An agent that was just started answers the pings of boards that it does not know, and reports that it does not.
- Its windows have 16 messages, and it sends a heartbeat every 200 ms.  A message larger than the board's MTU is sent in
  fragments on a reliable stream, all at once, and is not sent on a best-effort stream.
- A service has a replier, with a history of one request.  Requests and replies begin with the identity of the request.

==========================  ===========================================================================================
address                     ``UdpLink()`` (a free port), ``PtyLink(path)`` (makes a terminal)
faults of frames            ``agent.to_board``, ``agent.from_board``: ``loss``, ``duplicate``, ``reorder``, ``delay``,
                            ``truncate``, ``corrupt``; can be set at any time, with one seed
faults of the agent         ``kill()``, ``start()``, ``restart(pause)``, ``freeze()``, ``thaw()``, ``inject(bytes)``
                            (``raw=True``: bytes of the line), ``refuse(status, kind, name, times)``, ``mute``,
                            ``mute_streams``, ``say(stream, submessage)``, ``clock_offset``
messages of the boards      ``agent.topics.samples(topic)``, ``wait_for_sample()``; ``subscribe(topic, reliable)``
                            receives like a peer with this QoS
messages to the boards      ``agent.topics.publish(topic, data, reliable)``, matched as in DDS
services of the boards      ``agent.topics.call(service, request)``, ``ask()``, ``answers()``, ``wait_for_service()``
connected boards            ``agent.clients`` (entities, names, QoS), ``agent.created`` (time and key)
frames on the line          ``agent.log``: each frame with both times, and its fault; ``agent.tail()``
several agents              ``Agent(link, topics)`` with the same ``Topics``: one network
==========================  ===========================================================================================
"""

from .agent import Agent, Refusal
from .faults import Faults
from .links import Link, PtyLink, UdpLink
from .messages import Diagnostics, float64, read_diagnostics, read_float64
from .topics import Sample, Subscription, Topics
from .wire import Kind, Status

__all__ = [
    "Agent",
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
