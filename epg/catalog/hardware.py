# SPDX-License-Identifier: Apache-2.0
"""Chips and boards as data: ``socs/`` and ``boards/`` below the ``targets`` folders; targets of these.

The relations that a chip's peripherals can have are few, and all are here: an instance is exclusive or has *slots*;
its users *agree* on attributes; it is reached through enumerated *pins*, through any pins, or through *neighbours*;
a *divider* makes its frequency of a clock; single values of attributes can be *unsupported*.  A chip that needs another
relation needs another line of Python, in :mod:`epg.resolve`; any other chip is a folder.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from types import MappingProxyType

from epg.catalog.layout import Layout, make_layout
from epg.catalog.platform import Platform
from epg.documents.items import flag_of, integer_range, map_of, pin_names, text_of, texts_of
from epg.quantity import parse_quantity
from epg.source import Span, YamlNode


@dataclass(frozen=True)
class Divider:
    """A frequency is ``clock / (prescaler * counter)``; both are whole numbers from a range, ends included."""

    prescaler: tuple[int, int]
    counter: tuple[int, int]


@dataclass(frozen=True)
class Peripheral:
    """Equal units of a chip.  ``pins`` says what a slot reaches: (instance, slot) -> pins, both counted from 0."""

    name: str
    title: str
    instances: tuple[str, ...]
    slots: tuple[str, ...]  # one nameless slot when instances are not divided
    slot_title: str
    agree: tuple[str, ...]
    divider: Divider | None
    clock: Fraction  # Hz, what the divider divides
    pins: Mapping[tuple[int, int], tuple[str, ...]]
    span: Span

    @property
    def a_title(self) -> str:
        return _with_article(self.title)

    def instance_title(self, instance: int) -> str:
        """What messages call an instance: ``PWM slice 1``."""
        return self.title if len(self.instances) == 1 else f"{self.title} {self.instances[instance]}"

    def slot_name(self, instance: int, slot: int) -> str:
        """What messages call a slot: ``PWM slice 1, channel A``."""
        if len(self.slots) == 1:
            return self.instance_title(instance)
        return f"{self.instance_title(instance)}, {self.slot_title} {self.slots[slot]}"


@dataclass(frozen=True)
class Unsupported:
    """Why a chip cannot do what an attribute asks for, and what a user can do instead."""

    because: str
    instead: str


@dataclass(frozen=True)
class ResourceClass:
    """What kinds and platforms claim, and how this chip implements it.

    ``signals`` says how the pin of a signal is found: "any" pin, one of the "slot" that is taken, or one of a slot
    that is named.  ``unsupported`` maps an attribute and a value of it to why claims must not have it.
    """

    name: str
    title: str
    peripheral: str | None  # None: pins alone
    whole: bool  # takes all slots of an instance
    instances: tuple[str, ...]  # only these; empty: all
    signals: Mapping[str, str]
    neighbours: tuple[str, ...]
    fixed: Mapping[str, object]
    divider_from: str | None  # "frequency" or "period"
    exact: bool
    counter: tuple[int, int] | None
    unsupported: Mapping[tuple[str, str], Unsupported]
    span: Span

    @property
    def a_title(self) -> str:
        return _with_article(self.title)


@dataclass(frozen=True)
class Soc:
    """A chip.  A pin's number in C is its place in ``pins``; ``automatic_pins`` are numbered by EPG instead.

    ``clock`` in Hz drives all dividers that state no other.
    """

    name: str
    title: str
    family: str
    clock: Fraction
    pins: tuple[str, ...]
    automatic_pins: int
    peripherals: Mapping[str, Peripheral]
    classes: Mapping[str, ResourceClass]
    folder: Path
    span: Span

    @cached_property
    def numbers(self) -> Mapping[str, int]:
        """The number in C of each pin."""
        return MappingProxyType({pin: number for number, pin in enumerate(self.pins)})


@dataclass(frozen=True)
class OnboardPin:
    """A pin that is not broken out but wired to something on the board."""

    title: str
    classes: tuple[str, ...]


@dataclass(frozen=True)
class Board:
    """A chip on a circuit board; ``names`` and ``prefixes`` are other ways to write its pins.

    ``sdks`` says what SDKs call the board: "pico_sdk" -> "pico2".  ``lacks`` are transports of
    platforms that it has not, and why.  ``devicetree`` are the nodes that the board's
    devicetree in Zephyr enables, with the pins they have; ``console`` is the one of its console, or empty.
    ``layout`` says where its pins are.
    """

    name: str
    summary: str
    soc: str
    pins: tuple[str, ...]
    prefixes: tuple[str, ...]
    names: Mapping[str, str]
    onboard: Mapping[str, OnboardPin]
    reserved: Mapping[str, str]
    sdks: Mapping[str, str]
    lacks: Mapping[str, str]
    devicetree: Mapping[str, tuple[str, ...]]
    console: str
    layout: Layout | None
    node: YamlNode
    folder: Path
    span: Span

    def pin_name(self, written: str) -> str:
        """The chip's name of a pin that is written as people do: ``GP10`` is ``10``, ``LED`` is ``25``."""
        if written in self.names:
            return self.names[written]
        for prefix in sorted(self.prefixes, key=len, reverse=True):  # GPIO before GP
            if written.startswith(prefix) and written != prefix:
                return written[len(prefix) :]
        return written


