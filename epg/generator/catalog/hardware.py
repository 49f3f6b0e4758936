# SPDX-License-Identifier: Apache-2.0
"""Chips, boards and targets as data: the folders ``socs/`` and ``boards/`` in the folders of targets.

A chip's file can describe these relations between claims and peripherals, and no others:

- an instance has one user, or it has *slots* for several users;
- the users of an instance must *agree* on attributes;
- a signal can have certain *pins*, any pin, or must have a pin next to another one (*neighbours*);
- a *divider* makes the frequency of an instance from a clock, which can differ between instances;
- single values of attributes can be *unsupported*.

A chip with another relation needs new Python code in :mod:`epg.generator.resolve`.  Any other new chip is a new folder.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from functools import cached_property
from pathlib import Path
from types import MappingProxyType

from epg.generator.catalog.board_layout import Layout, make_layout
from epg.generator.catalog.clocks import Clock, make_clocks
from epg.generator.catalog.platform import Platform
from epg.generator.dataclass import dataclass
from epg.generator.documents.items import (
    flag_of,
    integer_of,
    integer_range,
    map_of,
    pin_names,
    text_of,
    texts_of,
    values_of,
)
from epg.generator.source import Span, YamlNode

COUNT_BITS = 32
"""The bits of counters for which a chip's file states nothing else."""


@dataclass(frozen=True)
class Divider:
    """A divider, whose frequency is ``clock / (prescaler * counter)``.

    ``prescaler`` and ``counter`` are the first and the last whole number of the possible range.
    """

    prescaler: tuple[int, int]
    counter: tuple[int, int]


@dataclass(frozen=True)
class DividerInput:
    """The input of a divider: ``factor`` times the frequency of a clock."""

    clock: str
    factor: int


@dataclass(frozen=True)
class Peripheral:
    """One kind of hardware in a chip, with all its instances.

    ``sources`` holds the input of the divider of each instance; it is empty without a divider.  ``pins`` holds the pins
    that each slot can reach: (instance, slot) -> pins, both counted from 0.  ``functions`` holds the numbers of their
    alternate functions, if the chip has them: (instance, slot) -> pin -> number.  ``bits`` holds the bits of each
    counter, ``triggered_by`` the instances that can start an instance in hardware.
    """

    name: str
    title: str
    instances: tuple[str, ...]
    slots: tuple[str, ...]  # one slot without a name if instances have no slots
    slot_title: str
    agree: tuple[str, ...]  # attributes that must be the same for all users of an instance
    divider: Divider | None
    sources: tuple[DividerInput, ...]
    pins: Mapping[tuple[int, int], tuple[str, ...]]
    functions: Mapping[tuple[int, int], Mapping[str, int]]
    bits: tuple[int, ...]
    triggered_by: Mapping[int, frozenset[int]]
    span: Span

    @property
    def a_title(self) -> str:
        return _with_article(self.title)

    def instance_title(self, instance: int) -> str:
        """The name of an instance in messages: ``PWM slice 1``."""
        return self.title if len(self.instances) == 1 else f"{self.title} {self.instances[instance]}"

    def slot_name(self, instance: int, slot: int) -> str:
        """The name of a slot in messages: ``PWM slice 1, channel A``."""
        if len(self.slots) == 1:
            return self.instance_title(instance)
        return f"{self.instance_title(instance)}, {self.slot_title} {self.slots[slot]}"


@dataclass(frozen=True)
class Unsupported:
    """A value of an attribute that a chip cannot provide: the reason, and the alternative for the user."""

    because: str
    instead: str


