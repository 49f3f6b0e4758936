# SPDX-License-Identifier: Apache-2.0
"""Platforms and families of chips as data: ``platforms/`` and ``families/`` below the ``targets`` folders.

A platform is a way of running, a family is whose registers.  A platform either knows the registers itself, for the
families or the board that it names, or leaves them to the families that name it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType

from epg.documents.items import flag_of, map_of, text_of, texts_of
from epg.source import Span, YamlNode


@dataclass(frozen=True)
class Product:
    """A file beside an executable; ``*`` in ``file`` is the executable's name without its ending.

    ``what`` says what a person does with it.
    """

    file: str
    what: str


@dataclass(frozen=True)
class Platform:
    """A way of running: for the chips of ``families``, for one ``board``, or ``by_family``.

    The port layer of a platform ``by_family`` comes from the folders in ``families/``: :func:`platform_for` gives the
    platform with what the chip's ``family`` brings.

    Without ``builds`` there is none yet: targets can be checked but not built.

    ``middlewares`` names transports; the first of each is the default.  With ``has_usb_names`` a target configuration
    says what the target is called as a USB device.  ``tick`` is the class of the peripheral that
    times the control loop, None where the system software does, as also on chips without that class where
    ``tick_is_optional``.  With ``has_nodes`` a component can name a node of a devicetree instead of pins.  ``shared``
    are folders beside this one whose templates it uses too.

    ``sdk`` is the SDK whose name for the board a build is given, "" where there is none, ``headers`` those of
    its headers that are included by name alone; ``built_by`` "cmake" or
    "west"; ``program`` the CMake target of the executable where the SDK makes it; ``needs`` are tools by name,
    ``products`` what a build makes for people, the best first.
    """

    name: str
    summary: str
    families: tuple[str, ...]
    board: str | None  # serves this board only, and its one target is called as the platform is
    simulates_plant: bool
    classes: tuple[str, ...]
    middlewares: Mapping[str, tuple[str, ...]]
    has_usb_names: bool
    tick: str | None
    tick_is_optional: bool
    has_nodes: bool
    builds: bool
    templates: tuple[str, ...]
    shared: tuple[str, ...]
    sdk: str
    headers: tuple[str, ...]
    built_by: str
    program: str
    needs: tuple[str, ...]
    products: tuple[Product, ...]
    by_family: bool
    family: Family | None
    node: YamlNode
    folder: Path
    span: Span

    @property
    def offers(self) -> YamlNode:
        """The file that lists its middlewares."""
        return self.node if self.family is None else self.family.node

    @property
    def template_folder(self) -> str:
        """Where its templates are, below a ``targets`` folder."""
        return f"platforms/{self.name}" if self.family is None else f"families/{self.family.name}"

    @property
    def folders(self) -> tuple[Path, ...]:
        """The folders whose templates its own ones can use, its own first."""
        beside = tuple(self.folder.parent / name for name in self.shared)
        return (self.folder, *beside, *(() if self.family is None else (self.family.folder,)))

    @property
    def project_names(self) -> tuple[str, ...]:
        """What a folder of ``projects/`` for it can be called, the best first."""
        return (self.name, *self.shared, *(() if self.family is None else (self.family.name,)))


@dataclass(frozen=True)
class Family:
    """The port layer of a family of chips, for the ``platforms`` that leave it to families.

    The rest means what it means in a :class:`Platform`.
    """

    name: str
    summary: str
    platforms: tuple[str, ...]
    classes: tuple[str, ...]
    middlewares: Mapping[str, tuple[str, ...]]
    has_usb_names: bool
    templates: tuple[str, ...]
    sdk: str
    headers: tuple[str, ...]
    needs: tuple[str, ...]
    products: tuple[Product, ...]
    node: YamlNode
    folder: Path
    span: Span


def make_platform(node: YamlNode, folder: Path) -> Platform:
    """The platform that a checked ``platform.yaml`` describes."""
    tick = node.get("tick", "class")
    return Platform(
        name=text_of(node, "platform"),
        summary=text_of(node, "summary"),
        families=texts_of(node, "families"),
        board=text_of(node, "board") or None,
        simulates_plant=flag_of(node, "simulates_plant"),
        classes=texts_of(node, "classes"),
        middlewares=_middlewares(node),
        has_usb_names=flag_of(node, "usb_names"),
        tick=str(tick.value) if tick is not None else None,
        tick_is_optional=tick is not None and flag_of(node["tick"], "optional"),
        has_nodes=flag_of(node, "nodes"),
        builds=flag_of(node, "builds"),
        templates=texts_of(node, "templates"),
        shared=texts_of(node, "shared"),
        sdk=text_of(node, "sdk"),
        headers=texts_of(node, "headers"),
        built_by=text_of(node, "built_by") or "cmake",
        program=text_of(node, "program"),
        needs=texts_of(node, "needs"),
        products=_products(node),
        by_family=flag_of(node, "by_family"),
        family=None,
        node=node,
        folder=folder,
        span=node["platform"].span,
    )


def make_family(node: YamlNode, folder: Path) -> Family:
    """The family that a checked ``family.yaml`` describes."""
    return Family(
        name=text_of(node, "family"),
        summary=text_of(node, "summary"),
        platforms=texts_of(node, "platforms"),
        classes=texts_of(node, "classes"),
        middlewares=_middlewares(node),
        has_usb_names=flag_of(node, "usb_names"),
        templates=texts_of(node, "templates"),
        sdk=text_of(node, "sdk"),
        headers=texts_of(node, "headers"),
        needs=texts_of(node, "needs"),
        products=_products(node),
        node=node,
        folder=folder,
        span=node["family"].span,
    )


def platform_for(platform: Platform, family: Family) -> Platform:
    """A platform ``by_family`` with what the family brings."""
    return replace(
        platform,
        classes=family.classes,
        middlewares=family.middlewares,
        has_usb_names=family.has_usb_names,
        templates=family.templates,
        sdk=family.sdk,
        headers=(*family.headers, *platform.headers),
        needs=(*platform.needs, *family.needs),
        products=family.products,
        family=family,
    )


def _middlewares(node: YamlNode) -> Mapping[str, tuple[str, ...]]:
    offered = map_of(node, "middlewares")
    return MappingProxyType({name: tuple(str(t.value) for t in child.elements()) for name, child in offered.items()})


def _products(node: YamlNode) -> tuple[Product, ...]:
    products = node.get("products")
    listed = products.elements() if products is not None else ()
    return tuple(Product(text_of(product, "file"), text_of(product, "what")) for product in listed)
