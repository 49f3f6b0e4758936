# SPDX-License-Identifier: Apache-2.0
"""Proposes pins: free ones with which the allocation of all claims succeeds.

The search gives one claim after another its pins, the claim with the fewest possible pins first.  After each step it
proves that the other claims still have places (:func:`~epg.generator.resolve.search.find_places`).  At its end the pins
pass the check of a build (:func:`~epg.generator.resolve.resolve.allocate_claims`).  The same configuration always gets
the same pins.

>>> # first_fit(configuration, period)                                     all signals without a pin
>>> # first_fit(configuration, period, [("encoder_pan", "a"), ("encoder_pan", "b")])
{('encoder_pan', 'a'): 'GP2', ('encoder_pan', 'b'): 'GP3'}
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from types import MappingProxyType

from epg.generator.catalog.hardware import Computer, Peripheral, ResourceClass
from epg.generator.check.configuration import Configuration
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.resolve.allocation import agreement
from epg.generator.resolve.claims import Claim, component_claims, tick_claims
from epg.generator.resolve.divisions import Dividers
from epg.generator.resolve.pins import Pins, all_places
from epg.generator.resolve.resolve import allocate_claims
from epg.generator.resolve.search import Demand, Place, find_places
from epg.generator.source import YamlNode

__all__ = ["ClaimSignal", "complete_claims", "first_fit", "is_complete", "signals_of", "usable_pin", "with_pins"]

ClaimSignal = tuple[str, str]
"""The name of a component, and that of a pin of its kind: ``("pwm_pan", "direction_a")``."""

_Pins = dict[ClaimSignal, str]
_MOST_TRIES = 3000
"""The number of pins that are tried before the search gives up."""


def signals_of(configuration: Configuration) -> dict[ClaimSignal, str]:
    """All signals that need a pin, each with the pin as it is written; empty if the ``.tcf`` states none."""
    result = {}
    for component in configuration.components.values():
        if not configuration.target.has_pins or "node" in component.node:
            continue
        pins = component.node.get("pins")
        for name in component.kind.pins:
            stated = pins.get(name) if pins is not None and pins.is_mapping else None
            result[component.name, name] = "" if stated is None else str(stated.value)
    return result


def usable_pin(target: Computer, written: str) -> bool:
    """True if the board has this pin, and components can use it."""
    pin = target.board.pin_name(written)
    return pin not in target.board.reserved and (pin in target.board.pins or pin in target.board.onboard)


def with_pins(configuration: Configuration, pins: Mapping[ClaimSignal, str]) -> list[Claim]:
    """The claims of the components, with ``pins`` instead of those of the ``.tcf``; an empty text is no pin."""
    result = []
    for claim in component_claims(configuration):
        kind = next((k for k in configuration.components[claim.component].kind.claims if k.name == claim.name), None)
        signals = dict(claim.signals)
        for signal, name in kind.signals.items() if kind is not None else ():
            pin = pins.get((claim.component, name))
            if pin:
                signals[signal] = replace(signals.get(signal, YamlNode(pin, claim.span)), value=pin)
            elif pin is not None:
                signals.pop(signal, None)
        result.append(replace(claim, signals=MappingProxyType(signals)))
    return result


def complete_claims(claims: Sequence[Claim], target: Computer) -> list[Claim]:
    """The claims whose signals all have pins: the others cannot be allocated yet."""
    return [claim for claim in claims if is_complete(claim, target)]


def is_complete(claim: Claim, target: Computer) -> bool:
    """True if all signals of a claim have pins, or if it cannot have pins on this target."""
    found = target.resource_class(claim.resource_class)
    return bool(claim.node) or found is None or all(signal in claim.signals for signal in found.signals)


def first_fit(
    configuration: Configuration,
    period: Fraction | None,
    wanted: Collection[ClaimSignal] | None = None,
    fixed: Mapping[ClaimSignal, str] = MappingProxyType({}),
) -> dict[ClaimSignal, str] | None:
    """Pins for the signals in ``wanted``, by default for all without a pin; None if no such pins are found.

    ``period`` is the control period in seconds, None if it is not known.  ``fixed`` are pins that replace those of the
    ``.tcf``; all other signals keep theirs.  Conflicts between other signals do not matter.
    """
    written = signals_of(configuration)
    open_signals = [signal for signal, pin in written.items() if (not pin if wanted is None else signal in wanted)]
    open_signals = [signal for signal in open_signals if signal not in fixed]
    if not open_signals:
        return {}
    return _Search(configuration, period, open_signals, fixed).solve()


@dataclass(frozen=True)
class _Open:
    """A claim that needs pins: the ``missing`` signals of its class, each with the pin of the kind, and their pins."""

    claim: Claim
    resource_class: ResourceClass
    peripheral: Peripheral | None
    missing: Mapping[str, str]
    allowed: frozenset[Place]
    demand: Demand  # the places that it can have with any of its pins
    choices: Mapping[str, Sequence[str]]


class _Search:
    """One search.  ``fixed`` and the pins of the other signals do not change."""

    def __init__(
        self,
        configuration: Configuration,
        period: Fraction | None,
        wanted: Sequence[ClaimSignal],
        fixed: Mapping[ClaimSignal, str],
    ) -> None:
        self.configuration, self.period = configuration, period
        self.target = configuration.target
        self.fixed = dict(fixed)
        claims = with_pins(configuration, {**fixed, **dict.fromkeys(wanted, "")})
        self.wanted = set(wanted)
        self.ticks = tick_claims(self.target, period, configuration.control.period_span)
        self.pins = Pins(self.target, claims, Diagnostics(), configuration.others)
        self.dividers = Dividers(self.target, Diagnostics())
        self.order = {pin: number for number, pin in enumerate(_preferred(self.target))}
        self.known = complete_claims(claims, self.target)
        self.taken = {pin for claim in claims for pin in self._stated(claim).values()}
        self.others = self._demands([*self.known, *self.ticks])
        self.open = [found for claim in claims if self._missing(claim) and (found := self._opened(claim)) is not None]
        self.solvable = len(self.open) == sum(bool(self._missing(claim)) for claim in claims)
        self.open.sort(key=lambda each: (each.peripheral is None, min(map(len, each.choices.values()))))
        self.tries = 0

    def solve(self) -> dict[ClaimSignal, str] | None:
        """The pins of the wanted signals, or None."""
        if not self.solvable or not self._possible({}):
            return None
        return self._placed(0, {}, [])

    def _placed(self, at: int, demands: Mapping[int, Demand], pins: Sequence[tuple[ClaimSignal, str]]) -> _Pins | None:
        """The pins of all claims, if those from ``at`` on have places beside ``demands`` and free ``pins``."""
        if at == len(self.open):
            return self._checked(dict(pins))
        each = self.open[at]
        used = self.taken | {pin for _, pin in pins}
        for chosen in self._choices(each, used):
            after = dict(demands)
            if each.peripheral is not None:
                places = self._places(each.claim, each.resource_class, each.peripheral, each.allowed, chosen)
                if not places:
                    continue
                after[at] = replace(each.demand, places=places)
            self.tries += 1
            if self.tries > _MOST_TRIES:
                return None
            if each.peripheral is not None and not self._possible(after):
                continue
            new = [((each.claim.component, each.missing[signal]), pin) for signal, pin in chosen.items()]
            found = self._placed(at + 1, after, [*pins, *new])
            if found is not None:
                return found
        return None

    def _choices(self, each: _Open, used: Collection[str]) -> Iterator[dict[str, str]]:
        """The sets of free pins for the missing signals of a claim, the preferred ones first.

        Of adjacent pins, the first signal gets the one with the lower number, if possible.
        """
        stated = self._stated(each.claim)
        free = [[pin for pin in each.choices[signal] if pin not in used] for signal in each.missing]
        found = []
        for chosen in itertools.product(*free):
            result = dict(zip(each.missing, chosen, strict=True))
            pair = [self.target.soc.numbers[(stated | result)[signal]] for signal in each.resource_class.neighbours]
            if len(set(chosen)) == len(chosen) and (not pair or abs(pair[0] - pair[1]) == 1):
                found.append((pair != sorted(pair), result))
        return (result for _, result in sorted(found, key=lambda item: item[0]))

    def _possible(self, demands: Mapping[int, Demand]) -> bool:
        """True if all claims have places: those in ``demands`` with their new pins, the others with any pins."""
        for peripheral, others in self.others.items():
            own = [
                demands.get(number, each.demand)
                for number, each in enumerate(self.open)
                if each.peripheral is not None and each.peripheral.name == peripheral
            ]
            if own and find_places([*others, *own]) is None:
                return False
        return True

    def _checked(self, pins: _Pins) -> _Pins | None:
        """``pins`` as they are written, if the allocation of all complete claims accepts them."""
        shown = {signal: self.target.board.pin_title(pin) for signal, pin in pins.items()}
        before = self._errors(self.known)
        claims = with_pins(self.configuration, {**self.fixed, **shown})
        if self._errors(complete_claims(claims, self.target)) > before:
            return None
        return {signal: shown[signal] for signal in signals_of(self.configuration) if signal in shown}

    def _errors(self, claims: Sequence[Claim]) -> int:
        diagnostics = Diagnostics()
        allocate_claims([*claims, *self.ticks], self.configuration, self.period, diagnostics)
        return diagnostics.error_count

    def _missing(self, claim: Claim) -> dict[str, str]:
        """The signals of a claim that this search must give pins to, each with the name of the kind's pin."""
        kind = self.configuration.components[claim.component].kind
        own = next(each for each in kind.claims if each.name == claim.name)
        return {
            signal: name
            for signal, name in own.signals.items()
            if (claim.component, name) in self.wanted and signal not in claim.signals
        }

    def _opened(self, claim: Claim) -> _Open | None:
        """A claim with missing pins; None if no pin of the board, or no peripheral, can be used for it."""
        resource_class = self.target.resource_class(claim.resource_class)
        if resource_class is None:
            return None
        peripheral = self.target.soc.peripherals.get(resource_class.peripheral or "")
        missing = self._missing(claim)
        usable = {
            signal: sorted((p for p in self._reaching(resource_class, peripheral, signal)), key=self.order.__getitem__)
            for signal in missing
        }
        if not all(usable.values()):
            return None
        if peripheral is None:
            return _Open(claim, resource_class, None, missing, frozenset(), Demand(frozenset()), usable)
        allowed = self._allowed(claim, resource_class, peripheral)
        reached = self._places(claim, resource_class, peripheral, allowed, {})
        for signal, pins in usable.items():
            reached &= frozenset().union(*(self.pins.reachable(resource_class, peripheral, {signal: p}) for p in pins))
        demand = Demand(reached, self._agreement(claim, resource_class, peripheral))
        return _Open(claim, resource_class, peripheral, missing, allowed, demand, usable) if reached else None

    def _reaching(self, resource_class: ResourceClass, peripheral: Peripheral | None, signal: str) -> list[str]:
        """The pins of the board's contacts that reach a peripheral of the class."""
        free = [pin for pin in self.order if pin not in self.pins.others.pins]
        if peripheral is None:
            return free
        return [pin for pin in free if self.pins.reachable(resource_class, peripheral, {signal: pin})]

    def _demands(self, claims: Sequence[Claim]) -> dict[str, list[Demand]]:
        """The demands of claims with pins, by their peripheral, without those that exclude earlier ones."""
        result: dict[str, list[Demand]] = {name: [] for name in self.target.soc.peripherals}
        for claim in claims:
            resource_class = self.target.resource_class(claim.resource_class)
            peripheral = self.target.soc.peripherals.get((resource_class and resource_class.peripheral) or "")
            if resource_class is None or peripheral is None or claim.node:
                continue
            allowed = self._allowed(claim, resource_class, peripheral)
            places = self._places(claim, resource_class, peripheral, allowed, {})
            demand = Demand(places, self._agreement(claim, resource_class, peripheral))
            if places and find_places([*result[peripheral.name], demand]) is not None:
                result[peripheral.name].append(demand)
        return result

    def _places(
        self,
        claim: Claim,
        resource_class: ResourceClass,
        peripheral: Peripheral,
        allowed: frozenset[Place],
        chosen: Mapping[str, str],
    ) -> frozenset[Place]:
        """The ``allowed`` places that a claim can have with its pins and the ``chosen`` ones."""
        return allowed & self.pins.reachable(resource_class, peripheral, {**self._stated(claim), **chosen})

    def _stated(self, claim: Claim) -> dict[str, str]:
        """The pins that a claim has already, by signal."""
        return {signal: self.target.board.pin_name(str(stated.value)) for signal, stated in claim.signals.items()}

    def _allowed(self, claim: Claim, resource_class: ResourceClass, peripheral: Peripheral) -> frozenset[Place]:
        """The places on instances that no other code uses, and whose clock can make the wanted value."""
        free = [
            place
            for place in all_places(resource_class, peripheral)
            if peripheral.instances[place[0]] not in self.pins.others.instances
        ]
        divisions = self.dividers.divisions(claim, resource_class, peripheral, free)
        return frozenset(place for place in free if not divisions or peripheral.sources[place[0]] in divisions)

    def _agreement(self, claim: Claim, resource_class: ResourceClass, peripheral: Peripheral) -> tuple[object, ...]:
        divisions = self.dividers.divisions(claim, resource_class, peripheral, ())
        return agreement(claim, resource_class, peripheral, divisions)


def _preferred(target: Computer) -> list[str]:
    """The pins with a contact, the best ones first: those with a printed name; those of the console last."""
    board = target.board
    printed, console = set(board.names.values()), set(board.devicetree.get(board.console, ()))
    numbers = target.soc.numbers
    usable = [pin for pin in board.pins if pin not in board.reserved and pin in numbers]
    return sorted(usable, key=lambda pin: (pin in console, pin not in printed, numbers[pin]))