@dataclass(frozen=True)
class ResourceClass:
    """A resource class, which kinds and platforms claim, as this chip implements it.

    ``signals`` maps each signal to the pins that it can have: "any" pin, the pins of the "slot" that the claim gets, or
    the pins of a slot with this name.  ``unsupported`` maps (attribute, value) to the reason why claims must not have
    this value.
    """

    name: str
    title: str
    peripheral: str | None  # None: the class uses pins only
    whole: bool  # True if a claim takes all slots of an instance
    widest: bool  # True if instances with more bits are better
    instances: tuple[str, ...]  # the possible instances; empty: all
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
    """A chip.  The number of a pin in C is its index in ``pins``.

    A chip with ``automatic_pins`` has no real pins: EPG numbers the signals, up to this number.  With ``free_names``,
    users may give them any names.  ``memory`` is the RAM in bytes, None if it is not stated.  ``needs`` are names of
    tools, for platforms that its family implements.  ``clocks`` have the frequencies of the chip's file.
    ``cubemx_name`` is the beginning of its name in STM32CubeMX, or empty; ``cubemx_clocks`` maps clocks to their keys
    there.  ``identity`` is the chip's name in the output of the tool that flashes its family, or empty;
    ``identity_register`` is the register from which that tool reads it, or None.  ``drive`` is the Board-ID of a drive
    on which its boot program takes UF2 files, or empty.  ``usb_device`` holds the names and numbers of its USB device
    that the C of port layers contains, and the ``serial_digits``.  The port layer takes ``dma_streams`` when a target
    starts: ``dma_users`` maps a class to their number for each claim that carries bytes.
    """

    name: str
    title: str
    family: str
    clocks: Mapping[str, Clock]
    pins: tuple[str, ...]
    automatic_pins: int
    free_names: bool
    memory: int | None
    needs: tuple[str, ...]
    peripherals: Mapping[str, Peripheral]
    classes: Mapping[str, ResourceClass]
    cubemx_name: str
    cubemx_clocks: Mapping[str, str]
    identity: str
    identity_register: int | None
    drive: str
    usb_device: Mapping[str, object]
    dma_streams: tuple[str, ...]
    dma_users: Mapping[str, int]
    files: tuple[Path, ...]  # its own, and those of the chips that it extends
    span: Span

    @cached_property
    def numbers(self) -> Mapping[str, int]:
        """The number of each pin in C."""
        return MappingProxyType({pin: number for number, pin in enumerate(self.pins)})


@dataclass(frozen=True)
class OnboardPin:
    """A pin that is wired to a device on the board, such as an LED, and is not broken out."""

    title: str
    classes: tuple[str, ...]


@dataclass(frozen=True)
class Board:
    """A printed circuit board with a chip; ``names`` and ``prefixes`` are other ways to write its pins.

    ``sdks`` maps each SDK to its name of the board: "pico_sdk" -> "pico2".  ``flash`` is the flash for a program in
    bytes, None if it is not stated.  ``lacks`` maps the transports that this
    board does not have, although platforms offer them, to the reason.  ``devicetree`` maps each node that the board's
    devicetree in Zephyr enables to its pins; ``console`` is the node of the console, or empty.  ``layout`` describes
    the places of the pins; None for boards without pins.
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
    flash: int | None
    lacks: Mapping[str, str]
    devicetree: Mapping[str, tuple[str, ...]]
    console: str
    layout: Layout | None
    node: YamlNode
    files: tuple[Path, ...]  # its own, and those of the boards that it extends
    span: Span

    def pin_name(self, written: str) -> str:
        """The chip's name of a pin that a user has written: ``GP10`` is ``10``, ``LED`` is ``25``."""
        if written in self.names:
            return self.names[written]
        for prefix in sorted(self.prefixes, key=len, reverse=True):  # The longest first: GPIO before GP.
            if written.startswith(prefix) and written != prefix:
                return written[len(prefix) :]
        return written

    def pin_title(self, pin: str) -> str:
        """The chip's ``pin`` as users write it: ``GP10`` for ``10``."""
        return self.prefixes[0] + pin if self.prefixes and pin.isdigit() else pin


