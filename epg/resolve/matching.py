# SPDX-License-Identifier: Apache-2.0
"""Proposes a component port for each model port, by the words in their names.

There are three qualities of a match, tried in this order:

1. Both names have the same words: ``encoder_reset_pan`` and ``encoder_pan.reset``.
2. The words of the model port are some of the component port's: ``position_pan`` and ``encoder_pan.position``.
3. A model port and a topic are left that share a word with each other, and with no other port or topic that is left:
   ``setpoint_pan`` and ``pan_subscriber``.

A match must be the only one of its quality.  The third quality is for topics only: a weak match must never move
hardware.  The user binds all other ports.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from epg.check.configuration import Component
from epg.models.model import Model, Port


@dataclass(frozen=True)
class Match:
    """The proposal for one model port.

    ``reference`` is the component port as bindings write it, or None without a match.  ``candidates`` are all component
    ports of the right direction.
    """

    port: Port
    reference: str | None
    candidates: tuple[str, ...]


def match_ports(model: Model, components: Mapping[str, Component]) -> dict[str, Match]:
    """The match of each port of ``model``, in the order of the model.  No component port is given to two outputs."""
    result: dict[str, Match] = {}
    taken: set[str] = set()
    used: set[str] = set()
    for port in (*model.inputs, *model.outputs):
        direction = "source" if port.direction == "input" else "sink"
        ends = _ends(components, direction)
        free = {
            reference: words for reference, words in ends.items() if direction == "source" or reference not in taken
        }
        reference = _best(_words(port.name), free)
        if reference:
            used.add(reference)
        if reference and direction == "sink":
            taken.add(reference)
        result[port.name] = Match(port, reference, tuple(sorted(ends)))
    for direction, communication in (("input", "subscribe"), ("output", "publish")):
        ports = [port for port in model.inputs + model.outputs if port.direction == direction]
        left = [port for port in ports if result[port.name].reference is None]
        topics = [c.name for c in components.values() if c.kind.communication == communication and c.name not in used]
        for port, topic in _meet(left, topics):
            result[port.name] = replace(result[port.name], reference=topic)
    return result


def _meet(ports: Sequence[Port], topics: Sequence[str]) -> list[tuple[Port, str]]:
    """The pairs of ports and topics that share a word with each other, and with no other topic or port."""
    near = {port.name: [topic for topic in topics if _words(port.name) & _words(topic)] for port in ports}
    found = [(port, near[port.name][0]) for port in ports if len(near[port.name]) == 1]
    return [(port, topic) for port, topic in found if sum(topic in names for names in near.values()) == 1]


def _ends(components: Mapping[str, Component], direction: str) -> dict[str, tuple[frozenset[str], frozenset[str]]]:
    """Reference -> (its words, all words of its component, port and kind), for the ports of a direction."""
    result = {}
    for component in components.values():
        for port in component.kind.ports:
            if port.direction != direction:
                continue
            reference = component.kind.reference(component.name, port)
            more = _words(component.name) | _words(port.name) | _words(component.kind.name)
            result[reference] = (_words(reference), more)
    return result


def _best(words: frozenset[str], ends: Mapping[str, tuple[frozenset[str], frozenset[str]]]) -> str | None:
    same = [reference for reference, (own, _) in ends.items() if own == words]
    if same:
        return same[0] if len(same) == 1 else None
    within = [reference for reference, (_, more) in ends.items() if words <= more]
    return within[0] if len(within) == 1 else None


def _words(name: str) -> frozenset[str]:
    spaced = re.sub(r"([a-z0-9])([A-Z])", r"\1 \2", name)
    return frozenset(word.casefold() for word in re.split(r"[^A-Za-z0-9]+", spaced) if word)
