# SPDX-License-Identifier: Apache-2.0
"""Allocation: gives each claim its pins, its peripheral and its settings.

A claim names a resource class, pins and attributes.  The data of the chip say which peripheral implements the class,
and which pins this peripheral reaches.  Allocation has three parts:

1. Check each claim alone, and report its mistakes.
2. For each peripheral, find places for all of its claims (:mod:`epg.generator.resolve.search`).
3. If there are no such places, report the claims that exclude each other (:mod:`epg.generator.resolve.conflict`).

Claims that still have a choice then get better places (:mod:`epg.generator.resolve.preferences`).
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import field, replace
from fractions import Fraction
from types import MappingProxyType

from epg.generator.catalog.hardware import Computer, Peripheral, ResourceClass
from epg.generator.check.other_code import NO_OTHER_CODE, OtherCode
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note, did_you_mean
from epg.generator.documents.schema import extended_from
from epg.generator.resolve.claims import TICK, Claim, ClaimKey
from epg.generator.resolve.conflict import Candidate, report_conflicts
from epg.generator.resolve.divisions import Dividers, Divisions, asked_frequency, input_frequency
from epg.generator.resolve.other_code import places_left
from epg.generator.resolve.pins import Pins
from epg.generator.resolve.preferences import start_of, triggering_place, widest_places
from epg.generator.resolve.search import WHOLE, Demand, Place, find_places

__all__ = ["Assignment", "Assignments", "agreement", "allocate", "as_written"]

NODES = 255
"""The ``instance`` of the first peripheral that a devicetree node describes.  The others count down from it."""

NODE_STEPS = 0xFFFF
"""The steps of a duty cycle for a PWM that a devicetree node describes.  EPG does not know its clock."""


@dataclass(frozen=True)
class AssignedPin:
    """A pin: its name in the data of the SoC or in the ``.tcf``, and its number in C.

    A pin that is not ``named`` has its number as its name.  ``function`` is the number of its alternate function; None
    for a plain pin, and for chips without such numbers.
    """

    name: str
    number: int
    function: int | None = None
    named: bool = True


@dataclass(frozen=True)
class Assignment:
    """The hardware of one claim.

    ``signals`` has the pins of its signals.  ``instance`` and ``slot`` are numbers in C, too; ``slot`` is 0
    if the claim takes the whole instance.  ``settings`` holds ``prescaler`` and ``top`` if there is a divider.
    ``resource`` is the name in messages: "PWM slice 1, channel A".  ``instance_name`` and ``slot_name`` are the names
    in the chip's data.  ``clock`` is the frequency that the divider divides, ``frequency`` its actual frequency, and
    ``asked`` the wanted one, all in Hz; they are None without a divider.  ``attributes`` are those of the claim, in
    base units.
    """

    signals: Mapping[str, AssignedPin]
    instance: int
    slot: int
    settings: Mapping[str, int]
    resource: str
    clock: Fraction | None = None
    frequency: Fraction | None = None
    asked: Fraction | None = None
    pins_are_real: bool = True
    """False if the target has no pins, and EPG has numbered the signals."""
    instance_name: str = ""
    slot_name: str = ""
    attributes: Mapping[str, object] = field(default_factory=dict)
    node: str = ""
    """The devicetree node that is used instead of pins and a peripheral."""
    start: str = ""
    """The start of the instance, if it starts together with the timer of the control loop, in words."""
    longest_gap: Fraction | None = None
    """The longest time in seconds between two readings of a counter; None if the greatest speed is not known."""

    @property
    def pins(self) -> dict[str, int]:
        """Signal -> the number of its pin in C."""
        return {signal: pin.number for signal, pin in self.signals.items()}

    @property
    def pin_names(self) -> dict[str, int | str]:
        """Signal -> the name of its pin, a number (GPIO 10) or a text (PD12), for those that are named."""
        named = {signal: pin.name for signal, pin in self.signals.items() if pin.named}
        return {signal: int(name) if name.isdigit() else name for signal, name in named.items()}


Assignments = Mapping[ClaimKey, Assignment]
"""The assignment of each claim of a component or of the control loop."""


def allocate(
    claims: Sequence[Claim], target: Computer, diagnostics: Diagnostics, others: OtherCode = NO_OTHER_CODE
) -> Assignments | None:
    """An assignment for each claim, or None after reporting mistakes and conflicts.

    The same claims get the same hardware in every run.  They get no pin or instance that is in ``others``.
    """
    errors = diagnostics.error_count
    named = [claim for claim in claims if claim.node]
    pins = Pins(target, claims, diagnostics, others)
    checked = _check([claim for claim in claims if not claim.node], pins, target, diagnostics)
    result = _nodes(named, target, diagnostics)
    for name, peripheral in target.soc.peripherals.items():
        wanted = [candidate for candidate in checked if candidate.resource_class.peripheral == name]
        result |= _on_peripheral(wanted, peripheral, pins, diagnostics)
    for candidate in checked:
        if candidate.resource_class.peripheral is None:
            result[candidate.claim.key] = _pins_only(candidate, target)
    if diagnostics.error_count > errors:
        return None
    return MappingProxyType({claim.key: result[claim.key] for claim in claims})


def _on_peripheral(
    candidates: Sequence[Candidate], peripheral: Peripheral, pins: Pins, diagnostics: Diagnostics
) -> dict[ClaimKey, Assignment]:
    """The assignments of the claims that need ``peripheral``; none after reporting that they exclude each other."""
    found = find_places([candidate.demand for candidate in candidates], _costs(peripheral))
    if found is None:
        report_conflicts(candidates, peripheral, pins, diagnostics)
        return {}
    target = pins.target
    places = _better(candidates, found, peripheral, target)
    result = {}
    for candidate in candidates:
        assignment = _assignment(candidate, peripheral, places[candidate.claim.key], target)
        start = _start(candidate, places, peripheral, target)
        result[candidate.claim.key] = replace(assignment, start=start) if start else assignment
    return result


def as_written(claims: Sequence[Claim], target: Computer) -> Assignments:
    """The pins of claims as the ``.tcf`` states them, also if they are in conflict, without peripherals.

    Pins that the chip does not have are left out.
    """
    result: dict[ClaimKey, Assignment] = {}
    for claim in claims:
        names = {signal: target.board.pin_name(str(stated.value)) for signal, stated in claim.signals.items()}
        numbers = target.soc.numbers
        pins = {signal: AssignedPin(pin, numbers[pin]) for signal, pin in names.items() if pin in numbers}
        if target.has_pins and pins:
            result[claim.key] = Assignment(MappingProxyType(pins), 0, 0, MappingProxyType({}), "")
    return MappingProxyType(result)


def _nodes(claims: Sequence[Claim], target: Computer, diagnostics: Diagnostics) -> dict[ClaimKey, Assignment]:
    """The assignments of claims that name a devicetree node.

    They take no peripheral or pin of the chip.  Their numbers in C count down from :data:`NODES`, so that they differ
    from the numbers of the chip.
    """
    result = {}
    number = NODES
    for place, claim in enumerate(claims):
        resource_class = _class(claim, target, diagnostics)
        if resource_class is None:
            continue
        signals = list(resource_class.signals)
        divided = resource_class.divider_from is not None
        result[claim.key] = Assignment(
            signals=_signals({signal: number - index for index, signal in enumerate(signals)}, {}),
            instance=NODES - place,
            slot=0,
            settings=MappingProxyType({"prescaler": 1, "top": NODE_STEPS - 1} if divided else {}),
            resource=f"devicetree node {claim.node}",
            pins_are_real=False,
            attributes=claim.attributes,
            node=claim.node,
        )
        number -= len(signals)
        if number < len(target.soc.pins):
            message = f"{target.name} has too few pin numbers for the node of {claim.user}"
            diagnostics.error("too-many", claim.span, message, hint="remove components that name a 'node'")
            break
    return result


def _check(claims: Sequence[Claim], pins: Pins, target: Computer, diagnostics: Diagnostics) -> list[Candidate]:
    """The claims without mistakes.  Reports the mistakes of the others."""
    result: list[Candidate] = []
    dividers = Dividers(target, diagnostics)
    for claim in claims:
        resource_class = _class(claim, target, diagnostics)
        if resource_class is None:
            continue
        pin_numbers = pins.check(claim, resource_class)
        peripheral = target.soc.peripherals.get(resource_class.peripheral or "")
        places: frozenset[Place] = frozenset()
        if pin_numbers is not None and peripheral is not None:
            places = pins.places(claim, resource_class, peripheral, pin_numbers)
            places = places_left(claim, places, peripheral, pins.others, diagnostics)
        errors = diagnostics.error_count
        _check_support(claim, resource_class, target, diagnostics)
        divisions = dividers.divisions(claim, resource_class, peripheral, places)
        if peripheral is not None and divisions:
            places = frozenset(place for place in places if peripheral.sources[place[0]] in divisions)
        if pin_numbers is None or (peripheral is not None and not places) or diagnostics.error_count > errors:
            continue
        numbers = pins.numbers(claim, resource_class, pin_numbers)
        if numbers is not None:
            agreed = agreement(claim, resource_class, peripheral, divisions)
            result.append(Candidate(claim, resource_class, numbers, divisions, Demand(places, agreed)))
    dividers.report_missing_clocks()
    return result


def _class(claim: Claim, target: Computer, diagnostics: Diagnostics) -> ResourceClass | None:
    """The resource class of a claim on this target.  Reports classes and signals that do not exist; then it is None."""
    resource_class = target.resource_class(claim.resource_class)
    if resource_class is None:
        offered = [name for name in target.platform.classes if name in target.soc.classes]
        message = f"{claim.user} needs a '{claim.resource_class}', which {target.name} does not offer"
        hint = did_you_mean(claim.resource_class, offered, "it offers")
        notes = [Note("claimed here", claim.stated_in)]
        diagnostics.error("unknown-class", claim.span, message, hint=hint, notes=notes)
        return None
    with_pins = target.has_pins and not claim.node
    return resource_class if _has_signals(claim, resource_class, with_pins, diagnostics) else None


def _has_signals(claim: Claim, resource_class: ResourceClass, with_pins: bool, diagnostics: Diagnostics) -> bool:
    """True if a claim has the signals of its class ``resource_class``.  Reports the others, and those without a pin."""
    unknown = [signal for signal in claim.signals if signal not in resource_class.signals]
    missing = [signal for signal in resource_class.signals if signal not in claim.signals] if with_pins else []
    for signal in unknown:
        hint = did_you_mean(signal, resource_class.signals, "signals")
        message = f"{resource_class.a_title} has no signal '{signal}'"
        diagnostics.error(
            "unknown-name", claim.stated_in, message, hint=hint, notes=[Note("the class", resource_class.span)]
        )
    for signal in missing:
        message = f"the claim '{claim.name}' has no pin for signal '{signal}' of {resource_class.a_title}"
        diagnostics.error("incomplete-claim", claim.stated_in, message, notes=[Note("the class", resource_class.span)])
    return not unknown and not missing


def _check_support(claim: Claim, resource_class: ResourceClass, target: Computer, diagnostics: Diagnostics) -> None:
    """Reports attributes with a value that this chip does not support."""
    for attribute, value in claim.attributes.items():
        unsupported = resource_class.unsupported.get((attribute, str(value)))
        if unsupported is not None:
            what = f"{attribute} '{value}' of {claim.user}"
            message = f"{what} does not work on {target.soc.title}: {unsupported.because}"
            hint, place = unsupported.instead, claim.place(attribute)
            diagnostics.error("unsupported-value", place.span, message, hint=hint, notes=extended_from(place))


def _better(
    candidates: Sequence[Candidate], chosen: tuple[Place, ...], peripheral: Peripheral, target: Computer
) -> dict[ClaimKey, Place]:
    """The places ``chosen`` for ``candidates``, or better ones."""
    costs = _costs(peripheral)
    demands = [candidate.demand for candidate in candidates]
    chosen = widest_places(demands, [candidate.resource_class for candidate in candidates], chosen, peripheral, costs)
    places = {candidate.claim.key: place for candidate, place in zip(candidates, chosen)}
    tick = next((candidate.demand for candidate in candidates if candidate.claim.key == TICK), None)
    if tick is not None and target.tick_starts:
        others = {c.claim.key: c.resource_class.name for c in candidates if c.claim.key != TICK}
        taken = {places[key][0] for key in others}
        started = {places[key][0] for key, name in others.items() if name == target.tick_starts}
        places[TICK] = triggering_place(tick, places[TICK], taken, started, peripheral, costs)
    return places


def _start(candidate: Candidate, places: Mapping[ClaimKey, Place], peripheral: Peripheral, target: Computer) -> str:
    """The start of an instance that starts together with the timer of the control loop; empty for others."""
    family = target.platform.family
    if family is None or not target.tick_starts or candidate.resource_class.name != target.tick_starts:
        return ""
    tick = places[TICK][0] if TICK in places else None
    return start_of(places[candidate.claim.key][0], tick, peripheral, family.start_otherwise)


def agreement(
    claim: Claim, resource_class: ResourceClass, peripheral: Peripheral | None, divisions: Divisions
) -> tuple[Hashable, ...]:
    """The values of the attributes that must be equal for all users of an instance."""
    names = () if peripheral is None else peripheral.agree
    return tuple(_agreed(claim, resource_class, divisions, attribute) for attribute in names)


def _agreed(claim: Claim, resource_class: ResourceClass, divisions: Divisions, attribute: str) -> Hashable:
    if attribute in ("frequency", "period") and divisions:
        return tuple(divisions.items())
    value = resource_class.fixed.get(attribute, claim.attributes.get(attribute))
    assert isinstance(value, Hashable)
    return value


def _costs(peripheral: Peripheral) -> list[int]:
    """For each instance, its number of pins.

    A claim without pins gets an instance with few pins, so that instances with many pins stay free for other claims.
    """
    counts = [0] * len(peripheral.instances)
    for (instance, _), pins in peripheral.pins.items():
        counts[instance] += len(pins)
    return counts


def _assignment(candidate: Candidate, peripheral: Peripheral, place: Place, target: Computer) -> Assignment:
    instance, slot = place
    settings: dict[str, int] = {}
    clock = frequency = asked = None
    if candidate.divisions:
        source = peripheral.sources[instance]
        clock, division = input_frequency(target, source), candidate.divisions[source]
        assert clock is not None
        settings = {"prescaler": division.prescaler, "top": division.counter - 1}
        frequency = clock / division.clocks
        asked = asked_frequency(candidate.claim, candidate.resource_class)
    functions = _functions(candidate, peripheral, place, target)
    whole = slot == WHOLE
    return Assignment(
        signals=_signals(candidate.pins, _names(candidate, target), functions),
        instance=instance,
        slot=0 if whole else slot,
        settings=MappingProxyType(settings),
        resource=peripheral.instance_title(instance) if whole else peripheral.slot_name(instance, slot),
        clock=clock,
        frequency=frequency,
        asked=asked,
        pins_are_real=target.has_pins,
        instance_name=peripheral.instances[instance],
        slot_name="" if whole else peripheral.slots[slot],
        attributes=candidate.claim.attributes,
    )


def _functions(candidate: Candidate, peripheral: Peripheral, place: Place, target: Computer) -> dict[str, int]:
    """The alternate functions of the pins of a claim in its ``place``."""
    found: dict[str, int] = {}
    for signal, number in candidate.pins.items() if target.has_pins else ():
        how = candidate.resource_class.signals[signal]
        slot = peripheral.slots.index(how) if how in peripheral.slots else place[1]
        functions = peripheral.functions.get((place[0], slot), {})
        if how != "any" and target.soc.pins[number] in functions:
            found[signal] = functions[target.soc.pins[number]]
    return found


def _names(candidate: Candidate, target: Computer) -> dict[str, str]:
    """The chip's names of the pins of a claim.  Without real pins, only the names that users have given."""
    if target.has_pins:
        return {signal: target.soc.pins[number] for signal, number in candidate.pins.items()}
    return {signal: str(written.value) for signal, written in candidate.claim.signals.items()}


def _signals(
    numbers: Mapping[str, int], names: Mapping[str, str], functions: Mapping[str, int] = MappingProxyType({})
) -> Mapping[str, AssignedPin]:
    return MappingProxyType(
        {
            signal: AssignedPin(names.get(signal, str(number)), number, functions.get(signal), signal in names)
            for signal, number in numbers.items()
        }
    )


def _pins_only(candidate: Candidate, target: Computer) -> Assignment:
    numbers = list(candidate.pins.values())
    names = ", ".join(target.soc.pins[number] if target.has_pins else str(number) for number in numbers)
    kind = "pin" if target.has_pins else "digital pin" if target.soc.free_names else "simulated pin"
    return Assignment(
        signals=_signals(candidate.pins, _names(candidate, target)),
        instance=0,
        slot=numbers[0],
        settings=MappingProxyType({}),
        resource=f"{kind} {names}",
        pins_are_real=target.has_pins,
        attributes=candidate.claim.attributes,
    )
