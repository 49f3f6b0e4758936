# SPDX-License-Identifier: Apache-2.0
"""Proposes a component port for each model port, by the words in their names, their types and their units.

There are four qualities of a match, tried in this order:

1. Both names have the same words: ``encoder_reset_pan`` and ``encoder_pan.reset``.
2. The words of the model port are some of the component port's: ``position_pan`` and ``encoder_pan.position``.
3. A word of the model port says what the port is for, and its other words are in the name of one component only:
   ``SteerLeft`` and ``pwm_left``.  The kind of the component lists such ``words`` and ``quantities``.
4. A model port says nothing of the kind, and shares a word with one component port that is left, which is a topic:
   ``pan`` and ``pan_publisher``, if the motor of this axis has another port.

A component port is matched with one model port only, and never with one that another model port uses already.  If two
model ports match it equally well, none of them does.  Apart from the first quality, a match agrees in type and unit.

A setpoint of something that does not keep moving also gets the model input that it follows: the measured value whose
name has the same words, apart from those that say what a port is for: ``setpoint_pan`` and ``position_pan``.

The first two qualities are written into new bindings, and the third for topics whose names share a word with the
port's.  The others are guesses: the user must accept them, because a weak match must never move hardware.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, lru_cache, partial

from epg.generator.catalog.kind import KindPort
from epg.generator.check.configuration import Component
from epg.generator.dataclass import dataclass
from epg.generator.models.model import Model, Port
from epg.generator.quantity import IN_MOTION, dimension_of
from epg.generator.resolve.fitting import fits

_NONE: Mapping[str, Iterable[str]] = {}


@dataclass(frozen=True)
class Match:
    """The proposal for one model port.

    ``reference`` is the component port as bindings write it, or None without a match.  ``guess`` is a weak match, for a
    port without a better one.  ``candidates`` are all component ports of the right direction.  ``follows`` is the model
    input that a setpoint follows, empty for none.  ``ranking`` gives :attr:`fitting` and :attr:`meant`: it takes long
    for a model with hundreds of ports, and few hints need it.
    """

    port: Port
    reference: str | None
    candidates: tuple[str, ...]
    guess: str | None = None
    follows: str = ""
    ranking: Callable[[], tuple[tuple[str, ...], tuple[str, ...]]] = lambda: ((), ())

    @property
    def fitting(self) -> tuple[str, ...]:
        """The component ports that fit in type and unit and that no other port uses, the best first."""
        return self.ranking()[0]

    @property
    def meant(self) -> tuple[str, ...]:
        """Those of :attr:`fitting` for which the port's name says that it is."""
        return self.ranking()[1]

    @property
    def proposal(self) -> str | None:
        """The component port to propose to the user."""
        return self.reference or self.guess


@dataclass(frozen=True)
class _End:
    """A component port.

    ``name_words`` are the words of its component's name, ``all_words`` also those of its own name and of its kind.
    ``words`` and ``quantities`` are the kind's words that say that a port of the model belongs to such a port.
    """

    reference: str
    component: Component
    port: KindPort
    name_words: frozenset[str]
    all_words: frozenset[str]
    words: frozenset[str]
    quantities: frozenset[str]

    @property
    def is_topic(self) -> bool:
        return bool(self.component.kind.communication)

    @property
    def role(self) -> frozenset[str]:
        return self.words | self.quantities


def match_ports(
    model: Model,
    components: Mapping[str, Component],
    bound: Mapping[str, Iterable[str]] = _NONE,
    *,
    plant: bool = False,
) -> dict[str, Match]:
    """The match of each port of ``model``, in the order of the model.

    ``bound`` has the component ports to which ports of the model are bound already: they get no match.  With ``plant``,
    the model is the simulated robot: its inputs read actuators, and its outputs drive sensors.
    """
    directions = ("sink", "source") if plant else ("source", "sink")
    return {
        **_side(model.inputs, directions[0], components, bound, plant),
        **_side(model.outputs, directions[1], components, bound, plant),
    }


def _side(
    ports: Sequence[Port],
    direction: str,
    components: Mapping[str, Component],
    bound: Mapping[str, Iterable[str]],
    plant: bool,
) -> dict[str, Match]:
    """The matches of the inputs or of the outputs of a model with component ports of ``direction``."""
    ends = _ends(components, direction)
    names = {p.name: _normal(bound.get(p.name, ()), components, direction) for p in ports}
    free = [end for end in ends if not any(end.reference in used for used in names.values())]
    sure, guesses = _matched([port for port in ports if port.name not in bound], free, ends, plant)
    wired = {p.name: end for p in ports for end in ends if end.reference in names[p.name]}
    followed = _followed(ports, {**wired, **sure}, ends) if direction == "source" and not plant else {}
    candidates = tuple(sorted(end.reference for end in ends))
    return {
        port.name: Match(
            port,
            _reference(sure.get(port.name)),
            candidates,
            _reference(guesses.get(port.name)),
            followed.get(port.name, ""),
            cache(partial(_ranked, port, free, ends, plant)),
        )
        for port in ports
    }


