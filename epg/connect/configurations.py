# SPDX-License-Identifier: Apache-2.0
"""The target configurations that the user can choose for a model: predefined ``.tcf`` files, and targets alone.

>>> # catalogue = Configurations(roots)
>>> # [entry["name"] for entry in catalogue.entries(model, current)]
"""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

from epg.generator.bootstrap import cache_folder
from epg.generator.catalog.catalog import Catalog, Computer, load_catalog
from epg.generator.check.communication import tools_for
from epg.generator.check.configuration import Configuration
from epg.generator.check.middleware import first_middleware
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.tcf import load_tcf_chain
from epg.generator.emit.project_files import project_folder
from epg.generator.models.model import Model
from epg.generator.project import Request, load_configuration
from epg.generator.resolve.matching import match_ports
from epg.generator.resolve.resolve import allocate_hardware
from epg.generator.tools.find_tool import Surroundings, find_tool
from epg.generator.tools.tools import load_tools
from epg.graph.wiring import draw_wiring


@dataclass(frozen=True)
class PredefinedTarget:
    """A predefined configuration of a robot, or a target alone (a board and a platform).

    ``robot`` is empty for a target alone.  ``configuration`` is None for a target alone and for a configuration with
    an error; ``problem`` is then the message of that error.
    """

    name: str
    robot: str
    target: Computer
    configuration: Configuration | None
    problem: str


class Configurations:
    """All choices.  They are read on first use, which takes about a second."""

    def __init__(self, user_roots: Sequence[Path]) -> None:
        self._user_roots = tuple(user_roots)
        self._roots = Request("connect", "", Path(), Path(), user_roots=self._user_roots).roots
        self._counts: dict[tuple[object, ...], int] = {}
        self._ready = threading.Event()

    @property
    def ready(self) -> bool:
        """True if :meth:`prepare` is done, so that :meth:`entries` returns at once."""
        return self._ready.is_set()

    def prepare(self) -> None:
        """Reads all choices, and looks for the tools of all targets."""
        for choice in self.choices:
            self._missing(choice)
        self._ready.set()

    @cached_property
    def catalog(self) -> Catalog:
        return load_catalog(self._roots, Diagnostics())

    @cached_property
    def choices(self) -> tuple[PredefinedTarget, ...]:
        """Predefined configurations first, then targets, each by name."""
        catalog = self.catalog
        found = [self._predefined(name, catalog) for name in catalog.configuration_names()]
        bare = [
            PredefinedTarget(name, "", target, None, "")
            for name in catalog.target_names()
            if (target := catalog.find_target(name)) is not None
        ]
        return (*(choice for choice in found if choice is not None), *bare)

    def find(self, name: str) -> PredefinedTarget | None:
        return next((choice for choice in self.choices if choice.name == name), None)

    def picture(self, name: str) -> str | None:
        """The picture of the wiring of a choice, as SVG; None if there is nothing to draw."""
        choice = self.find(name)
        if choice is None or not _has_picture(choice):
            return None
        configuration = choice.configuration
        if configuration is None:
            return draw_wiring(choice.target, {}, {}, choice.name)
        hardware = allocate_hardware(configuration, configuration.control.period, Diagnostics())
        return draw_wiring(choice.target, configuration.components, hardware or {}, choice.name)

    def entries(self, model: Model | None, project: Project | None) -> list[dict[str, Any]]:
        """All choices as plain data: for ``project``, or for a new project if that is None.

        ``possible`` is False for a choice that cannot be taken; ``reason`` then says why.
        """
        entries = []
        for choice in self.choices:
            reason = _new_reason(choice, self._roots) if project is None else project.reason(choice)
            components = choice.configuration.components if choice.configuration is not None else {}
            ports = (*model.inputs, *model.outputs) if model is not None else ()
            if not choice.robot:  # a target alone: each port that a topic can carry becomes a topic
                matches = sum(port.direction == "output" or port.type == "real" for port in ports)
            else:
                matches = self._count(choice, model)
            entries.append(
                {
                    "name": choice.name,
                    "summary": _summary(choice),
                    "robot": choice.robot,
                    "board": choice.target.board.summary,
                    "platform": choice.target.platform.summary,
                    "target": choice.target.name,
                    "chosen": project is not None and choice.name == project.chosen,
                    "possible": not reason,
                    "reason": reason,
                    "missing": self._missing(choice),
                    "components": len(components),
                    "matches": matches,
                    "ports": len(ports),
                    "picture": _has_picture(choice),
                }
            )
        return entries

    def _count(self, choice: PredefinedTarget, model: Model | None) -> int:
        """The number of model ports that match a component by name.  The result is kept for models with equal ports."""
        if model is None or choice.configuration is None:
            return 0
        key = (choice.name, tuple((port.name, port.direction) for port in (*model.inputs, *model.outputs)))
        if key not in self._counts:
            found = match_ports(model, choice.configuration.components)
            self._counts[key] = sum(match.proposal is not None for match in found.values())
        return self._counts[key]

    def _predefined(self, file: str, catalog: Catalog) -> PredefinedTarget | None:
        """The choice that a ``.tcf`` file of EPG or of the user defines.

        None for a ``.tcf`` that names no target: other files extend it.
        """
        request = Request("connect", file, Path(), Path(), user_roots=self._user_roots, beside=self._roots[-1])
        chain = load_tcf_chain(file, self._roots, Diagnostics(), beside=request.beside)
        named = next((node for part in chain if (node := part.node.get("target")) is not None), None)
        target = catalog.find_target(str(named.value)) if named is not None else None
        if target is None:
            return None
        problems = Diagnostics()
        configuration = load_configuration(request, catalog, problems, pins_required=False)
        problem = next((item.message for item in problems if item.severity == "error"), "")
        return PredefinedTarget(file.removesuffix(".tcf"), chain[0].path.parent.name, target, configuration, problem)

    @cached_property
    def _lacking(self) -> Mapping[str, str]:
        """The titles of the tools that are missing on this computer, by name."""
        where = Surroundings.here(cache_folder())
        tools = load_tools(self._roots, Diagnostics())
        return {name: tool.title for name, tool in tools.items() if find_tool(tool, where).status != "found"}

    def _missing(self, choice: PredefinedTarget) -> list[str]:
        """The titles of the tools that are missing for a build of ``choice``, those of its middleware among them."""
        if choice.configuration is not None:
            needed = tools_for(choice.target, choice.configuration.communication)
        else:
            middleware = self.catalog.find_middleware(first_middleware(choice.target, self.catalog))
            needed = {*choice.target.needs, *(middleware.needs if middleware is not None else ())}
        return [self._lacking[name] for name in sorted(needed) if name in self._lacking]


