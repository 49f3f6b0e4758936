# SPDX-License-Identifier: Apache-2.0
"""Counters of encoders: the longest time between two readings after which a count is still certain.

A counter with n bits wraps.  The difference of two readings is right if the counter has moved by less than half of its
range, 2^(n-1) counts.  The greatest speed of the axis, ``max_speed``, therefore limits the time between two readings.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from fractions import Fraction

from epg.generator.catalog.hardware import COUNT_BITS, Computer
from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.documents.schema import extended_from
from epg.generator.quantity import show
from epg.generator.resolve.allocation import Assignment
from epg.generator.resolve.claims import Claim, ClaimKey
from epg.generator.source import Span

__all__ = ["check_counters", "counter_bits", "counts_per_second", "longest_gap"]

SPEED = "max_speed"
"""The attribute of a claim with the greatest speed in rad/s."""

_MANY = 10**12
"""Larger numbers of counts are not printed."""
_SHORTEST = Fraction(1, 1_000_000)
"""The shortest control period in seconds."""


def counts_per_second(attributes: Mapping[str, object]) -> Fraction | None:
    """The greatest number of counts per second, None if the attributes of a claim do not say it.

    ``counts`` are for an ``angle`` of the load in rad.  Without them, ``counts_per_revolution`` are for a revolution of
    the encoder, which turns ``gear`` times as fast as the load.
    """
    speed = attributes.get(SPEED)
    if speed is None:
        return None
    if "counts" in attributes and "angle" in attributes:
        return _number(speed) * _number(attributes["counts"]) / _number(attributes["angle"])
    if "counts_per_revolution" not in attributes:
        return None
    turns = _number(speed) * _number(attributes.get("gear", 1)) / Fraction(2 * math.pi)
    return turns * _number(attributes["counts_per_revolution"])


def counter_bits(found: Assignment, claim: Claim, target: Computer) -> int:
    """The bits of the counter behind an assignment, at most the 32 that drivers are given."""
    resource_class = target.resource_class(claim.resource_class)
    peripheral = target.soc.peripherals.get((resource_class and resource_class.peripheral) or "")
    bits = COUNT_BITS
    if peripheral is not None and not found.node and not target.platform.extends_counters:
        bits = peripheral.bits[found.instance]
    stated = claim.attributes.get("counter_bits")
    return min(bits, stated if isinstance(stated, int) else bits, COUNT_BITS)


def longest_gap(found: Assignment, claim: Claim, target: Computer) -> Fraction | None:
    """The time in seconds in which the counter moves by half of its range; None if the greatest speed is not known."""
    rate = counts_per_second(found.attributes)
    return None if rate is None else 2 ** (counter_bits(found, claim, target) - 1) / rate


def check_counters(
    claims: Iterable[Claim],
    found: Mapping[ClaimKey, Assignment],
    target: Computer,
    period: Fraction,
    period_span: Span,
    diagnostics: Diagnostics,
) -> None:
    """Reports encoders that can move by half the range of their counter within a control ``period`` (s)."""
    for claim in claims:
        assignment = found[claim.key]
        gap = assignment.longest_gap
        if gap is None or period < gap:
            continue
        rate = counts_per_second(assignment.attributes)
        assert rate is not None
        bits = counter_bits(assignment, claim, target)
        place = claim.place(SPEED)
        moved = math.ceil(rate * period)
        many = f"{moved}" if moved <= _MANY else f"more than {_MANY}"
        message = f"at this speed, {claim.user} moves {many} counts in a control period, but "
        message += f"its counter ({assignment.resource}) has {bits} bits: it must move by less than {2 ** (bits - 1)}"
        hint = f"use a control period below {show(gap, 'time', -1)}"
        if gap <= _SHORTEST:
            hint = f"correct '{SPEED}', or the counts of the encoder"
        wider = _wider(claim, bits, target)
        hint += f", or pins of {' or '.join(wider)}, which have more bits" if wider else ""
        notes = [*extended_from(place), Note(f"the control period is {show(period, 'time')}", period_span)]
        diagnostics.error("encoder-too-fast", place.span, message, hint=hint, notes=notes)


def _wider(claim: Claim, bits: int, target: Computer) -> list[str]:
    """The instances whose counters have more than ``bits``."""
    resource_class = target.resource_class(claim.resource_class)
    peripheral = target.soc.peripherals.get((resource_class and resource_class.peripheral) or "")
    if resource_class is None or peripheral is None:
        return []
    names = resource_class.instances or peripheral.instances
    return [name for name in names if peripheral.bits[peripheral.instances.index(name)] > bits > 0 and len(names) > 1]


def _number(value: object) -> Fraction:
    assert isinstance(value, (int, float, Fraction))
    return Fraction(value)
