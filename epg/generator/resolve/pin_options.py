# SPDX-License-Identifier: Apache-2.0
"""The pins that one signal can have: which fit, which are used or reserved, and the reason why others do not fit.

Each pin is tried by the allocation of a build.  A pin also fits if the other signals of the same claim can follow it:
an encoder's B must be next to A.

>>> # [option.pin for option in pin_options(configuration, period, ("pwm_pan", "value")) if option.state == "fits"]
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from fractions import Fraction

from epg.generator.catalog.hardware import ResourceClass
from epg.generator.check.configuration import Configuration
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.resolve.claims import Claim, tick_claims
from epg.generator.resolve.first_fit import ClaimSignal, complete_claims, first_fit, is_complete, signals_of, with_pins
from epg.generator.resolve.pins import Pins
from epg.generator.resolve.resolve import allocate_claims

__all__ = ["STATES", "PinOption", "pin_options"]

STATES = ("current", "fits", "used", "reserved", "unfit")


@dataclass(frozen=True)
class PinOption:
    """One pin of the board for a signal.

    ``pin`` is the chip's name.  ``state`` is one of :data:`STATES`, ``reason`` its explanation in words, or empty.
    ``user`` is the other signal that uses the pin.  ``changes`` are the pins that must be written for this choice.
    """

    pin: str
    state: str
    reason: str = ""
    user: ClaimSignal | None = None
    changes: Mapping[ClaimSignal, str] = field(default_factory=dict)


def pin_options(configuration: Configuration, period: Fraction | None, signal: ClaimSignal) -> tuple[PinOption, ...]:
    """All pins of the board for ``signal``, in the order of the chip; empty if there is no such signal.

    ``period`` is the control period in seconds, None if it is not known.
    """
    written = signals_of(configuration)
    kind_claim = next((each for each in _kind_claims(configuration, signal) if signal[1] in each[1].values()), None)
    if signal not in written or kind_claim is None:
        return ()
    return _Options(configuration, period, signal, written, *kind_claim).all()


def _kind_claims(configuration: Configuration, signal: ClaimSignal) -> list[tuple[str, Mapping[str, str]]]:
    component = configuration.components.get(signal[0])
    return [(claim.name, claim.signals) for claim in component.kind.claims] if component is not None else []


class _Options:
    """The options of ``signal``, which belongs to the claim ``claim`` with the pins ``own``."""

    def __init__(
        self,
        configuration: Configuration,
        period: Fraction | None,
        signal: ClaimSignal,
        written: Mapping[ClaimSignal, str],
        claim: str,
        own: Mapping[str, str],
    ) -> None:
        self.configuration, self.period, self.signal = configuration, period, signal
        self.target, board = configuration.target, configuration.target.board
        self.key = signal[0], claim
        self.siblings = [(signal[0], name) for name in own.values() if name != signal[1]]
        self.users = {board.pin_name(pin): user for user, pin in written.items() if pin and user != signal}
        self.current = board.pin_name(written[signal]) if written[signal] else ""
        self.class_signal = next(name for name, pin in own.items() if pin == signal[1])
        claims = with_pins(configuration, {})
        found = next(each for each in claims if each.key == self.key)
        self.resource_class = self.target.resource_class(found.resource_class)
        self.pins = Pins(self.target, claims, Diagnostics(), configuration.others)
        self.before = self._errors([each for each in claims if each.key != self.key])

    def all(self) -> tuple[PinOption, ...]:
        board = self.target.board
        shown = {*board.pins, *board.onboard, *board.reserved}
        return tuple(self._option(pin) for pin in self.target.soc.pins if pin in shown)

    def _option(self, pin: str) -> PinOption:
        board, onboard = self.target.board, self.target.board.onboard.get(pin)
        user = self.users.get(pin)
        if pin in board.reserved:
            return PinOption(pin, "reserved", board.reserved[pin])
        if pin in self.configuration.others.pins:
            return PinOption(pin, "reserved", "other code of the program uses it")
        if user is not None and user not in self.siblings:
            return PinOption(pin, "used", f"{' '.join(user)} uses it", user)
        if pin == self.current:
            return PinOption(pin, "current", "the present pin" + (f": {onboard.title}" if onboard else ""))
        if self.resource_class is None:
            return PinOption(pin, "unfit", f"{self.target.name} does not offer this use of a pin")
        changes, reason = self._tried(pin, self.resource_class)
        if not changes:
            return PinOption(pin, "unfit", reason)
        others = [f"{name} moves to {new}" for (_, name), new in changes.items() if (_, name) != self.signal]
        told = [onboard.title] if onboard else []
        if self.target.platform.has_nodes and pin in board.devicetree.get(board.console, ()):
            told.append("the console of Zephyr uses it now, and would be off")
        return PinOption(pin, "fits", ", ".join([*told, *others]), changes=changes)

    def _tried(self, pin: str, resource_class: ResourceClass) -> tuple[dict[ClaimSignal, str], str]:
        """The changes with which the signal can have ``pin``; without them, the reason why it cannot."""
        title = self.target.board.pin_title(pin)
        alone = {self.signal: title}
        claims = with_pins(self.configuration, alone)
        own = next(each for each in claims if each.key == self.key)
        errors = self._errors(claims)
        new = [message for message in errors if message not in self.before]
        if is_complete(own, self.target) and not new:
            return alone, ""
        peripheral = self.target.soc.peripherals.get(resource_class.peripheral or "")
        reaches = peripheral is None or self.pins.reachable(resource_class, peripheral, {self.class_signal: pin})
        if self.siblings and reaches:
            found = first_fit(self.configuration, self.period, self.siblings, alone)
            if found:
                return {**alone, **found}, ""
            return {}, "no pins are free for the other signals beside it"
        return {}, new[0] if new else "the other signals have no pins"

    def _errors(self, claims: Sequence[Claim]) -> list[str]:
        """The messages of the allocation of all claims that have their pins."""
        diagnostics = Diagnostics()
        ticks = tick_claims(self.target, self.period, self.configuration.control.period_span)
        complete = complete_claims(claims, self.target)
        allocate_claims([*complete, *ticks], self.configuration, self.period, diagnostics)
        return [problem.message for problem in diagnostics if problem.severity == "error"]
