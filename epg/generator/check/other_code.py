# SPDX-License-Identifier: Apache-2.0
"""The use of the chip by the other code of a program, as its project file of STM32CubeMX (``.ioc``) states it.

CubeMX generates the code that sets up pins, peripherals, clocks and interrupts.  EPG's part of the program must use
other pins and peripherals.  Only these keys of the file are read: ``Mcu.*``, ``<pin>.Signal``, ``SH.*``,
``VP_*.Signal``, ``Dma.*.Instance``, ``NVIC.*`` and ``RCC.*Freq_Value``.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import field
from fractions import Fraction
from types import MappingProxyType
from typing import TYPE_CHECKING

from epg.generator.catalog.hardware import Computer, Soc
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.quantity import show
from epg.generator.source import Span

if TYPE_CHECKING:
    from epg.generator.documents.ioc_file import Ioc, IocEntry

_PIN = r"(P[A-Z]\d{1,2})(?:[-_ ].*)?\.Signal"  # PA13 (JTMS/SWDIO), PC14-OSC32_IN (OSC32_IN), PC2_C
_VIRTUAL = r"VP_(\w+)\.Signal"
_SHARED = r"SH\.(.+)\.\d+"
_PERIPHERAL = r"Mcu\.IP\d+"
_STREAM = r"Dma\.(.+)\.\d+\.Instance"  # Dma.USART2_RX.0.Instance
_INTERRUPT = r"NVIC\.(\w+)_IRQn"
_TIMERS = r"RCC\.(APB\d?TimFreq|Tim\dOutputFreq)_Value"  # clocks of timers; the names differ between families of chips
_TIME_BASE = r"SYS_VS_(tim\d+)"  # the timer of HAL's tick
_ALWAYS = ("GPIO", "GPXTI", "DEBUG", "SYS", "RCC")
"""Beginnings of signals whose peripheral need not be in CubeMX's list of peripherals."""
_FAULTS = ("NonMaskableInt", "HardFault", "MemoryManagement", "BusFault", "UsageFault", "DebugMonitor")
_KERNEL = ("SVCall", "PendSV")  # run only if a program asks for it
_FOUR_BITS = "NVIC_PRIORITYGROUP_4"


@dataclass(frozen=True)
class OtherUse:
    """The signals or the peripheral for which other code uses a pin or an instance, and where the file states it."""

    signal: str
    span: Span

    @property
    def note(self) -> Note:
        return Note(f"STM32CubeMX sets up {self.signal}", self.span)


@dataclass(frozen=True)
class OtherCode:
    """The use of the chip by other code: clocks by EPG's names, and pins, instances and DMA streams by the chip's.

    Frequencies are in Hz; a clock that the file does not state is not in ``clocks``.
    """

    pins: Mapping[str, OtherUse] = field(default_factory=dict)
    instances: Mapping[str, OtherUse] = field(default_factory=dict)
    streams: Mapping[str, OtherUse] = field(default_factory=dict)
    clocks: Mapping[str, tuple[Fraction, Span]] = field(default_factory=dict)

    def uses_of(self, instance: str, pins: Iterable[str]) -> list[OtherUse]:
        """The uses of an instance and of these pins."""
        own = [self.instances[instance]] if instance in self.instances else []
        return own + [self.pins[pin] for pin in pins if pin in self.pins]


NO_OTHER_CODE = OtherCode()


def check_other_code(
    ioc: Ioc, target: Computer, target_span: Span, diagnostics: Diagnostics, wanted_by: Span | None = None
) -> OtherCode:
    """The use of the chip that ``ioc`` states.  ``wanted_by`` is the position at which the file is named.

    Reports a file for another chip, instances that EPG's port layer needs itself, and priorities of interrupts that do
    not fit.  The file is an error for a target whose drivers are the user's.  Other targets without
    pins, such as the host, ignore what it says.
    """
    if target.soc.free_names:
        _refuse(ioc, target, wanted_by, diagnostics)
        return NO_OTHER_CODE
    if not _is_for(ioc, target, target_span, diagnostics) or not target.has_pins:
        return NO_OTHER_CODE
    listed = {entry.value: entry for _, entry in ioc.matching(_PERIPHERAL)}
    pins = _pins(ioc, listed)
    instances = _instances(ioc, listed, target)
    family = target.platform.family
    if family is not None:
        _report_own(family.own, instances, target, diagnostics)
        _report_priorities(ioc, target, diagnostics)
    return OtherCode(
        pins=MappingProxyType(pins),
        instances=MappingProxyType(instances),
        streams=MappingProxyType(
            {use.value: OtherUse(f"{use.value} for {match[1]}", use.span) for match, use in ioc.matching(_STREAM)}
        ),
        clocks=MappingProxyType(_clocks(ioc, target.soc)),
    )


def _instances(ioc: Ioc, listed: Mapping[str, IocEntry], target: Computer) -> dict[str, OtherUse]:
    """The instances of the chip's peripherals that other code uses, also as its time base."""
    known = {name for peripheral in target.soc.peripherals.values() for name in peripheral.instances}
    instances = {name: OtherUse(name, entry.span) for name, entry in listed.items() if name in known}
    for _, entry in ioc.matching(_VIRTUAL):
        base = re.fullmatch(_TIME_BASE, entry.value)
        name = base[1].upper() if base else entry.value.partition("_")[0]
        if name in known:
            instances[name] = OtherUse(f"{name} as the time base of HAL" if base else entry.value, entry.span)
    return instances