@dataclass(frozen=True)
class Project:
    """The project for which a configuration is chosen.

    ``chosen`` is the configuration that its ``.tcf`` extends now, or with ``own_target`` the target that it names.
    ``fixed`` says why that cannot be changed; it is empty if it can.
    """

    chosen: str
    fixed: str
    target: Computer | None
    own_target: bool = False

    def reason(self, choice: PredefinedTarget) -> str:
        """The reason why ``choice`` cannot be taken; empty if it can."""
        if choice.name == self.chosen:
            return ""
        if self.fixed or choice.problem:
            return self.fixed or choice.problem
        if self.own_target and choice.robot:
            return f"this project has components of its own: 'extends: {choice.name}.tcf' would add those of a robot"
        if not self.own_target and not choice.robot:
            return "this project has the components of a robot: choose one of its configurations"
        if not choice.target.platform.builds:
            return _not_built(choice.target)
        return ""


def _not_built(target: Computer) -> str:
    return f"EPG can check files for {target.platform.name}, but cannot generate code for it"


def _new_reason(choice: PredefinedTarget, roots: Sequence[Path]) -> str:
    """The reason why a new project cannot be started with ``choice``; empty if it can."""
    if choice.problem:
        return choice.problem
    platform = choice.target.platform
    if not platform.builds:
        return _not_built(choice.target)
    if project_folder(platform.project_names, roots) is None:
        return f"EPG has no template of a project for {platform.name}: docs/cmake.md shows the files to write"
    return ""


def _summary(choice: PredefinedTarget) -> str:
    board = choice.target.board.summary
    return f"{choice.robot} on {board}" if choice.robot else f"{board}, every port a topic"


def _has_picture(choice: PredefinedTarget) -> bool:
    return choice.target.board.layout is not None and not choice.problem
