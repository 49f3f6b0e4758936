# SPDX-License-Identifier: Apache-2.0
"""Checks the pins of claims: they must exist, be free, and reach the peripheral that is claimed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from types import MappingProxyType

from epg.generator.catalog.hardware import Computer, Peripheral, ResourceClass
from epg.generator.check.other_code import NO_OTHER_CODE, OtherCode
from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.documents.items import pin_list
from epg.generator.documents.schema import extended_from
from epg.generator.resolve.claims import Claim
from epg.generator.resolve.search import WHOLE, Place
from epg.generator.source import YamlNode


class Pins:
    """The pins of one target while its claims are checked.  The pins of claims that were checked before are taken."""

    def __init__(
        self, target: Computer, claims: Iterable[Claim], diagnostics: Diagnostics, others: OtherCode = NO_OTHER_CODE
    ) -> None:
        """``claims`` must be all claims of the target, so that hints name only pins that stay free."""
        self.target = target
        self.others = others
        self.diagnostics = diagnostics
        self.usable_pins = {*target.board.pins, *target.board.onboard}
        self.taken: dict[str, tuple[Claim, YamlNode]] = {}  # pin -> its user, and where it names the pin
        self.wanted = {target.board.pin_name(str(s.value)) for claim in claims for s in claim.signals.values()}
        self.numbered = 0  # number of signals that EPG has numbered
        self._places: dict[tuple[str, str], Mapping[str, frozenset[Place]]] = {}  # (class, signal) -> pin -> places
        self._anywhere: dict[str, frozenset[Place]] = {}  # class -> places

    def check(self, claim: Claim, resource_class: ResourceClass) -> Mapping[str, str] | None:
        """Signal -> pin of the chip, or None after reporting pins that do not exist or are not free.

        Empty on targets without pins, which only have names that must differ.
        """
        result: dict[str, str] = {}
        for signal, stated in claim.signals.items():
            pin = self.target.board.pin_name(str(stated.value))
            exists = not self.target.has_pins or self._exists(pin, stated)
            if exists and self._is_free(pin, stated, claim, signal, resource_class):
                result[signal] = pin
        if len(result) < len(claim.signals):
            return None
        return result if self.target.has_pins else {}

    def numbers(self, claim: Claim, resource_class: ResourceClass, pins: Mapping[str, str]) -> Mapping[str, int] | None:
        """Signal -> number of its pin in C.

        On targets without pins, the signals are numbered in the order of the claims.  None after reporting that there
        are no numbers left.
        """
        soc = self.target.soc
        if self.target.has_pins:
            return MappingProxyType({signal: soc.numbers[pin] for signal, pin in pins.items()})
        result = {signal: self.numbered + number for number, signal in enumerate(resource_class.signals)}
        self.numbered += len(result)
        if self.numbered > soc.automatic_pins:
            message = f"{self.target.name} has no free pin for {claim.user}: it has {soc.automatic_pins} pins"
            self.diagnostics.error("too-many", claim.span, message, hint="remove components")
            return None
        return MappingProxyType(result)

    def places(
        self, claim: Claim, resource_class: ResourceClass, peripheral: Peripheral, pins: Mapping[str, str]
    ) -> frozenset[Place]:
        """The places that ``claim`` can have with its pins; empty after reporting why there are none."""
        neighbours = [pins[signal] for signal in resource_class.neighbours if signal in pins]
        if len(neighbours) == 2 and not self._are_neighbours(*neighbours):
            self._report_neighbours(claim, resource_class, neighbours)
            return frozenset()
        found = self.reachable(resource_class, peripheral, pins)
        if not found:
            self._report_unreachable(claim, resource_class, peripheral, pins)
        return found

    def reachable(
        self, resource_class: ResourceClass, peripheral: Peripheral, pins: Mapping[str, str]
    ) -> frozenset[Place]:
        """The places that reach all ``pins`` with their signals."""
        common: frozenset[Place] | None = None
        for signal, pin in pins.items():
            if resource_class.signals.get(signal, "any") != "any":
                places = self._places_by_pin(resource_class, peripheral, signal).get(pin, frozenset())
                common = places if common is None else common & places
            elif pin not in self.target.soc.numbers:
                return frozenset()
        return self._all_places(resource_class, peripheral) if common is None else common

    def _all_places(self, resource_class: ResourceClass, peripheral: Peripheral) -> frozenset[Place]:
        if resource_class.name not in self._anywhere:
            self._anywhere[resource_class.name] = frozenset(all_places(resource_class, peripheral))
        return self._anywhere[resource_class.name]

    def _places_by_pin(
        self, resource_class: ResourceClass, peripheral: Peripheral, signal: str
    ) -> Mapping[str, frozenset[Place]]:
        """Pin -> the places in which ``signal`` can have it.  Only for a signal that cannot have "any" pin."""
        key = resource_class.name, signal
        if key not in self._places:
            result: dict[str, set[Place]] = {}
            for place in all_places(resource_class, peripheral):
                for pin in self._reached(resource_class, peripheral, signal, place):
                    result.setdefault(pin, set()).add(place)
            self._places[key] = {pin: frozenset(places) for pin, places in result.items()}
        return self._places[key]

    def usable(self, resource_class: ResourceClass, signal: str) -> list[str]:
        """The free pins that a signal of a class can have, in the order of the chip."""
        board = self.target.board
        free = set(board.pins) | {pin for pin, at in board.onboard.items() if resource_class.name in at.classes}
        free -= set(self.taken) | self.wanted | set(self.others.pins)
        return [pin for pin in self.target.soc.pins if pin in free and self._is_useful(resource_class, signal, pin)]

    def _exists(self, pin: str, stated: YamlNode) -> bool:
        """True if components can use the pin.  Reports a pin that the board does not have, or reserves for itself."""
        board, soc = self.target.board, self.target.soc
        id, message = "pin-reserved", f"pin {pin} of {board.name} is reserved: {board.reserved.get(pin)}"
        if pin not in board.reserved:
            if pin in self.usable_pins:
                return True
            what = "is not broken out" if pin in soc.numbers else "does not exist"
            id, message = "pin-unknown", f"pin {stated.value} {what} on {board.name}"
        hint = f"pins of {board.name}: {pin_list(board.pins)}"
        self.diagnostics.error(id, stated.span, message, hint=hint, notes=extended_from(stated))
        return False

    def _is_free(self, pin: str, stated: YamlNode, claim: Claim, signal: str, resource_class: ResourceClass) -> bool:
        """True after taking the pin for ``claim``.

        Reports a pin that another claim has taken, that other code uses, or that is wired to a device on the board of
        another class.
        """
        onboard = self.target.board.onboard.get(pin)
        if onboard and resource_class.name not in onboard.classes:
            message = f"pin {pin} is wired to {onboard.title} and cannot be used for {resource_class.a_title}"
            hint = self._free_hint(resource_class, signal)
            self.diagnostics.error("pin-cannot-reach", stated.span, message, hint=hint, notes=extended_from(stated))
            return False
        elsewhere = self.others.pins.get(pin)
        if elsewhere is not None:
            message = f"pin {pin} is used by other code of the program"
            hint = self._free_hint(resource_class, signal)
            notes = [elsewhere.note, *extended_from(stated)]
            self.diagnostics.error("other-code-pin", stated.span, message, hint=hint, notes=notes)
            return False
        if pin not in self.taken:
            self.taken[pin] = claim, stated
            return True
        other, first = self.taken[pin]
        whose = "by this component" if other.user == claim.user else f"by {other.user}"
        message = f"pin {pin} is already used {whose}"
        notes = [Note("used here", first.span), *extended_from(stated)]
        self.diagnostics.error(
            "pin-used-twice", stated.span, message, hint=self._free_hint(resource_class, signal), notes=notes
        )
        return False

    def _free_hint(self, resource_class: ResourceClass, signal: str) -> str:
        if not self.target.has_pins:
            return "name another pin, or leave 'pins' out"
        free = self.usable(resource_class, signal)
        if not free:
            return f"no pin is free for {resource_class.a_title}"
        return f"free pins for {resource_class.a_title}: {pin_list(free)}"

    def _reached(
        self, resource_class: ResourceClass, peripheral: Peripheral, signal: str, place: Place
    ) -> Sequence[str]:
        """The pins that ``signal`` has in ``place``."""
        how = resource_class.signals.get(signal, "any")
        if how == "any":
            return self.target.soc.pins
        slot = place[1] if how == "slot" else peripheral.slots.index(how)
        return peripheral.pins.get((place[0], slot), ())

    def _can_reach(self, resource_class: ResourceClass, signal: str, pin: str) -> bool:
        peripheral = self.target.soc.peripherals.get(resource_class.peripheral or "")
        return peripheral is None or bool(self.reachable(resource_class, peripheral, {signal: pin}))

    def _is_useful(self, resource_class: ResourceClass, signal: str, pin: str) -> bool:
        """True if a pin reaches an instance that no other code uses."""
        peripheral = self.target.soc.peripherals.get(resource_class.peripheral or "")
        if peripheral is None:
            return True
        reached = {
            peripheral.instances[instance] for instance, _ in self.reachable(resource_class, peripheral, {signal: pin})
        }
        return not reached.issubset(self.others.instances)

    def _are_neighbours(self, one: str, other: str) -> bool:
        numbers = self.target.soc.numbers
        return abs(numbers[one] - numbers[other]) == 1

    def _report_neighbours(self, claim: Claim, resource_class: ResourceClass, pins: Sequence[str]) -> None:
        first, second = (claim.signals[signal] for signal in resource_class.neighbours)
        names = " and ".join(resource_class.neighbours)
        message = f"pins {names} of {resource_class.a_title} must be adjacent: {pins[0]} and {pins[1]} are not"
        order = self.target.soc.pins
        free = {*self.usable(resource_class, resource_class.neighbours[0]), *pins}
        pairs = [pair for pair in pairwise(order) if free.issuperset(pair)]
        pairs.sort(key=lambda pair: pins[0] not in pair)  # Pairs with the first pin come first.
        shown = ", ".join(f"{one} and {other}" for one, other in pairs[:8])
        hint = f"free pairs: {shown}" if pairs else "no pair of adjacent pins is free"
        notes = [Note(f"pin {resource_class.neighbours[0]} is set here", first.span), *extended_from(second)]
        self.diagnostics.error("pins-not-neighbouring", second.span, message, hint=hint, notes=notes)

    def _report_unreachable(
        self, claim: Claim, resource_class: ResourceClass, peripheral: Peripheral, pins: Mapping[str, str]
    ) -> None:
        """Reports a pin that reaches no place, or several pins that reach no common place."""
        alone = [signal for signal, pin in pins.items() if not self._can_reach(resource_class, signal, pin)]
        for signal in alone:
            stated = claim.signals[signal]
            message = (
                f"pin {pins[signal]} cannot be '{signal}' of {resource_class.a_title}: no {peripheral.title} reaches it"
            )
            hint = self._free_hint(resource_class, signal)
            self.diagnostics.error("pin-cannot-reach", stated.span, message, hint=hint, notes=extended_from(stated))
        if alone:
            return
        *others, last = claim.signals.values()
        message = f"no {peripheral.title} reaches pins {', '.join(pins.values())} together"
        sets = [
            " and ".join(self._reached(resource_class, peripheral, signal, place)[0] for signal in pins)
            for place in all_places(resource_class, peripheral)
            if all(self._reached(resource_class, peripheral, signal, place) for signal in pins)
        ]
        hint = f"for example: {', '.join(dict.fromkeys(sets))}" if sets else ""
        notes = [*(Note("together with this pin", stated.span) for stated in others), *extended_from(last)]
        self.diagnostics.error("pin-cannot-reach", last.span, message, hint=hint, notes=notes)


def all_places(resource_class: ResourceClass, peripheral: Peripheral) -> list[Place]:
    """All places of a peripheral that a resource class can take, if the pins are ignored."""
    slots = [WHOLE] if resource_class.whole else list(range(len(peripheral.slots)))
    numbers = {name: number for number, name in enumerate(peripheral.instances)}
    names = resource_class.instances or peripheral.instances
    return [(numbers[name], slot) for name in names for slot in slots]
