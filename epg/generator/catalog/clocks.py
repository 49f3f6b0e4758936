# SPDX-License-Identifier: Apache-2.0
"""The clocks of a chip: their names and limits, and their frequencies on a target.

A clock has the first of these frequencies: the one in the ``.tcf``, the one in the file of the board, the one in the
file of the chip.  A clock that is the ``same_as`` another one then has the frequency of that clock.  A clock can have
no frequency at all.  Then a claim that needs it is an error (:mod:`epg.generator.resolve.allocation`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from types import MappingProxyType

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note, did_you_mean
from epg.generator.documents.items import map_of, text_of
from epg.generator.documents.schema import extended_from, quantity_of
from epg.generator.quantity import parse_quantity, show
from epg.generator.source import Span, YamlNode

HIGHEST = 0xFFFF_FFFF
"""The highest frequency in Hz: port layers have frequencies as ``uint32_t``."""


@dataclass(frozen=True)
class Clock:
    """A clock of a chip.  Frequencies are in Hz.

    ``frequency`` is None if no file sets it.  ``same_as`` is the name of the clock that this one follows, or empty.
    ``stated`` is the frequency as a board or a ``.tcf`` has set it; None if it is that of the chip.
    """

    name: str
    title: str
    frequency: Fraction | None
    same_as: str
    maximum: Fraction | None
    span: Span
    stated: YamlNode | None = None

    @property
    def notes(self) -> list[Note]:
        """The position of the frequency, for messages about a value that the clock cannot make."""
        if self.stated is None:
            return []
        return [Note("the clock is set here", self.stated.span), *extended_from(self.stated)]


def make_clocks(node: YamlNode) -> Mapping[str, Clock]:
    """The clocks in a checked ``soc.yaml``."""
    return MappingProxyType(
        {
            name: Clock(
                name=name,
                title=text_of(clock, "title"),
                frequency=_frequency(clock.get("frequency")),
                same_as=text_of(clock, "same_as"),
                maximum=_frequency(clock.get("maximum")),
                span=node["clocks"].key_span(name),
            )
            for name, clock in map_of(node, "clocks").items()
        }
    )


def with_frequencies(clocks: Mapping[str, Clock], stated: Mapping[str, YamlNode]) -> Mapping[str, Clock]:
    """The clocks of a chip with the checked frequencies that ``stated`` sets by their names."""

    def set_on_target(clock: Clock) -> Clock:
        leader = clock if not clock.same_as or clock.name in stated else clocks[clock.same_as]
        node = stated.get(leader.name)
        return replace(clock, frequency=_frequency(node) if node else leader.frequency, stated=node)

    return MappingProxyType({name: set_on_target(clock) for name, clock in clocks.items()})


def check_clocks(node: YamlNode, diagnostics: Diagnostics) -> None:
    """Checks the clocks of a chip alone: each has at most one of ``frequency`` and ``same_as``."""
    clocks = map_of(node, "clocks")
    for name, clock in clocks.items():
        highest = check_frequency(clock["maximum"], diagnostics) if "maximum" in clock else None
        if "frequency" in clock:
            frequency = check_frequency(clock["frequency"], diagnostics)
            if frequency is not None and highest is not None and frequency > highest:
                message = f"clock '{name}' is faster than its 'maximum'"
                diagnostics.error("out-of-range", clock["frequency"].span, message)
        if "same_as" in clock:
            _check_leader(name, clock, clocks, diagnostics)


def _check_leader(name: str, clock: YamlNode, clocks: Mapping[str, YamlNode], diagnostics: Diagnostics) -> None:
    """Checks the clock that has always the frequency of the clock ``name``."""
    leader = clock["same_as"]
    if "frequency" in clock:
        message = f"clock '{name}' must not set both 'frequency' and 'same_as'"
        diagnostics.error("exactly-one", leader.span, message, hint="remove one of the two")
    others = [other for other, its in clocks.items() if other != name and "same_as" not in its]
    if leader.value not in others:
        message = f"'{leader.value}' is not a clock with a frequency that '{name}' can follow"
        hint = did_you_mean(str(leader.value), others)
        misspelt = leader.value not in clocks
        diagnostics.error("unknown-name", leader.span, message, hint=hint if misspelt else str(hint))


def check_stated(node: YamlNode | None, clocks: Mapping[str, Clock], chip: str, diagnostics: Diagnostics) -> bool:
    """True if the map ``clocks`` of a board or a ``.tcf`` has possible frequencies for clocks of the chip.

    Reports the mistakes otherwise.
    """
    good = True
    for name, value in node.items() if node is not None else ():
        assert node is not None
        clock = clocks.get(name)
        if clock is None:
            hint = did_you_mean(name, clocks, "its clocks")
            message = f"{chip} does not have a clock '{name}'"
            notes = extended_from(value)
            diagnostics.error("unknown-clock", node.key_span(name), message, hint=hint, notes=notes)
            good = False
            continue
        frequency = check_frequency(value, diagnostics)
        good = good and frequency is not None
        if frequency is not None and clock.maximum is not None and frequency > clock.maximum:
            good = False
            message = f"{clock.title} of {show(frequency, 'frequency')} is out of range: "
            message += f"{chip} can have at most {show(clock.maximum, 'frequency')}"
            diagnostics.error("out-of-range", value.span, message, notes=extended_from(value))
    return good


def check_frequency(node: YamlNode, diagnostics: Diagnostics) -> Fraction | None:
    """The frequency of a clock in Hz; None after reporting that it is not one."""
    frequency = quantity_of(node, "frequency", diagnostics)
    if frequency is None:
        return None
    exact = Fraction(frequency)
    if exact.denominator != 1 or not 0 < exact <= HIGHEST:
        message = f"'{node.value}' is out of range: a clock must have a whole number of Hz, from 1 Hz to {HIGHEST} Hz"
        diagnostics.error("out-of-range", node.span, message, notes=extended_from(node))
        return None
    return exact


def _frequency(node: YamlNode | None) -> Fraction | None:
    return None if node is None else Fraction(parse_quantity(node.value, "frequency"))