@dataclass(frozen=True)
class Target:
    """A board with a platform: what ``target:`` in a ``.tcf`` names."""

    name: str
    board: Board
    soc: Soc
    platform: Platform

    @property
    def files(self) -> tuple[Path, ...]:
        """The files that say all this."""
        return (
            self.board.folder / "board.yaml",
            self.platform.folder / "platform.yaml",
            self.soc.folder / "soc.yaml",
            *(() if self.platform.family is None else (self.platform.family.folder / "family.yaml",)),
        )

    @property
    def has_pins(self) -> bool:
        """Whether users name pins; else EPG numbers them."""
        return self.soc.automatic_pins == 0

    @property
    def tick(self) -> str | None:
        """The class of the peripheral that times the control loop, None where the system software does."""
        name = self.platform.tick
        return None if self.platform.tick_is_optional and name not in self.soc.classes else name

    def resource_class(self, name: str) -> ResourceClass | None:
        """How this target implements a class, or None if it does not."""
        return self.soc.classes.get(name) if name in self.platform.classes else None


def make_soc(node: YamlNode, folder: Path) -> Soc:
    """The chip that a checked ``soc.yaml`` describes."""
    automatic = node.get("pins", "automatic")
    peripherals = {name: _peripheral(name, child, node) for name, child in map_of(node, "peripherals").items()}
    classes = {name: _resource_class(name, child, node) for name, child in map_of(node, "classes").items()}
    count = automatic.value if automatic is not None and isinstance(automatic.value, int) else 0
    return Soc(
        name=text_of(node, "soc"),
        title=text_of(node, "title"),
        family=text_of(node, "family"),
        clock=_clock(node["clock"]),
        pins=pin_names(node.get("pins")),
        automatic_pins=count,
        peripherals=MappingProxyType(peripherals),
        classes=MappingProxyType(classes),
        folder=folder,
        span=node["soc"].span,
    )