@dataclass(frozen=True)
class Computer:
    """A board with a platform, which the key ``target`` of a ``.tcf`` names.

    ``clocks`` have the frequencies of the chip and the board; those of a ``.tcf`` replace them in its configuration.
    """

    name: str
    board: Board
    soc: Soc
    platform: Platform
    clocks: Mapping[str, Clock] = field(default_factory=dict)

    @property
    def files(self) -> tuple[Path, ...]:
        """The files that describe the board, the platform, the chip and the family."""
        return (
            *self.board.files,
            self.platform.folder / "platform.yaml",
            *self.soc.files,
            *(() if self.platform.family is None else (self.platform.family.folder / "family.yaml",)),
        )

    @property
    def has_pins(self) -> bool:
        """True if the chip has pins that users name.  Otherwise EPG numbers signals."""
        return self.soc.automatic_pins == 0

    @property
    def tick(self) -> str | None:
        """The resource class that times the control loop, None if the system software times it."""
        name = self.platform.tick
        return None if self.platform.tick_is_optional and name not in self.soc.classes else name

    @property
    def tick_starts(self) -> str:
        """The resource class that starts together with the timer of the control loop; empty if there is none."""
        return "" if self.platform.family is None else self.platform.family.tick_starts

    @property
    def needs(self) -> tuple[str, ...]:
        """The names of the tools that a build needs: those of the platform, the family and the chip."""
        return self.platform.needs if self.platform.family is None else (*self.platform.needs, *self.soc.needs)

    @property
    def board_clocks(self) -> Mapping[str, YamlNode]:
        """The frequencies of clocks in the board's file.  On Zephyr, those of its devicetree replace the others."""
        of_devicetree = map_of(self.board.node, "devicetree", "clocks") if self.platform.has_nodes else {}
        return {**map_of(self.board.node, "clocks"), **of_devicetree}

    def resource_class(self, name: str) -> ResourceClass | None:
        """The resource class ``name`` as this target implements it, or None if it does not."""
        return self.soc.classes.get(name) if name in self.platform.classes else None


def make_soc(node: YamlNode, folder: Path) -> Soc:
    """The chip that a checked ``soc.yaml`` describes."""
    peripherals = {name: _peripheral(name, child, node) for name, child in map_of(node, "peripherals").items()}
    classes = {name: _resource_class(name, child, node) for name, child in map_of(node, "classes").items()}
    return Soc(
        name=text_of(node, "soc"),
        title=text_of(node, "title"),
        family=text_of(node, "family"),
        clocks=make_clocks(node),
        pins=pin_names(node.get("pins")),
        automatic_pins=integer_of(node, "pins", "automatic") or 0,
        free_names=flag_of(node, "pins", "names_are_free"),
        memory=integer_of(node, "memory"),
        needs=texts_of(node, "needs"),
        peripherals=MappingProxyType(peripherals),
        classes=MappingProxyType(classes),
        cubemx_name=text_of(node, "cubemx", "name"),
        cubemx_clocks=MappingProxyType({k: str(v.value) for k, v in map_of(node, "cubemx", "clocks").items()}),
        identity=text_of(node, "identity", "value"),
        identity_register=integer_of(node, "identity", "register"),
        drive=text_of(node, "identity", "drive"),
        usb_device=MappingProxyType({key: child.value for key, child in map_of(node, "usb_device").items()}),
        dma_streams=texts_of(node, "dma", "streams"),
        dma_users=MappingProxyType({k: int(str(v.value)) for k, v in map_of(node, "dma", "users").items()}),
        files=_files(node, folder / "soc.yaml"),
        span=node["soc"].span,
    )


def make_board(node: YamlNode, folder: Path) -> Board:
    """The board that a checked ``board.yaml`` describes."""
    onboard = {pin: OnboardPin(**values_of(child, OnboardPin)) for pin, child in map_of(node, "onboard").items()}
    nodes = map_of(node, "devicetree", "nodes")
    pins = pin_names(node.get("pins"))
    stated = {
        **values_of(node, Board),
        "name": text_of(node, "board"),
        "pins": pins,
        "console": text_of(node, "devicetree", "console"),
        "flash": integer_of(node, "flash"),
    }
    return Board(
        **stated,
        onboard=MappingProxyType(onboard),
        devicetree=MappingProxyType({label: texts_of(node, "devicetree", "nodes", label) for label in nodes}),
        layout=make_layout(node, pins, {*onboard, *map_of(node, "reserved")}),
        node=node,
        files=_files(node, folder / "board.yaml"),
        span=node["board"].span,
    )


def _files(node: YamlNode, own: Path) -> tuple[Path, ...]:
    """An item's ``own`` file, and the other files in which the values of ``node`` are written."""
    files = {own}
    nodes = [node]
    while nodes:
        node = nodes.pop()
        files.add(Path(node.span.file))
        nodes += (child for _, child in node.items())
    return tuple(sorted(files))


