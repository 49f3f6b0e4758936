# SPDX-License-Identifier: Apache-2.0
"""The settings of dividers for claims: from the frequencies of the target's clocks, and the values in the ``.tcf``.

Instances of one peripheral can divide different clocks.  A claim therefore has a division for each input of a divider.
Its places are the instances whose clock can make the wanted value.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from types import MappingProxyType

from epg.generator.catalog.hardware import Computer, Divider, DividerInput, Peripheral, ResourceClass
from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.documents.schema import extended_from
from epg.generator.quantity import show
from epg.generator.resolve.claims import Claim
from epg.generator.resolve.divider import Division, clock_range, divide, neighbours
from epg.generator.resolve.pins import all_places
from epg.generator.resolve.search import Place

Divisions = Mapping[DividerInput, Division]
"""The setting for each input of a divider that can make the wanted value.  Empty if a claim sets no divider."""

_MANY = 12  # digits in messages, so that values that are close to each other look different


class Dividers:
    """The dividers of a target.  Reports claims that they cannot serve, and clocks whose frequency is missing."""

    def __init__(self, target: Computer, diagnostics: Diagnostics) -> None:
        self.target = target
        self.diagnostics = diagnostics
        self._waiting: dict[str, list[Claim]] = {}

    def divisions(
        self, claim: Claim, resource_class: ResourceClass, peripheral: Peripheral | None, places: Iterable[Place]
    ) -> Divisions:
        """The divisions for a claim, also for inputs that its ``places`` do not have.

        Two claims for the same value thus have equal divisions, which users of one instance must agree on.  Reports a
        value that no divider in ``places`` can make; without places, in those of the class.
        """
        attribute = resource_class.divider_from
        if peripheral is None or peripheral.divider is None or attribute is None:
            return {}
        if attribute not in claim.attributes:
            if claim.component:
                self._report_incomplete(claim, resource_class)
            return {}  # The period of the control loop can be unknown while there is no model yet.
        needed = _sources(peripheral, places or all_places(resource_class, peripheral))
        unknown = list(dict.fromkeys(source.clock for source in needed if input_frequency(self.target, source) is None))
        for name in unknown:
            self._waiting.setdefault(name, []).append(claim)
        if unknown:
            return {}
        divider = Divider(peripheral.divider.prescaler, resource_class.counter or peripheral.divider.counter)
        result = self._possible(claim, attribute, peripheral.sources, divider, resource_class.exact)
        if not result.keys() & set(needed):
            self._report_impossible(claim, resource_class, peripheral, divider, needed[0])
        return MappingProxyType(result)

    def _possible(
        self, claim: Claim, attribute: str, sources: Iterable[DividerInput], divider: Divider, exact: bool
    ) -> dict[DividerInput, Division]:
        """The divisions with the value that a claim wants, for those of the ``sources`` that have one."""
        clocks = {source: input_frequency(self.target, source) for source in sources}
        found = {
            source: _division(_clocks(claim, attribute, clock), divider, exact)
            for source, clock in clocks.items()
            if clock is not None
        }
        return {source: division for source, division in found.items() if division is not None}

    def report_missing_clocks(self) -> None:
        """Reports each clock that claims need and whose frequency no file sets, at the first of these claims."""
        for name, waiting in self._waiting.items():
            clock = self.target.clocks[name]
            claim, *others = waiting
            message = f"{claim.user} needs the frequency of {clock.title}, which {self.target.name} does not set"
            hint = f"add the frequency that your program sets, for example 'clocks: {{{name}: 100 MHz}}'"
            notes = [Note(f"{other.user} needs it, too", other.span) for other in others]
            notes.append(Note("the clock", clock.span))
            self.diagnostics.error("clock-missing", claim.span, message, hint=hint, notes=notes)

    def _report_incomplete(self, claim: Claim, resource_class: ResourceClass) -> None:
        attribute = resource_class.divider_from
        message = f"the claim '{claim.name}' has no '{attribute}', which {resource_class.a_title} needs"
        hint = f"add 'attributes: {{{attribute}: ...}}' with a parameter that has a value"
        notes = [Note("the class", resource_class.span)]
        self.diagnostics.error("incomplete-claim", claim.stated_in, message, hint=hint, notes=notes)

    def _report_impossible(
        self,
        claim: Claim,
        resource_class: ResourceClass,
        peripheral: Peripheral,
        divider: Divider,
        source: DividerInput,
    ) -> None:
        """Reports a value that is out of range, or that no setting reaches, with the limits of the input ``source``."""
        attribute, clock = resource_class.divider_from, input_frequency(self.target, source)
        assert attribute is not None and clock is not None
        stated, target = claim.place(attribute), self.target
        value = _value(claim, attribute)
        dimension = "frequency" if attribute == "frequency" else "time"
        first, last = clock_range(divider)
        clocks = _clocks(claim, attribute, clock)
        speed = show(clock, "frequency")
        notes = [*extended_from(stated), *target.clocks[source.clock].notes]
        if not first <= clocks <= last:
            what = f"{attribute} {show(value, dimension)} of {claim.user}"
            low, high = sorted(_written(n, attribute, clock) for n in (first, last))
            if value > high and attribute == "period":
                possible = f"the longest possible on {target.name} is {show(high, dimension, -1)}"
            else:
                possible = f"{resource_class.a_title} on {target.name} can have "
                possible += f"{show(low, dimension, 1)} to {show(high, dimension, -1)}"
            message = f"{what} is out of range: {possible}"
            most = f"{divider.prescaler[1]} x {divider.counter[1]}"
            hint = f"{peripheral.a_title} counts at most {most} periods of {speed}"
            self.diagnostics.error(f"{attribute}-out-of-range", stated.span, message, hint=hint, notes=notes)
            return
        near = sorted(_written(n, attribute, clock) for n in neighbours(clocks, divider, resource_class.exact))
        what = f"{attribute} {show(value, dimension, digits=_MANY)} of {claim.user}"
        message = f"{what} is not possible: the clock of {speed} cannot be divided to it"
        hint = f"nearest possible: {' and '.join(show(nearest, dimension, digits=_MANY) for nearest in near)}"
        self.diagnostics.error(f"{attribute}-not-possible", stated.span, message, hint=hint, notes=notes)


def _sources(peripheral: Peripheral, places: Iterable[Place]) -> list[DividerInput]:
    """The inputs of the dividers of the instances at ``places``, each once."""
    instances = sorted({instance for instance, _ in places})
    return list(dict.fromkeys(peripheral.sources[instance] for instance in instances))


def input_frequency(target: Computer, source: DividerInput) -> Fraction | None:
    """The frequency in Hz that a divider divides; None if no file sets it."""
    frequency = target.clocks[source.clock].frequency
    return None if frequency is None else frequency * source.factor


def asked_frequency(claim: Claim, resource_class: ResourceClass) -> Fraction:
    """The frequency in Hz that a claim wants of a divider."""
    attribute = resource_class.divider_from
    assert attribute is not None
    value = _value(claim, attribute)
    return value if attribute == "frequency" else 1 / value


def _value(claim: Claim, attribute: str) -> Fraction:
    """The frequency in Hz, or the period in s, that the claim wants."""
    value = claim.attributes[attribute]
    assert isinstance(value, (int, float, Fraction))
    return Fraction(value)


def _clocks(claim: Claim, attribute: str, clock: Fraction) -> Fraction:
    """The number of periods of ``clock`` (Hz) in the wanted period; 0 for a value that is not positive."""
    value = _value(claim, attribute)
    if value <= 0:
        return Fraction(0)
    return clock / value if attribute == "frequency" else clock * value


def _division(clocks: Fraction, divider: Divider, exact: bool) -> Division | None:
    first, last = clock_range(divider)
    return divide(clocks, divider, exact) if first <= clocks <= last else None


def _written(clocks: int, attribute: str, clock: Fraction) -> Fraction:
    """A number of clocks in the unit of the attribute: Hz or s."""
    return clock / clocks if attribute == "frequency" else clocks / clock
