# SPDX-License-Identifier: Apache-2.0
"""The catalog: the chips, boards, platforms, families, middlewares and component kinds in the folders of targets.

An item is read and checked when it is used for the first time.  A run needs one target and the kinds of its components:
to read all folders would take longer, and a mistake in a kind that the target does not use would stop it.

>>> # catalog = load_catalog(targets_roots(), diagnostics)
>>> # catalog.target("rpi_pico2_freertos", span, diagnostics).soc.name
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

from epg.generator.catalog.added_class import AddedClass, check_names, make_class, with_classes
from epg.generator.catalog.check_file import check_file
from epg.generator.catalog.check_hardware import check_target
from epg.generator.catalog.check_middleware import check_offers
from epg.generator.catalog.clocks import with_frequencies
from epg.generator.catalog.hardware import Board, Computer, Soc, make_board, make_soc
from epg.generator.catalog.kind import Kind, KindPort, make_kind
from epg.generator.catalog.middleware import Middleware, make_middleware
from epg.generator.catalog.platform import Family, Platform, make_family, make_platform, platform_for, with_added
from epg.generator.catalog.shared_parameters import with_shared_parameters
from epg.generator.correction import and_then, correction
from epg.generator.diagnostics import Diagnostics, did_you_mean, question
from epg.generator.documents.items import texts_of
from epg.generator.documents.merge import merge, without_nulls
from epg.generator.documents.tcf import predefined_tcf_names
from epg.generator.documents.yaml_file import load_yaml
from epg.generator.source import Span, YamlNode

__all__ = ["Catalog", "Computer", "Kind", "KindPort", "load_catalog"]

FOLDERS = {
    "soc": "socs",
    "board": "boards",
    "platform": "platforms",
    "family": "families",
    "middleware": "middlewares",
    "component": "components",
    "class": "classes",
}
"""The folder of each category of items.  An item is a folder with one YAML file, such as ``boards/x/board.yaml``."""


Item = TypeVar("Item", Soc, Board, Platform, Family, Middleware, Kind, AddedClass)


class Catalog:
    """All items in the folders of targets ``roots``.  If two folders have the same item, the first one is used."""

    def __init__(self, roots: Sequence[Path], diagnostics: Diagnostics) -> None:
        self.roots = tuple(roots)
        self._diagnostics = diagnostics
        self._files: dict[str, dict[str, list[Path]]] = {}
        self._items: dict[tuple[str, str], Soc | Board | Platform | Family | Middleware | Kind | AddedClass | None] = {}
        self.files: set[Path] = set()  #: the YAML files that were read

    def names(self, category: str) -> list[str]:
        """The names of all items of a category, which is a key of :data:`FOLDERS`."""
        return sorted(self._paths(category))

    def kind_names(self) -> list[str]:
        return self.names("component")

    def target_names(self) -> list[str]:
        """The names of all targets: each platform with each board whose chip the platform supports."""
        found = set()
        for platform_name in self.names("platform"):
            platform = self._item("platform", platform_name, make_platform)
            if platform is None or platform.for_systems:
                continue
            if platform.board is not None:
                found.add(platform_name)
                continue
            for board_name in self.names("board"):
                board = self._item("board", board_name, make_board)
                soc = self._item("soc", board.soc, make_soc) if board else None
                if soc and self._on(platform, soc) is not None:
                    found.add(f"{board_name}_{platform_name}")
        return sorted(found)

    def configuration_names(self) -> list[str]:
        """The names of the predefined ``.tcf`` files: those in folders of robots, and the composed ones.

        A robot is composed with each target that has pins or simulates it.  The others need settings of the user.
        """
        targets = [target for name in self.target_names() if (target := self.find_target(name)) is not None]
        complete = [target.name for target in targets if target.has_pins or target.platform.simulates_plant]
        return predefined_tcf_names(complete, self.roots)

    def find_kind(self, name: str) -> Kind | None:
        """The kind ``name``, or None if it does not exist or has mistakes."""
        return self._item("component", name, make_kind)

    def find_target(self, name: str) -> Computer | None:
        """The target ``name``, or None if it does not exist or has mistakes."""
        return self._target(name)[0]

    def find_family(self, name: str) -> Family | None:
        """The family of chips ``name``, or None if there is no folder with a port layer for it."""
        return self._item("family", name, make_family)

    def find_middleware(self, name: str) -> Middleware | None:
        """The middleware ``name``, or None if it does not exist or has mistakes."""
        return self._item("middleware", name, make_middleware)

    def usb_vendors(self) -> set[str]:
        """The USB vendors of boards with EPG and of their debug probes, without those that only a ``.tcf`` sets."""
        platforms = [self._item("platform", name, make_platform) for name in self.names("platform")]
        families = [self.find_family(name) for name in self.names("family")]
        boards = [id[:4] for family in families if family and family.flash for id in family.flash.usb]
        return {*boards, *(vendor for platform in platforms if platform for vendor in platform.usb_vendors)}

    def kind(self, name: str, span: Span, diagnostics: Diagnostics) -> Kind | None:
        """The kind ``name``, or None after reporting mistakes in its file, or at ``span`` that it does not exist."""
        if name not in self._paths("component"):
            diagnostics.error("unknown-kind", span, f"there is no kind '{name}'", hint=self._kind_hint(name))
        return self.find_kind(name)

    def _kind_hint(self, name: str) -> str:
        """The hint for a kind that does not exist: the kinds that users also call by this name, or a similar one."""
        word = name.casefold().replace("-", "_")
        kinds = [kind for each in self.kind_names() if (kind := self.find_kind(each)) is not None]
        meant = [kind.name for kind in kinds if word in texts_of(kind.node, "also")]
        if not meant:
            return not_found_hint(name, self.kind_names(), "kinds")
        either = " or ".join(f"'{each}'" for each in meant)
        hint = correction(name, meant[0], "write '{}'") if len(meant) == 1 else f"write {either}"
        return and_then(hint, _ALSO_SEARCHED)

    def target(self, name: str, span: Span, diagnostics: Diagnostics) -> Computer | None:
        """The target ``name``, or None after reporting mistakes in its files, or at ``span`` that it does not exist."""
        target, exists = self._target(name)
        if not exists:
            hint = target_hint(name, self)
            diagnostics.error("unknown-target", span, f"there is no target '{name}'", hint=hint)
        return target

    def _target(self, name: str) -> tuple[Computer | None, bool]:
        """The target, and True if a target of that name exists.

        The target is None if it does not exist, or after reporting mistakes in its files.
        """
        for board_name, platform_name in self._splits(name):
            platform = self._item("platform", platform_name, make_platform)
            if platform is None:
                return None, True
            if (platform.board is not None) != (name == platform_name):
                continue
            board = self._item("board", platform.board or board_name, make_board)
            soc = self._item("soc", board.soc, make_soc) if board else None
            if board is None or soc is None:
                self._report_missing(platform, board)
                return None, True
            on_chip = self._on(platform, soc)
            if on_chip is None:
                if platform.by_family and soc.family in self._paths("family") and self.find_family(soc.family) is None:
                    return None, True
                continue
            target = Computer(name, board, soc, with_added(on_chip, self._added()))
            if not self._check_target(target):
                return None, True
            return replace(target, clocks=with_frequencies(soc.clocks, target.board_clocks)), True
        return None, False

    def _check_target(self, target: Computer) -> bool:
        """True if board, chip, platform and middlewares fit together.  Reports the mistakes otherwise."""
        mistakes = Diagnostics()
        check_offers(target, self.names("middleware"), mistakes)
        check_target(target, mistakes)
        return self._report(mistakes)

    def _report(self, mistakes: Diagnostics) -> bool:
        """Reports the mistakes of one item or target; True if there are no errors.

        Items that extend the same file have the same mistakes, which are reported once, and none of them is right.
        """
        self._diagnostics.add_all(mistakes)
        return not mistakes.has_errors

    def _on(self, platform: Platform, soc: Soc) -> Platform | None:
        """The platform with the parts that the family of a chip adds, or None if it does not support the family."""
        if not platform.by_family:
            return platform if platform.board is not None or soc.family in platform.families else None
        family = self.find_family(soc.family)
        if family is None or platform.name not in family.platforms:
            return None
        return platform_for(platform, family, soc.peripherals)

    def _added(self) -> list[AddedClass]:
        """The classes of peripherals that folders of targets add; without those that have mistakes."""
        found = [self._item("class", name, make_class) for name in self.names("class")]
        return [each for each in found if each is not None]

    def _splits(self, name: str) -> list[tuple[str, str]]:
        """The pairs of board and platform whose names together are ``name``; ("", platform) for a platform alone."""
        platforms, boards = self._paths("platform"), self._paths("board")
        ends = [platform for platform in platforms if name.endswith(f"_{platform}")]
        pairs = [(name.removesuffix(f"_{platform}"), platform) for platform in ends]
        alone = [("", name)] if name in platforms else []
        return alone + sorted(pair for pair in pairs if pair[0] in boards)

    def _report_missing(self, platform: Platform, board: Board | None) -> None:
        """Reports a platform whose board, or a board whose chip, has no folder."""
        category, node = ("soc", board.node["soc"]) if board else ("board", platform.node.get("board"))
        if node is not None and str(node.value) not in self._paths(category):
            self._report_unknown(category, node)

    def _report_unknown(self, category: str, name: YamlNode) -> None:
        hint = not_found_hint(str(name.value), self.names(category), f"in {FOLDERS[category]}/")
        self._diagnostics.error(f"unknown-{category}", name.span, f"there is no {category} '{name.value}'", hint=hint)

    def _paths(self, category: str) -> dict[str, list[Path]]:
        """The files of all items of a category, by name; several files if several roots have the same item."""
        if category not in self._files:
            files: dict[str, list[Path]] = {}
            for root in self.roots:
                for path in sorted((root / FOLDERS[category]).glob(f"*/{category}.yaml")):
                    files.setdefault(path.parent.name, []).append(path)
            self._files[category] = files
        return self._files[category]

    def _item(self, category: str, name: str, make: Callable[[YamlNode, Path], Item]) -> Item | None:
        if (category, name) not in self._items:
            self._items[category, name] = self._load(category, name, make)
        return self._items[category, name]  # type: ignore[return-value]

    def _load(self, category: str, name: str, make: Callable[[YamlNode, Path], Item]) -> Item | None:
        """Reads and checks the file of an item; None if it does not exist, or after reporting mistakes."""
        paths = self._paths(category).get(name, [])
        if not paths:
            return None
        self.files.add(paths[0])
        node = load_yaml(paths[0], self._diagnostics)
        if node is not None and category == "component":
            node = with_shared_parameters(node, self.roots, self._diagnostics)
        elif node is not None and category in ("board", "soc"):
            node = self._with_extended(category, node)
        mistakes = Diagnostics()
        if node is not None:
            self._check(category, node, name, mistakes)
        if not self._report(mistakes) or node is None:
            return None
        if len(paths) > 1:
            message = f"{category} '{name}' is in {len(paths)} folders of targets: EPG uses this one"
            hint = "rename its folder to use both"
            self._diagnostics.warning("shadowed-item", node[_NAME_KEYS[category]].span, message, hint=hint)
        return make(node, paths[0].parent)

    def _check(self, category: str, node: YamlNode, name: str, mistakes: Diagnostics) -> None:
        """Reports the mistakes in the file of the item ``name``."""
        right = check_file(category, node, name, self.names("platform"), mistakes)
        if right and category == "class":
            check_names(node, self.names("soc"), [*self._own_layers(), *self.names("family")], mistakes)

    def _own_layers(self) -> list[str]:
        """The platforms whose port layer is not that of a family of chips."""
        platforms = {name: self._item("platform", name, make_platform) for name in self.names("platform")}
        return [name for name, platform in platforms.items() if platform is None or not platform.by_family]

    def _with_extended(self, category: str, node: YamlNode) -> YamlNode | None:
        """The file of an item with the values of the items that it extends; None after reporting mistakes."""
        added = self._added() if category == "soc" else []
        merged = node = with_classes(node, added)
        read: list[str] = []
        while (extends := node.get("extends")) is not None:
            name = str(extends.value)
            paths = self._paths(category).get(name, [])
            if name in read:
                message = f"'{name}' extends itself"
                self._diagnostics.error("extends-loop", extends.span, message, hint="remove this 'extends'")
                return None
            if not paths:
                self._report_unknown(category, extends)
                return None
            self.files.add(paths[0])
            extended = load_yaml(paths[0], self._diagnostics)
            if extended is None:
                return None
            node = with_classes(extended, added)
            merged = merge(node, merged)
            read.append(name)
        return without_nulls(merged)


_NAME_KEYS = {category: "kind" if category == "component" else category for category in FOLDERS}


_ALSO_SEARCHED = ". EPG also searches the folders in EPG_TARGETS_PATH"


def not_found_hint(name: str, known: Sequence[str], otherwise: str) -> str:
    """The hint for a name that is in none of the folders of targets.

    The item may be in a folder of the user that EPG does not search yet.
    """
    meant = did_you_mean(name, known, otherwise)
    return and_then(meant, _ALSO_SEARCHED.removeprefix("." if meant.endswith("?") else ""))


def target_hint(name: str, catalog: Catalog, files: Iterable[str] = ()) -> str:
    """The hint for a target that does not exist.  Its board may be one that the user must describe first.

    ``files`` are names of predefined configurations that the user can name instead of a target.  A name that begins
    with a board means a target with this board, or a configuration of it.
    """
    targets = catalog.target_names()
    known = [*targets, *files]
    wanted = name.casefold().replace("-", "_").replace(" ", "_")
    boards = catalog.names("board")
    board = _begins_with(wanted, boards)
    with_board = [target for target in targets if board and _begins_with(target, boards) == board]
    if wanted == board and with_board:
        return f"'{name}' is a board: name a target with it: {', '.join(with_board)}"
    if wanted in catalog.names("platform"):
        return f"'{name}' is a platform: name a target with it: {', '.join(t for t in targets if t.endswith(wanted))}"
    if wanted in known:
        return question([wanted], name)
    otherwise = "targets and .tcf files" if files else "targets"
    if with_board:
        name, known = wanted, [target for target in known if _begins_with(target, boards) == board]
    hint = not_found_hint(name, known, otherwise)
    return and_then(hint, "; docs/adding-a-board.md explains how to add a board")


def _begins_with(name: str, boards: Iterable[str]) -> str:
    """The longest of the ``boards`` with which the name of a target begins; "" if there is none."""
    return max((board for board in boards if f"{name}_".startswith(f"{board}_")), key=len, default="")


def load_catalog(roots: Sequence[Path], diagnostics: Diagnostics) -> Catalog:
    """The catalog of ``roots``, the user's folders first.

    An item is read when it is used for the first time, and its mistakes are reported to ``diagnostics`` then.  A
    missing folder is reported at once.
    """
    for root in roots:
        if not root.is_dir():
            hint = "correct EPG_TARGETS_PATH"
            diagnostics.error("targets-not-found", Span(str(root)), f"there is no folder '{root.name}'", hint=hint)
        elif not any((root / folder).is_dir() for folder in (*FOLDERS.values(), "robots")):
            message = f"'{root.name}' does not have the structure of a folder of targets"
            hint = f"it must contain folders such as {', '.join([*FOLDERS.values(), 'robots'])}"
            diagnostics.warning("targets-empty", Span(str(root)), message, hint=hint)
    return Catalog(roots, diagnostics)
