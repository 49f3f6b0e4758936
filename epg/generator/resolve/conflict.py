# SPDX-License-Identifier: Apache-2.0
"""Reports why claims cannot be placed together: it finds minimal sets of claims that exclude each other.

A minimal set shows the user which claims are worth changing: without any one of them, the others have places.  A
message with all claims of the peripheral would not.  The search itself cannot tell the reason, because its states have
no names.  Therefore this module asks the search again, with fewer claims.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from epg.generator.catalog.hardware import Computer, Peripheral, ResourceClass
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.documents.items import pin_list
from epg.generator.documents.schema import extended_from
from epg.generator.quantity import show
from epg.generator.resolve.claims import Claim
from epg.generator.resolve.divisions import Divisions
from epg.generator.resolve.pins import Pins
from epg.generator.resolve.search import Demand, find_places


@dataclass(frozen=True)
class Candidate:
    """A claim without mistakes: the numbers of its pins in C, and its demand of a place on its peripheral.

    ``divisions`` is empty if the claim sets no divider.
    """

    claim: Claim
    resource_class: ResourceClass
    pins: Mapping[str, int]
    divisions: Divisions
    demand: Demand


def report_conflicts(
    candidates: Sequence[Candidate], peripheral: Peripheral, pins: Pins, diagnostics: Diagnostics
) -> None:
    """Reports an error for each set of claims that cannot be placed together.

    The caller has found that ``candidates`` have at least one such set.
    """
    left = list(candidates)
    elsewhere = [use.note for name, use in pins.others.instances.items() if name in peripheral.instances]
    while not _possible(left):
        core = smallest_conflict(left)
        alike = [candidate for candidate in left if candidate.demand == core[0].demand]
        if all(candidate.demand == core[0].demand for candidate in core):
            _too_many(alike, len(core) - 1, peripheral, pins.target, elsewhere, diagnostics)
            left = [candidate for candidate in left if candidate not in alike]
            continue
        others = [candidate for candidate in left if candidate is not core[-1]]
        if len(core) == 2 and all(_bound_by_pin(candidate) for candidate in core):
            _two(core[0], core[1], peripheral, _pins_hint(core[1], others, peripheral, pins), diagnostics)
        else:
            _several(core, peripheral, pins.target, elsewhere, diagnostics)
        left = others


def smallest_conflict(candidates: Sequence[Candidate]) -> list[Candidate]:
    """A minimal set of ``candidates`` that cannot be placed together: without any one of them, the others could.

    ``candidates`` must be a set that cannot be placed together.  The result is the same as if one claim after another
    were left out, and put back if the others then had places.  A binary search finds the same claims with fewer calls
    of :func:`find_places`: the next claim of the result is the last one for which this claim, all claims after it, and
    those found before cannot be placed together.
    """
    core: list[Candidate] = []
    first = 0
    while _possible(core):
        last = len(candidates) - 1
        while first < last:
            middle = (first + last + 1) // 2
            if _possible([*core, *candidates[middle:]]):
                last = middle - 1
            else:
                first = middle
        core.append(candidates[first])
        first += 1
    return core


def _possible(candidates: Sequence[Candidate]) -> bool:
    return find_places([candidate.demand for candidate in candidates]) is not None


def _bound_by_pin(candidate: Candidate) -> bool:
    """True if the pins of a claim decide which slot it gets."""
    return "slot" in candidate.resource_class.signals.values()


def _pins_hint(moved: Candidate, others: Sequence[Candidate], peripheral: Peripheral, pins: Pins) -> str:
    """A hint with the free pins on which ``moved`` would fit together with ``others``; empty if there are none."""
    if len(moved.claim.signals) != 1:
        return f"move {moved.claim.user} to other pins"
    signal = next(iter(moved.claim.signals))
    demands = [other.demand for other in others]
    if find_places(demands) is None:
        demands = []
        for other in others:  # Leave out the claims that exclude each other: they are reported separately.
            if find_places([*demands, other.demand]) is not None:
                demands.append(other.demand)
    good = [
        pin
        for pin in pins.usable(moved.resource_class, signal)
        if find_places([*demands, _moved(moved, signal, pin, peripheral, pins)]) is not None
    ]
    return f"move {moved.claim.user} to a free pin: {pin_list(good)}" if good else ""


def _moved(candidate: Candidate, signal: str, pin: str, peripheral: Peripheral, pins: Pins) -> Demand:
    return Demand(pins.reachable(candidate.resource_class, peripheral, {signal: pin}), candidate.demand.agree)


def _two(first: Candidate, second: Candidate, peripheral: Peripheral, hint: str, diagnostics: Diagnostics) -> None:
    """Reports two claims whose pins lead to the same slot, or to one instance that they need with other settings."""
    where = _common_name(first, second, peripheral)
    one_slot = first.demand.places == second.demand.places and len(first.demand.places) == 1
    differing = None if one_slot else _difference(first, second, peripheral)
    if differing is None:
        stated = next(iter(second.claim.signals.values()))
        message = f"{where} is already used by {first.claim.user}"
        notes = [Note("used here", next(iter(first.claim.signals.values())).span), *extended_from(stated)]
        diagnostics.error(f"{peripheral.name}-used-twice", stated.span, message, hint=hint, notes=notes)
        return
    attribute, one, other = differing
    users = f"{first.claim.user} and {second.claim.user}"
    message = f"{users} share {where}, which has only one {attribute}, not {one} and {other}"
    place = second.claim.place(attribute)
    notes = [Note(f"{one} is set here", first.claim.place(attribute).span), *extended_from(place)]
    id = f"{peripheral.name}-{attribute}-conflict"
    hint = f"write the same {attribute} for both" + (f", or {hint}" if hint else "")
    diagnostics.error(id, place.span, message, hint=hint, notes=notes)


def _too_many(
    alike: Sequence[Candidate],
    possible: int,
    peripheral: Peripheral,
    target: Computer,
    elsewhere: Sequence[Note],
    diagnostics: Diagnostics,
) -> None:
    """Reports more equal claims than there are places.  ``elsewhere`` are the notes about instances of other code."""
    title = alike[0].resource_class.title
    users = ", ".join(candidate.claim.user for candidate in alike)
    message = f"{len(alike)} {title}s are needed, but {target.name} has {possible} ({_extent(peripheral)})"
    hint = f"remove {len(alike) - possible} of {users}"
    notes = [Note(f"{candidate.claim.user} is one of them", candidate.claim.span) for candidate in alike[:-1]]
    notes += elsewhere
    diagnostics.error("too-many", alike[-1].claim.span, message, hint=hint, notes=notes)


def _several(
    core: Sequence[Candidate],
    peripheral: Peripheral,
    target: Computer,
    elsewhere: Sequence[Note],
    diagnostics: Diagnostics,
) -> None:
    """Reports a minimal set of different claims that do not fit together, as :func:`_too_many`."""
    last = core[-1]
    others = ", ".join(candidate.claim.user for candidate in core[:-1])
    needs = f"needs all of {peripheral.a_title}" if last.resource_class.whole else f"is {last.resource_class.a_title}"
    extent = f"{target.name} has {_extent(peripheral)}"
    message = f"no {peripheral.title} is free for {last.claim.user}, which {needs}: {extent}"
    slots = [candidate for candidate in core if not candidate.resource_class.whole]
    agreed = [name for name in peripheral.agree if len({_shown(candidate, name) for candidate in slots}) > 1]
    reason = f"; all users of one {peripheral.title} must have the same {' and '.join(agreed)}" if agreed else ""
    hint = f"the other users are {others}{reason}"
    notes = [
        Note(f"{candidate.claim.user} uses one as {candidate.resource_class.title}", candidate.claim.span)
        for candidate in core[:-1]
    ]
    notes += elsewhere
    diagnostics.error("too-many", last.claim.span, message, hint=hint, notes=notes)


def _extent(peripheral: Peripheral) -> str:
    """The numbers of instances and slots in words: ``2 PIO blocks with 4 state machines each``."""
    count, slots = len(peripheral.instances), len(peripheral.slots)
    instances = f"{count} {peripheral.title}s" if count > 1 else f"1 {peripheral.title}"
    if slots == 1:
        return instances
    return f"{instances} with {slots} {peripheral.slot_title}s" + (" each" if count > 1 else "")


def _common_name(first: Candidate, second: Candidate, peripheral: Peripheral) -> str:
    """The name of the slot or instance that both claims need."""
    common = first.demand.places & second.demand.places
    if len(common) == 1 and first.demand.places == second.demand.places:
        instance, slot = next(iter(common))
        return peripheral.slot_name(instance, slot) if slot >= 0 else peripheral.instance_title(instance)
    instances = {instance for instance, _ in first.demand.places | second.demand.places}
    if len(instances) == 1:
        return peripheral.instance_title(next(iter(instances)))
    return f"one {peripheral.title}"


def _difference(first: Candidate, second: Candidate, peripheral: Peripheral) -> tuple[str, str, str] | None:
    """The first attribute for which two claims want different values, with both values; None if there is none."""
    one, other = first.demand.agree, second.demand.agree
    assert isinstance(one, tuple) and isinstance(other, tuple)
    for attribute, a, b in zip(peripheral.agree, one, other):
        if a != b:
            return attribute, _shown(first, attribute), _shown(second, attribute)
    return None


def _shown(candidate: Candidate, attribute: str) -> str:
    """The value of an attribute with its unit, for messages."""
    divider = candidate.resource_class.divider_from
    if attribute in ("frequency", "period") and divider is not None:
        attribute = divider
    value = candidate.claim.attributes.get(attribute, candidate.resource_class.fixed.get(attribute, "none"))
    if attribute in ("frequency", "period") and isinstance(value, (int, float, Fraction)):
        return show(value, "frequency" if attribute == "frequency" else "time")
    return str(value)
