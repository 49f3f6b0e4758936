# SPDX-License-Identifier: Apache-2.0
"""Proposes a component port for each model port, by the words in their names.

There are four qualities of a match, tried in this order:

1. Both names have the same words: ``encoder_reset_pan`` and ``encoder_pan.reset``.
2. The words of the model port are some of the component port's: ``position_pan`` and ``encoder_pan.position``.
3. A word of the model port says which kind of port it belongs to, and its other words are in the name of one component
   only: ``SteerLeft`` and ``pwm_left``.  The kind of the component lists such ``words``.
4. A model port and a topic are left that share a word with each other, and with no other port or topic that is left:
   ``pan`` and ``pan_publisher``.

A match must be the only one of its quality.  The first two are written into new bindings, and the third for topics
whose names share a word with the port's.  The others are guesses: the user must accept them, because a weak match must
never move hardware.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

from epg.catalog.kind import KindPort
from epg.check.configuration import Component
from epg.dataclass import dataclass
from epg.models.model import Model, Port


@dataclass(frozen=True)
class Match:
    """The proposal for one model port.

    ``reference`` is the component port as bindings write it, or None without a match.  ``guess`` is a weak match, for a
    port without a better one.  ``candidates`` are all component ports of the right direction.
    """

    port: Port
    reference: str | None
    candidates: tuple[str, ...]
    guess: str | None = None

    @property
    def proposal(self) -> str | None:
        """The component port to propose to the user."""
        return self.reference or self.guess


@dataclass(frozen=True)
class _End:
    """A component port.  ``all_words`` are those of its component, its name and its kind."""

    reference: str
    component: Component
    port: KindPort
    all_words: frozenset[str]

    @property
    def is_topic(self) -> bool:
        return bool(self.component.kind.communication)


def match_ports(model: Model, components: Mapping[str, Component]) -> dict[str, Match]:
    """The match of each port of ``model``, in the order of the model.  No component port is given to two outputs."""
    result: dict[str, Match] = {}
    for ports, direction in ((model.inputs, "source"), (model.outputs, "sink")):
        ends = _ends(components, direction)
        sure: dict[str, _End] = {}
        for port in ports:
            free = ends if direction == "source" else _without(ends, sure.values())
            best = _best(_words(port.name), free)
            if best is not None:
                sure[port.name] = best
        by_role = _by_role(_open(ports, sure), _without(ends, sure.values()), ends)
        sure |= {name: end for name, end in by_role.items() if end.is_topic and _shares_word(name, end)}
        known = {**by_role, **sure}
        by_word = _by_word(_open(ports, known), [end for end in _without(ends, known.values()) if end.is_topic])
        guesses = {**by_word, **by_role}
        candidates = tuple(sorted(end.reference for end in ends))
        for port in ports:
            certain, guess = sure.get(port.name), guesses.get(port.name)
            result[port.name] = Match(
                port,
                certain.reference if certain is not None else None,
                candidates,
                guess.reference if guess is not None and certain is None else None,
            )
    return result


def _ends(components: Mapping[str, Component], direction: str) -> list[_End]:
    """The component ports of a direction."""
    return [
        _End(
            component.kind.reference(component.name, port),
            component,
            port,
            _words(component.name) | _words(port.name) | _words(component.kind.name),
        )
        for component in components.values()
        for port in component.kind.ports
        if port.direction == direction
    ]


def _without(ends: Iterable[_End], taken: Iterable[_End]) -> list[_End]:
    references = {end.reference for end in taken}
    return [end for end in ends if end.reference not in references]


def _open(ports: Iterable[Port], matched: Mapping[str, _End]) -> list[Port]:
    return [port for port in ports if port.name not in matched]


def _best(words: frozenset[str], ends: Sequence[_End]) -> _End | None:
    """The only component port with the same words, else the only one that has all ``words``."""
    same = [end for end in ends if _words(end.reference) == words]
    if same:
        return same[0] if len(same) == 1 else None
    within = [end for end in ends if words <= end.all_words]
    return within[0] if len(within) == 1 else None


def _by_role(ports: Sequence[Port], free: Sequence[_End], ends: Sequence[_End]) -> dict[str, _End]:
    """The ports that belong to a free component port by the first such word in their names.

    Words that say what a port is for, of any of the ``ends``, need not be in the component's name.
    """
    roles = frozenset(word for end in ends for word in end.port.words)
    found: dict[str, _End] = {}
    for port in ports:
        role = next((word for word in _split(port.name) if word in roles), None)
        place = _words(port.name) - roles
        fitting = [end for end in free if role in end.port.words and place <= _words(end.component.name)]
        if len(fitting) == 1:
            found[port.name] = fitting[0]
    count = Counter(end.reference for end in found.values())
    return {name: end for name, end in found.items() if count[end.reference] == 1}


def _shares_word(name: str, end: _End) -> bool:
    return bool(_words(name) & _words(end.component.name))


def _by_word(ports: Sequence[Port], topics: Sequence[_End]) -> dict[str, _End]:
    """The ports that share a word with a topic, where neither shares one with another topic or port."""
    near = {port.name: [end for end in topics if end.port.default and _shares_word(port.name, end)] for port in ports}
    count = Counter(end.reference for found in near.values() for end in found)
    return {name: found[0] for name, found in near.items() if len(found) == 1 and count[found[0].reference] == 1}


def _words(name: str) -> frozenset[str]:
    return frozenset(_split(name))


def _split(name: str) -> list[str]:
    """The words of a name in lower case, in order: ``SetPosLeft`` has ``set``, ``pos`` and ``left``."""
    spaced = re.sub(r"([a-z0-9])([A-Z])", r"\1 \2", name)
    return [word.casefold() for word in re.split(r"[^A-Za-z0-9]+", spaced) if word]
