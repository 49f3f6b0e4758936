# SPDX-License-Identifier: Apache-2.0
"""Keeps EPG away from the peripherals and streams that other code of the program uses, and compares clocks with it."""

from __future__ import annotations

from collections.abc import Iterable

from epg.generator.catalog.hardware import Computer, Peripheral
from epg.generator.check.configuration import Configuration
from epg.generator.check.other_code import OtherCode
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.schema import extended_from
from epg.generator.quantity import show
from epg.generator.resolve.claims import Claim
from epg.generator.resolve.search import Place


def places_left(
    claim: Claim, places: frozenset[Place], peripheral: Peripheral, others: OtherCode, diagnostics: Diagnostics
) -> frozenset[Place]:
    """The ``places`` of a claim on instances that no other code uses; empty after reporting that there are none."""
    left = frozenset(place for place in places if peripheral.instances[place[0]] not in others.instances)
    if places and not left:
        names = [peripheral.instances[number] for number in sorted({instance for instance, _ in places})]
        what = (
            f"{peripheral.title} {names[0]}"
            if len(names) == 1
            else f"one of the {peripheral.title}s {', '.join(names)}"
        )
        which = "which" if len(names) == 1 else "all of which"
        message = f"{claim.user} needs {what}, {which} other code of the program uses"
        signals = list(claim.signals.values())
        span = signals[0].span if signals else claim.span
        free = "choose other pins, or " if signals else ""
        hint = f"{free}free one in STM32CubeMX and generate its code again"
        notes = [others.instances[name].note for name in names] + (extended_from(signals[0]) if signals else [])
        diagnostics.error("other-code-peripheral", span, message, hint=hint, notes=notes)
    return left


def report_streams(configuration: Configuration, claims: Iterable[Claim], diagnostics: Diagnostics) -> None:
    """Reports components for whose bytes other code leaves too few streams of the DMA."""
    soc, used = configuration.target.soc, configuration.others.streams
    if configuration.target.platform.family is None:
        return
    communication = configuration.communication
    free = [name for name in soc.dma_streams if name not in used]
    left = len(free)
    for claim in claims:
        needed = soc.dma_users.get(claim.resource_class, 0)
        if not needed or claim.component not in (communication.transport, communication.console_transport):
            continue
        left -= needed
        if left < 0:
            message = f"{claim.user} needs {needed} streams of the DMA, but other code of the program leaves "
            message += f"only {len(free)} of {len(soc.dma_streams)} for all users" if free else "none"
            hint = "free streams of DMA1 or DMA2 in STM32CubeMX, and generate its code again"
            notes = [used[name].note for name in soc.dma_streams if name in used]
            diagnostics.error("other-code-streams", claim.span, message, hint=hint, notes=notes)
            return


def report_own_transports(configuration: Configuration, diagnostics: Diagnostics) -> None:
    """Reports a transport of the port layer, such as USB, whose peripheral or pins other code uses.

    The chip's peripheral has the name of the transport.
    """
    target, others, communication = configuration.target, configuration.others, configuration.communication
    if target.platform.family is None:
        return
    used = {communication.transport: configuration.root.get("communication", "transport")}
    if communication.console is not None and communication.console_transport is None:
        own = next(iter(target.platform.middlewares.get(communication.console.name, ())), None)
        used = {own: configuration.root.get("communication", "console"), **used}
    for name, node in used.items():
        if name is None or name in configuration.components or name not in target.soc.peripherals:
            continue
        peripheral = target.soc.peripherals[name]
        pins = [pin for (instance, _), found in peripheral.pins.items() if instance == 0 for pin in found]
        uses = others.uses_of(peripheral.instances[0], pins)
        if uses:
            span = communication.span if node is None else node.span
            message = f"the transport '{name}' needs {peripheral.title} {peripheral.instances[0]} and the pins "
            message += f"{' and '.join(pins)}, which other code of the program uses"
            hint = "name a component that carries bytes, such as a uart, or free them in STM32CubeMX and generate its "
            hint += "code again"
            notes = [use.note for use in uses] + ([] if node is None else extended_from(node))
            diagnostics.error("other-code-transport", span, message, hint=hint, notes=notes)


def divided_clocks(target: Computer) -> set[str]:
    """The clocks that dividers of the chip divide."""
    return {source.clock for peripheral in target.soc.peripherals.values() for source in peripheral.sources}


def clock_of(claim: Claim, instance: int, target: Computer) -> str:
    """The clock that the divider of a claim divides if the claim has this instance."""
    resource_class = target.soc.classes[claim.resource_class]
    return target.soc.peripherals[resource_class.peripheral or ""].sources[instance].clock


def compare_clocks(used: Iterable[str], target: Computer, others: OtherCode, diagnostics: Diagnostics) -> None:
    """Warns of clocks in ``used`` that other code sets to another frequency than EPG has computed with."""
    for name in dict.fromkeys(used):
        clock = target.clocks[name]
        if name not in others.clocks or clock.frequency in (None, others.clocks[name][0]):
            continue
        frequency, span = others.clocks[name]
        assert clock.frequency is not None
        message = f"STM32CubeMX sets {clock.title} to {show(frequency, 'frequency')}, "
        message += f"but {target.name} computes with {show(clock.frequency, 'frequency')}"
        hint = (
            f"add 'clocks: {{{name}: {show(frequency, 'frequency')}}}' to the .tcf, or change the clock in STM32CubeMX"
        )
        diagnostics.warning("ioc-clock", span, message, hint=hint, notes=clock.notes)