def _reference(end: _End | None) -> str | None:
    return None if end is None else end.reference


def _matched(
    ports: Sequence[Port], free: Sequence[_End], ends: Sequence[_End], plant: bool
) -> tuple[dict[str, _End], dict[str, _End]]:
    """The matches of ``ports`` that are sure, and the guesses for the others."""
    sure = _unique({port.name: _same(port, free) for port in ports})
    left = _without(free, sure)
    sure |= _unique({port.name: _within(port, left, ends, plant) for port in _open(ports, sure)})
    by_role = _by_role(_open(ports, sure), _without(free, sure), ends, plant)
    certain = {name: end for name, end in by_role.items() if end.is_topic and _shares_word(name, end)}
    by_word = _by_word(_open(ports, {**by_role, **sure}), _without(free, {**by_role, **sure}), ends, plant)
    guesses = {name: end for name, end in {**by_word, **by_role}.items() if name not in certain}
    return {**sure, **certain}, guesses


def words_of(name: str) -> frozenset[str]:
    """The words of a name, in lower case: ``SetPosLeft`` has ``set``, ``pos`` and ``left``."""
    return frozenset(_split(name))


def _ends(components: Mapping[str, Component], direction: str) -> list[_End]:
    """The component ports of a direction."""
    return [
        _End(
            component.kind.reference(component.name, port),
            component,
            port,
            words_of(component.name),
            words_of(component.name) | words_of(port.name) | words_of(component.kind.name),
            frozenset(port.words),
            frozenset(port.quantities),
        )
        for component in components.values()
        for port in component.kind.ports
        if port.direction == direction
    ]


def _normal(references: Iterable[str], components: Mapping[str, Component], direction: str) -> set[str]:
    """The references, in the short form if there is one."""
    result = set()
    for reference in references:
        name, _, port_name = reference.partition(".")
        main = components[name].kind.main_port(direction) if name in components else None
        result.add(name if main is not None and main.name == port_name else reference)
    return result


def _without(ends: Iterable[_End], taken: Mapping[str, _End]) -> list[_End]:
    references = {end.reference for end in taken.values()}
    return [end for end in ends if end.reference not in references]


def _open(ports: Iterable[Port], matched: Mapping[str, _End]) -> list[Port]:
    return [port for port in ports if port.name not in matched]


def _unique(found: Mapping[str, _End | None]) -> dict[str, _End]:
    """The matches whose component port is that of one model port only."""
    count = Counter(end.reference for end in found.values() if end is not None)
    return {name: end for name, end in found.items() if end is not None and count[end.reference] == 1}


def _with_words(words: frozenset[str], free: Sequence[_End]) -> list[_End]:
    return [end for end in free if words_of(end.reference) == words]


def _same(port: Port, free: Sequence[_End]) -> _End | None:
    """The only free component port with the same words as ``port``."""
    same = _with_words(words_of(port.name), free)
    return same[0] if len(same) == 1 else None


def _within(port: Port, free: Sequence[_End], ends: Sequence[_End], plant: bool) -> _End | None:
    """The only free component port with all words of ``port``, if none has the same words.

    It is not one if the name of the port says that it belongs to other ``ends``, which need not be free.
    """
    words = words_of(port.name)
    within = [end for end in free if words <= end.all_words and _fits(port, end, plant)]
    if len(within) != 1 or _with_words(words, free) or not _says(words, within[0]):
        return None
    said = _for(port.name, ends)
    return within[0] if said is None or within[0] in said else None


def _says(words: frozenset[str], end: _End) -> bool:
    """True if the ``words`` of a port are enough to be sure that it belongs to ``end``.

    They must say what the port is for if ``end`` moves hardware, or if the component's name says it: ``position``
    alone does not belong to ``position_setpoint``, nor ``pan`` to ``pwm_pan``.
    """
    if end.role & words:
        return True
    if end.port.actuator:
        return bool(words & (words_of(end.port.name) | words_of(end.component.kind.name)))
    return not end.words & end.name_words


