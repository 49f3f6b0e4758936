# SPDX-License-Identifier: Apache-2.0
"""Classes of peripherals that a folder of targets adds: ``classes/<name>/class.yaml``.

Such a class is data for the chips that have it, and C for the port layers of platforms and families.  Neither the files
of the chips nor those of the platforms name it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.items import map_of, text_of, texts_of
from epg.generator.documents.merge import merge
from epg.generator.source import YamlNode


@dataclass(frozen=True)
class AddedClass:
    """A resource class that is not in the files of the chips.

    ``chips`` maps chips to the parts of a ``soc.yaml`` that it adds.  ``ports`` maps platforms, and families of chips
    on platforms that they implement, to C files in ``folder``.
    """

    name: str
    chips: Mapping[str, YamlNode]
    headers: tuple[str, ...]
    ports: Mapping[str, tuple[str, ...]]
    folder: Path

    def sources(self, layer: str) -> tuple[Path, ...]:
        """The C files for the platform or family ``layer``."""
        return tuple(self.folder / name for name in self.ports[layer])

    def files(self, layer: str) -> tuple[Path, ...]:
        """The files that describe the class and implement it for ``layer``."""
        return (self.folder / "class.yaml", *(self.folder / name for name in self.headers), *self.sources(layer))


def make_class(node: YamlNode, folder: Path) -> AddedClass:
    """The class that a checked ``class.yaml`` describes."""
    return AddedClass(
        name=text_of(node, "class"),
        chips=MappingProxyType(map_of(node, "chips")),
        headers=texts_of(node, "headers"),
        ports=MappingProxyType({name: texts_of(node, "ports", name) for name in map_of(node, "ports")}),
        folder=folder,
    )


def check_class(node: YamlNode, diagnostics: Diagnostics) -> None:
    """Reports chips to which a ``class.yaml`` does not add the class itself."""
    name = text_of(node, "class")
    for chip in map_of(node, "chips").values():
        classes = chip["classes"]
        if name not in classes:
            message = f"this chip does not get the class '{name}'"
            diagnostics.error("missing-key", classes.span, message, hint=f"write '{name}: {{title: ...}}' here")


def check_names(node: YamlNode, chips: Collection[str], layers: Collection[str], diagnostics: Diagnostics) -> None:
    """Reports chips of a ``class.yaml`` that do not exist, and port layers that are none of the ``layers``."""
    for key, what, known in (("chips", "chip", chips), ("ports", "port layer", layers)):
        for name in map_of(node, key):
            span, message = node[key].key_span(name), f"there is no {what} '{name}'"
            diagnostics.known_or_error("unknown-name", span, message, name, known, "known")


def with_classes(soc: YamlNode, added: Sequence[AddedClass]) -> YamlNode:
    """The file of a chip with the parts that the ``added`` classes have for it."""
    for each in added:
        part = each.chips.get(text_of(soc, "soc"))
        soc = soc if part is None else merge(soc, part)
    return soc