def _refuse(ioc: Ioc, target: Computer, wanted_by: Span | None, diagnostics: Diagnostics) -> None:
    """Reports a file for a target of which EPG does not know the chip.

    Such a target has one clock for all timers, of the highest frequency that one of them has.
    """
    timers = [
        (Fraction(entry.value), match[1], entry.span)
        for match, entry in ioc.matching(_TIMERS)
        if re.fullmatch(r"[1-9][0-9]{0,11}", entry.value)
    ]
    highest = max(timers)[0] if timers else None
    frequency = "<frequency>" if highest is None else show(highest, "frequency")
    clocks = ", ".join(f"{name}: {frequency}" for name in target.clocks)
    known = all(clock.frequency == highest for clock in target.clocks.values())
    message = f"target '{target.name}' cannot use '{ioc.path.name}': EPG has no drivers for its chip"
    where = "the .tcf already has" if known else "write into the .tcf"
    hint = f"do not name the .ioc: {where} 'clocks: {{{clocks}}}'; the 'pins' of components can have the names of its "
    hint += "pins, and EPG reports one that is used twice"
    notes = [Note(f"{key} is {show(value, 'frequency')} in STM32CubeMX", span) for value, key, span in timers]
    notes += [note for clock in target.clocks.values() for note in clock.notes]
    diagnostics.error("ioc-own-drivers", wanted_by or Span(str(ioc.path)), message, hint=hint, notes=notes)


def _is_for(ioc: Ioc, target: Computer, target_span: Span, diagnostics: Diagnostics) -> bool:
    """True if the file is for the chip of the target, or if the target has no pins of a chip.

    Reports a file for another chip, and one that names no chip.
    """
    name = next((key for key in ("Mcu.UserName", "Mcu.CPN", "Mcu.Name") if ioc.value(key)), None)
    whole = Span(str(ioc.path))
    if name is None:
        message = f"'{ioc.path.name}' is not a project file of STM32CubeMX: it does not name a chip"
        diagnostics.error("ioc-not-cubemx", whole, message, hint="name the .ioc of the project")
        return False
    if not target.has_pins:
        return True
    entry = ioc.entries[name]
    wanted = target.soc.cubemx_name
    if wanted and entry.value.startswith(wanted):
        return True
    message = f"this project is for the chip {entry.value}, but {target.name} has an {target.soc.title}"
    hint = "choose the target of the project's board, or name another .ioc" if wanted else "remove the .ioc"
    diagnostics.error("ioc-other-chip", entry.span, message, hint=hint, notes=[Note("the target", target_span)])
    return False


def _pins(ioc: Ioc, listed: Mapping[str, IocEntry]) -> dict[str, OtherUse]:
    """The pins that the generated code sets up.

    CubeMX also stores pins of peripherals that are switched off, such as all pins that a board wires to something.
    """
    shared: dict[str, list[str]] = {}
    for match, entry in ioc.matching(_SHARED):
        shared.setdefault(match[1], []).append(entry.value.partition(",")[0])
    result = {}
    for match, entry in ioc.matching(_PIN):
        signals = shared.get(entry.value, [entry.value.removeprefix("S_")])
        used = [signal for signal in signals if not listed or _is_set_up(signal, listed)]
        if used:
            result[match[1]] = OtherUse(" and ".join(used), entry.span)
    return result


def _is_set_up(signal: str, listed: Iterable[str]) -> bool:
    return signal.startswith(_ALWAYS) or any(signal == name or signal.startswith(f"{name}_") for name in listed)


def _clocks(ioc: Ioc, soc: Soc) -> dict[str, tuple[Fraction, Span]]:
    result = {}
    for name, key in soc.cubemx_clocks.items():
        entry = ioc.entries.get(f"RCC.{key}")
        if entry is not None and re.fullmatch(r"[0-9]{1,12}", entry.value):
            result[name] = Fraction(entry.value), entry.span
    return result


def _report_own(own: Iterable[str], others: Mapping[str, OtherUse], target: Computer, diagnostics: Diagnostics) -> None:
    """Reports instances that EPG's port layer uses itself."""
    for name in own:
        if name in others:
            message = f"EPG uses {name} of {target.name} itself, but STM32CubeMX sets up {others[name].signal}"
            hint = f"choose another one than {name} in STM32CubeMX, and generate its code again"
            diagnostics.error("ioc-used-by-epg", others[name].span, message, hint=hint)


def _report_priorities(ioc: Ioc, target: Computer, diagnostics: Diagnostics) -> None:
    """Warns of interrupts that could delay the tick of the control loop.  The start of the target verifies them."""
    group = ioc.entries.get("NVIC.PriorityGroup")
    if group is not None and group.value != _FOUR_BITS:
        message = (
            f"the priority group {group.value} does not have 4 bits of preemption priority: the target will not start"
        )
        hint = f"choose 4 bits for the preemption priority in STM32CubeMX ({_FOUR_BITS})"
        diagnostics.warning("ioc-priority", group.span, message, hint=hint)
    high = [
        (match[1], entry.span)
        for match, entry in ioc.matching(_INTERRUPT)
        if match[1] not in (*_FAULTS, *_KERNEL) and entry.value.split(":")[:2] == ["true", "0"]
    ]
    if high:
        (first, span), *others = high
        message = f"interrupt {first} has the preemption priority 0, as the tick of the control loop: it must be lower"
        hint = "choose 1 or more in STM32CubeMX and generate its code again: the target does not start otherwise"
        notes = [Note(f"{name}, too", other) for name, other in others]
        diagnostics.warning("ioc-priority", span, message, hint=hint, notes=notes)