def _fits(port: Port, end: _End, plant: bool) -> bool:
    return fits(port, end.component, end.port, plant=plant)


def _for(name: str, ends: Sequence[_End]) -> list[_End] | None:
    """Those of ``ends`` that the words of a port's name say that it belongs to; None if they say nothing.

    The measured position is a sensor's, and the position of a setpoint is a topic's: a quantity does not decide if
    another word does.  A topic that is sent can have any value: the log of a motor is not a motor's.
    """
    words = words_of(name)
    said = [end for end in ends if words & end.words] or [end for end in ends if words & end.quantities]
    sent = [end for end in said if end.component.kind.communication == "publish"]
    return (sent or said) if said else None


def _by_role(ports: Sequence[Port], free: Sequence[_End], ends: Sequence[_End], plant: bool) -> dict[str, _End]:
    """The ports whose names say what they are for, and fit one free component port for this only.

    Words that say what a port is for, of any of the ``ends``, need not be in the component's name.
    """
    roles = _roles(ends)
    left = {end.reference for end in free}
    found: dict[str, _End] = {}
    for port in ports:
        said = _for(port.name, ends) or []
        place = words_of(port.name) - roles
        fitting = [end for end in said if end.reference in left and place <= end.name_words and _fits(port, end, plant)]
        if len(fitting) == 1 and len({end.is_topic for end in said}) == 1:
            found[port.name] = fitting[0]
    return _unique(found)


def _roles(ends: Iterable[_End]) -> frozenset[str]:
    """The words that say what a component port is for, of all ``ends``."""
    return frozenset(word for end in ends for word in end.role)


def _followed(ports: Sequence[Port], sure: Mapping[str, _End], ends: Sequence[_End]) -> dict[str, str]:
    """The measured input that each setpoint follows: the only one with the same words and the same dimension."""
    roles = _roles(ends)
    bound = [(port, sure[port.name]) for port in ports if port.name in sure and port.type == "real"]
    measured = [port for port, end in bound if not end.is_topic and end.port.type == "real"]
    result = {}
    for port, end in bound:
        near = [m for m in measured if _can_follow(port, m, roles)]
        if end.is_topic and len(near) == 1:
            result[port.name] = near[0].name
    return result


def _can_follow(port: Port, measured: Port, roles: frozenset[str]) -> bool:
    """True if both ports have the same words except their ``roles``, and no dimension forbids it."""
    if words_of(port.name) - roles != words_of(measured.name) - roles:
        return False
    dimensions = {dimension_of(unit) for unit in (port.unit, measured.unit) if unit}
    return len(dimensions) <= 1 and not dimensions & IN_MOTION


def _shares_word(name: str, end: _End) -> bool:
    return bool(words_of(name) & end.name_words)


def _by_word(ports: Sequence[Port], free: Sequence[_End], ends: Sequence[_End], plant: bool) -> dict[str, _End]:
    """The ports that share a word with one free component port only, which is a topic.

    A port whose name says that it belongs to other component ports is not among them: the duty of a motor is never
    proposed for a topic because both are about the same axis.
    """
    found: dict[str, _End] = {}
    for port in ports:
        said = _for(port.name, ends)
        near = [end for end in free if end.port.default and _shares_word(port.name, end) and _fits(port, end, plant)]
        if len(near) == 1 and near[0].is_topic and (said is None or near[0] in said):
            found[port.name] = near[0]
    return _unique(found)


def _ranked(
    port: Port, free: Sequence[_End], ends: Sequence[_End], plant: bool
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The free component ports that fit ``port``, the best first: by what they are for, by type, by place, by name.

    The second list has those of them for which the name of ``port`` says that it is.
    """
    if not free:
        return (), ()
    said = _for(port.name, ends)
    meant = {end.reference for end in said} if said is not None else {end.reference for end in ends if end.role}
    words = words_of(port.name)

    def rank(end: _End) -> tuple[bool, bool, int, str]:
        return end.reference not in meant, end.port.type != port.type, -len(words & end.name_words), end.reference

    fitting = [end.reference for end in sorted((e for e in free if _fits(port, e, plant)), key=rank)]
    return tuple(fitting), tuple(name for name in fitting if said is not None and name in meant)


@lru_cache(maxsize=4096)
def _split(name: str) -> tuple[str, ...]:
    """The words of a name in lower case, in order: ``PWMLeft1`` has ``pwm``, ``left`` and ``1``."""
    spaced = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])|(?<=[A-Za-z])(?=[0-9])", " ", name)
    return tuple(word.casefold() for word in re.split(r"[^A-Za-z0-9]+", spaced) if word)
