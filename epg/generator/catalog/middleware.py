# SPDX-License-Identifier: Apache-2.0
"""Middlewares as data: ``middlewares/<name>/middleware.yaml`` in the folders of targets."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from epg.generator.catalog.kind import TEMPLATE, KindParameter, make_parameters
from epg.generator.dataclass import dataclass
from epg.generator.documents.items import flag_of, map_of, text_of, texts_of, values_of
from epg.generator.source import Span, YamlNode

STACK = 2048
"""The size of the stack in bytes for middlewares that do not state it."""

POLICIES = ("durability", "deadline", "lifespan")
"""The policies of quality of service that only some middlewares have."""


@dataclass(frozen=True)
class Middleware:
    """A way in which topics travel between a target and the outside.

    ``platforms`` maps platforms on which the middleware runs, although their own files do not name it, to transports.
    ``families`` are the only families of chips that it supports there; all if there are none.
    ``connection`` is "stream" (bytes, carried by a transport of the platform), "own" or "none".  ``agent`` is
    the ROS 2 package of the agent that its targets need, with a program of the same name, or "".  ``programs`` is
    the largest number of programs on one computer that find each other; None: any number.  ``uses`` names the parts
    that the generator must add to a target: "node", "services", "signals", "parameters", "capture", "jog".
    ``quality`` are the policies that it has in addition to reliability and history: "durability", "deadline",
    "lifespan".
    ``namespace_parts`` is the number of parts of a namespace that ``ros2 node`` shows correctly; None: any number.
    ``needs`` are names of tools, in addition to those of the platform.  ``symbol`` is the name of its
    ``epg_middleware_t`` in C, empty if no code runs.  ``headers`` and ``sources`` are files in ``folder``.  ``stack``
    is a size in bytes.  ``builds`` is False if targets with it can be checked but not built.
    """

    name: str
    summary: str
    connection: str
    agent: str
    programs: int | None
    platforms: Mapping[str, tuple[str, ...]]
    families: tuple[str, ...]
    uses: tuple[str, ...]
    quality: tuple[str, ...]
    namespace_parts: int | None
    needs: tuple[str, ...]
    options: tuple[KindParameter, ...]
    symbol: str
    headers: tuple[str, ...]
    sources: tuple[str, ...]
    stack: int
    builds: bool
    node: YamlNode
    folder: Path
    span: Span

    @property
    def is_node(self) -> bool:
        """True if the target becomes a ROS 2 node (epg/node.h), whose topics have messages and quality of service."""
        return "node" in self.uses

    @property
    def has_template(self) -> bool:
        return (self.folder / TEMPLATE).is_file()

    @property
    def files(self) -> tuple[Path, ...]:
        """The files that describe and implement the middleware."""
        found = [name for name in (TEMPLATE, "middleware.cmake") if (self.folder / name).is_file()]
        return tuple(self.folder / name for name in ("middleware.yaml", *found, *self.headers, *self.sources))


def make_middleware(node: YamlNode, folder: Path) -> Middleware:
    """The middleware that a checked ``middleware.yaml`` describes."""
    numbers = {key: int(text_of(node, key)) for key in ("namespace_parts", "programs", "stack") if key in node}
    values = values_of(node, Middleware) | {
        "name": text_of(node, "middleware"),
        "platforms": MappingProxyType({name: texts_of(node, "platforms", name) for name in map_of(node, "platforms")}),
        **{"namespace_parts": None, "programs": None, "stack": STACK, **numbers},
        "options": make_parameters(node.get("options")),
        "symbol": text_of(node, "driver", "symbol"),
        **{key: texts_of(node, "driver", key) for key in ("headers", "sources")},
        "builds": "builds" not in node or flag_of(node, "builds"),
    }
    return Middleware(**values, node=node, folder=folder, span=node["middleware"].span)
