# SPDX-License-Identifier: Apache-2.0
"""Platforms and families of chips as data: ``platforms/`` and ``families/`` in the folders of targets.

A platform is a way of running: bare metal, FreeRTOS, Zephyr, on the host.  A family is a group of chips with the same
registers.  A platform either contains a port layer for the families or the board that it names, or the families
contain it and name the platform (``by_family``).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from epg.generator.catalog.added_class import AddedClass
from epg.generator.dataclass import dataclass
from epg.generator.documents.items import elements_of, flag_of, map_of, text_of, texts_of, values_of
from epg.generator.source import Span, YamlNode


@dataclass(frozen=True)
class Product:
    """A file that a build makes beside an executable; ``*`` in ``file`` is the executable's name without its suffix.

    ``what`` tells the user how to use the file.
    """

    file: str
    what: str


@dataclass(frozen=True)
class PortLayer:
    """What a platform and a family both have.

    ``middlewares`` maps each middleware to its transports, the default first.  With ``has_usb_names``, a target
    configuration can set the names of the USB device.  With ``has_console_on_components``, a console beside another
    middleware can use a component in place of a transport of the port layer.  ``sdk`` is the SDK whose name of the
    board is passed to a build, or "".  ``headers`` are the headers of the SDK that code includes by their name without
    a folder.  ``needs`` are names of tools.  ``products`` are the files that a build makes for the user, the most
    useful first.
    """

    name: str
    summary: str
    classes: tuple[str, ...]
    middlewares: Mapping[str, tuple[str, ...]]
    has_usb_names: bool
    has_console_on_components: bool
    templates: tuple[str, ...]
    sdk: str
    headers: tuple[str, ...]
    needs: tuple[str, ...]
    products: tuple[Product, ...]
    node: YamlNode
    folder: Path
    span: Span


@dataclass(frozen=True)
class Platform(PortLayer):
    """A way of running, for the chips of ``families``, for one ``board``, or ``by_family``.

    The port layer of a platform ``by_family`` is in the folders in ``families/``.  :func:`platform_for` returns the
    platform with the parts that the chip's ``family`` adds.  If ``builds`` is False, there is no port layer yet:
    targets can be checked but not built.

    A user does not choose a platform ``for_systems``: the simulation of a system does.

    ``tick`` is the resource class that times the control loop, None if the system software times it.  With
    ``tick_is_optional``, the system software also times it on chips without this class.  With ``has_nodes``, a
    component can name a devicetree node instead of pins.  With ``extends_counters``, its drivers extend counters of
    encoders in interrupts, so that they do not depend on the control period.  ``shared`` are folders beside this one
    whose templates the platform uses, too.  ``built_by`` is "cmake" or "west".  ``program`` is the CMake target of the
    executable if the SDK makes it.  ``added`` are the classes of peripherals that bring their C for this port layer.
    ``usb_vendors`` are vendors of USB devices by its own USB stack.
    """

    families: tuple[str, ...]
    usb_vendors: tuple[str, ...]
    board: str | None  # the only board of the platform; the only target then has the name of the platform
    simulates_plant: bool
    for_systems: bool
    tick: str | None
    tick_is_optional: bool
    has_nodes: bool
    extends_counters: bool
    builds: bool
    shared: tuple[str, ...]
    built_by: str
    program: str
    by_family: bool
    family: Family | None
    added: tuple[AddedClass, ...]

    @property
    def offers(self) -> YamlNode:
        """The file that lists the middlewares: that of the family, or of the platform."""
        return self.node if self.family is None else self.family.node

    @property
    def layer(self) -> str:
        """The name of the port layer: that of the family, or of the platform."""
        return self.name if self.family is None else self.family.name

    @property
    def template_folder(self) -> str:
        """The folder of its templates, relative to a folder of targets."""
        return f"platforms/{self.name}" if self.family is None else f"families/{self.family.name}"

    @property
    def folders(self) -> tuple[Path, ...]:
        """The folders whose templates the platform can use, its own folder first."""
        beside = tuple(self.folder.parent / name for name in self.shared)
        return (self.folder, *beside, *(() if self.family is None else (self.family.folder,)))

    @property
    def project_names(self) -> tuple[str, ...]:
        """The possible names of a folder in ``projects/`` for this platform, the most specific first."""
        return (self.name, *self.shared, *(() if self.family is None else (self.family.name,)))


@dataclass(frozen=True)
class Flashing:
    """How ``tool`` writes a program to a board: the arguments that follow the program's name.

    ``named_by`` is the key of a system file that names the board.  ``usb`` are the USB ids of the boards or of their
    debug probes.  In the arguments, ``{board}`` stands for ``by_serial``.  If no file names the board, and it has one
    of the USB ids ``without_serial``, ``{board}`` stands for ``by_place``.

    ``find`` prints facts about the board, and fails if the board cannot be written yet.  The regular expressions
    ``chip`` and ``program`` find the chip and the name of the target in these facts, and ``unusable`` finds a message
    of a tool that has no USB.  ``restart`` makes a board that runs a program ready to be written, and ``leave`` starts
    its program again; they are empty if a board is always ready.  ``by_hand`` tells the user what to do with a board
    that does not answer.  ``otherwise`` is the way that is used if only its tool is on the computer.
    """

    tool: str
    named_by: str
    by_serial: tuple[str, ...]
    by_place: tuple[str, ...]
    usb: tuple[str, ...]
    without_serial: tuple[str, ...]
    find: tuple[str, ...]
    restart: tuple[str, ...]
    leave: tuple[str, ...]
    write: tuple[str, ...]
    chip: str
    program: str
    unusable: str
    by_hand: str
    otherwise: Flashing | None = None


@dataclass(frozen=True)
class Family(PortLayer):
    """The port layer of a family of chips for ``platforms`` that are ``by_family``.

    ``own`` are instances of peripherals that it uses itself, such as TIM7.  Its port layer starts the peripherals of
    the class ``tick_starts`` together with the timer of the control loop: by a trigger, or as ``start_otherwise`` says.
    ``usb`` holds the default names and numbers of its USB device, if they are data, and the ``serial_digits``;
    ``usb_needs`` are names of tools that a target with it needs.  Without ``flash``, ``epg flash`` does not know its
    boards.
    """

    platforms: tuple[str, ...]
    own: tuple[str, ...]
    tick_starts: str
    start_otherwise: str
    usb: Mapping[str, object]
    usb_needs: tuple[str, ...]
    flash: Flashing | None


def _values(node: YamlNode, folder: Path, category: str, layer: type[PortLayer]) -> dict[str, Any]:
    """The attributes of a platform or family that are keys of its file, and all those of :class:`PortLayer`."""
    offered = map_of(node, "middlewares")
    products = elements_of(node, "products")
    return {
        **values_of(node, layer),
        "name": text_of(node, category),
        "middlewares": MappingProxyType({name: texts_of(node, "middlewares", name) for name in offered}),
        "has_usb_names": flag_of(node, "usb_names"),
        "has_console_on_components": flag_of(node, "console_on_components"),
        "products": tuple(Product(**values_of(product, Product)) for product in products),
        "node": node,
        "folder": folder,
        "span": node[category].span,
    }


def make_platform(node: YamlNode, folder: Path) -> Platform:
    """The platform that a checked ``platform.yaml`` describes."""
    values = _values(node, folder, "platform", Platform) | {
        "board": text_of(node, "board") or None,
        "tick": text_of(node, "tick", "class") or None,
        "tick_is_optional": flag_of(node, "tick", "optional"),
        "has_nodes": flag_of(node, "nodes"),
        "built_by": text_of(node, "built_by") or "cmake",
    }
    return Platform(**values, family=None, added=())


def _flashing(node: YamlNode) -> Flashing:
    flashing = Flashing(**values_of(node, Flashing))
    if "otherwise" not in node:
        return flashing
    other = values_of(node["otherwise"], Flashing)
    return replace(flashing, otherwise=replace(flashing, **{key: other[key] for key in map_of(node, "otherwise")}))


def make_family(node: YamlNode, folder: Path) -> Family:
    """The family that a checked ``family.yaml`` describes."""
    values = _values(node, folder, "family", Family) | {
        "tick_starts": text_of(node, "tick_starts", "class"),
        "start_otherwise": text_of(node, "tick_starts", "otherwise"),
        "usb": MappingProxyType({key: child.value for key, child in map_of(node, "usb").items()}),
        "flash": _flashing(node["flash"]) if "flash" in node else None,
    }
    return Family(**values)


def platform_for(platform: Platform, family: Family, peripherals: Collection[str]) -> Platform:
    """A platform ``by_family`` with the parts that ``family`` adds for a chip with these ``peripherals``.

    Where the names of the USB device are data of the family, only chips with a peripheral ``usb`` have this transport.
    """
    missing = ("usb",) if family.usb and "usb" not in peripherals else ()
    own = ("classes", "has_usb_names", "has_console_on_components", "templates", "sdk", "products")
    return replace(
        platform,
        **{name: getattr(family, name) for name in own},
        middlewares=MappingProxyType(
            {name: tuple(t for t in transports if t not in missing) for name, transports in family.middlewares.items()}
        ),
        headers=(*family.headers, *platform.headers),
        needs=(*platform.needs, *family.needs),
        family=family,
    )


def with_added(platform: Platform, added: Sequence[AddedClass]) -> Platform:
    """The platform with those of the ``added`` classes that have C for it."""
    here = tuple(each for each in added if platform.layer in each.ports)
    return replace(platform, classes=(*platform.classes, *(each.name for each in here)), added=here)