def _peripheral(name: str, node: YamlNode, soc: YamlNode) -> Peripheral:
    instances = names_of(node["instances"])
    slots = _slots(node)
    divider = node.get("divider")
    pins: dict[tuple[int, int], tuple[str, ...]] = {}
    functions: dict[tuple[int, int], Mapping[str, int]] = {}
    for instance, reached in map_of(node, "pins").items():
        for slot, listed in reached.items():
            key = instances.index(instance), slots.index(slot)
            pins[key] = tuple(name for name, _ in listed_pins(listed))
            numbers = {name: number.value for name, number in listed.items() if isinstance(number.value, int)}
            functions[key] = MappingProxyType(numbers)
    return Peripheral(
        name=name,
        title=text_of(node, "title"),
        instances=instances,
        slots=slots,
        slot_title=text_of(node, "slots", "title"),
        agree=texts_of(node, "agree"),
        divider=Divider(integer_range(divider["prescaler"]), integer_range(divider["counter"])) if divider else None,
        sources=_sources(divider, instances) if divider else (),
        pins=MappingProxyType(pins),
        functions=MappingProxyType(functions),
        bits=tuple(_bits(node, instance) for instance in instances),
        triggered_by=MappingProxyType(
            {
                instances.index(instance): frozenset(map(instances.index, texts_of(node, "triggered_by", instance)))
                for instance in map_of(node, "triggered_by")
            }
        ),
        span=soc["peripherals"].key_span(name),
    )


def _bits(node: YamlNode, instance: str) -> int:
    stated = integer_of(node, "bits", instance)
    return COUNT_BITS if stated is None else stated


def _slots(node: YamlNode) -> tuple[str, ...]:
    """The names of the slots of each instance; one without a name if the instances have no slots."""
    return names_of(node.get("slots", "names") or node.get("slots", "count")) or ("",)


def _resource_class(name: str, node: YamlNode, soc: YamlNode) -> ResourceClass:
    peripheral, counter = node.get("peripheral"), node.get("divider", "counter")
    divider = node.get("divider")
    stated = values_of(node, ResourceClass) | {
        "name": name,
        "whole": text_of(node, "takes") == "instance",
        "exact": divider is not None and flag_of(divider, "exact"),
    }
    return ResourceClass(
        **stated,
        peripheral=str(peripheral.value) if peripheral else None,
        fixed=MappingProxyType({key: value.value for key, value in map_of(node, "fixed").items()}),
        divider_from=text_of(divider, "from") if divider else None,
        counter=integer_range(counter) if counter else None,
        unsupported=MappingProxyType(
            {
                (attribute, value): Unsupported(**values_of(reason, Unsupported))
                for attribute, values in map_of(node, "unsupported").items()
                for value, reason in map_of(values).items()
            }
        ),
        span=soc["classes"].key_span(name),
    )


def _sources(divider: YamlNode, instances: tuple[str, ...]) -> tuple[DividerInput, ...]:
    times = integer_of(divider, "factor") or 1
    others = {name: clock for clock in map_of(divider, "others") for name in texts_of(divider, "others", clock)}
    return tuple(DividerInput(others.get(name, text_of(divider, "clock")), times) for name in instances)


def names_of(node: YamlNode | None) -> tuple[str, ...]:
    """The names in a list; "0" to "7" for the number 8; empty if ``node`` is None."""
    if node is None:
        return ()
    if isinstance(node.value, int):
        return tuple(str(number) for number in range(node.value))
    return tuple(str(element.value) for element in node.elements())


def listed_pins(node: YamlNode) -> list[tuple[str, Span]]:
    """The pins of a slot with their positions: the elements of a list, or the keys of a map."""
    if node.is_mapping:
        return [(name, node.key_span(name)) for name, _ in node.items()]
    return [(str(pin.value), pin.span) for pin in node.elements()]


def _with_article(noun: str) -> str:
    return f"{'an' if noun[:1].casefold() in tuple('aeio') else 'a'} {noun}"