def make_board(node: YamlNode, folder: Path) -> Board:
    """The board that a checked ``board.yaml`` describes."""
    onboard = {
        pin: OnboardPin(text_of(child, "title"), texts_of(child, "classes"))
        for pin, child in map_of(node, "onboard").items()
    }
    devicetree = node.get("devicetree")
    nodes = map_of(devicetree, "nodes") if devicetree is not None else {}
    return Board(
        name=text_of(node, "board"),
        summary=text_of(node, "summary"),
        soc=text_of(node, "soc"),
        pins=pin_names(node.get("pins")),
        prefixes=texts_of(node, "prefixes"),
        names=MappingProxyType({name: str(pin.value) for name, pin in map_of(node, "names").items()}),
        onboard=MappingProxyType(onboard),
        reserved=MappingProxyType({pin: str(reason.value) for pin, reason in map_of(node, "reserved").items()}),
        sdks=MappingProxyType({sdk: str(name.value) for sdk, name in map_of(node, "sdks").items()}),
        lacks=MappingProxyType({name: str(reason.value) for name, reason in map_of(node, "lacks").items()}),
        devicetree=MappingProxyType(
            {label: tuple(str(pin.value) for pin in pins.elements()) for label, pins in nodes.items()}
        ),
        console=text_of(devicetree, "console") if devicetree is not None else "",
        layout=make_layout(node, pin_names(node.get("pins"))),
        node=node,
        folder=folder,
        span=node["board"].span,
    )


def _peripheral(name: str, node: YamlNode, soc: YamlNode) -> Peripheral:
    instances = _names(node["instances"])
    slots: tuple[str, ...] = ("",)
    if "slots" in node:
        count, names = node.get("slots", "count"), node.get("slots", "names")
        slots = _names(names if names is not None else count)
    divider = node.get("divider")
    pins: dict[tuple[int, int], tuple[str, ...]] = {}
    for instance, reached in map_of(node, "pins").items():
        for slot, listed in reached.items():
            key = instances.index(instance), slots.index(slot)
            pins[key] = tuple(str(pin.value) for pin in listed.elements())
    return Peripheral(
        name=name,
        title=text_of(node, "title"),
        instances=instances,
        slots=slots,
        slot_title=text_of(node["slots"], "title") if "slots" in node else "",
        agree=texts_of(node, "agree"),
        divider=Divider(integer_range(divider["prescaler"]), integer_range(divider["counter"])) if divider else None,
        clock=_clock((divider.get("clock") if divider else None) or soc["clock"]),
        pins=MappingProxyType(pins),
        span=soc["peripherals"].key_span(name),
    )


def _resource_class(name: str, node: YamlNode, soc: YamlNode) -> ResourceClass:
    peripheral, counter = node.get("peripheral"), node.get("divider", "counter")
    divider = node.get("divider")
    return ResourceClass(
        name=name,
        title=text_of(node, "title"),
        peripheral=str(peripheral.value) if peripheral else None,
        whole=text_of(node, "takes") == "instance",
        instances=texts_of(node, "instances"),
        signals=MappingProxyType({signal: str(how.value) for signal, how in map_of(node, "signals").items()}),
        neighbours=texts_of(node, "neighbours"),
        fixed=MappingProxyType({key: value.value for key, value in map_of(node, "fixed").items()}),
        divider_from=text_of(divider, "from") if divider else None,
        exact=divider is not None and flag_of(divider, "exact"),
        counter=integer_range(counter) if counter else None,
        unsupported=MappingProxyType(
            {
                (attribute, value): Unsupported(text_of(reason, "because"), text_of(reason, "instead"))
                for attribute, values in map_of(node, "unsupported").items()
                for value, reason in map_of(values).items()
            }
        ),
        span=soc["classes"].key_span(name),
    )


def _clock(node: YamlNode) -> Fraction:
    return Fraction(parse_quantity(node.value, "frequency"))


def _names(node: YamlNode | None) -> tuple[str, ...]:
    """``[TIM1, TIM2]`` as it is, ``8`` as 0 ... 7, nothing as one nameless."""
    if node is None:
        return ("",)
    if isinstance(node.value, int):
        return tuple(str(number) for number in range(node.value))
    return tuple(str(element.value) for element in node.elements())


def _with_article(noun: str) -> str:
    return f"{'an' if noun[:1].casefold() in tuple('aeio') else 'a'} {noun}"
