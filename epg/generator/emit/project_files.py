# SPDX-License-Identifier: Apache-2.0
"""Renders the files of a new project from the templates in ``targets/projects``.

>>> # files = project_files(plan, folder_of_project("rp2", roots), roots)
>>> # sorted(files)  ->  [".gitignore", ".vscode/launch.json", "CMakeLists.txt", ...]
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field
from pathlib import Path
from typing import ClassVar

from epg.generator.catalog.hardware import Computer
from epg.generator.dataclass import dataclass
from epg.generator.emit.template import environment
from epg.generator.emit.text import ProjectText
from epg.generator.install import ACTIVATE, install_command

NAME = "NAME"
"""The placeholder of the project's name in names of files."""
SUFFIX = ".j2"
SYSTEM = "system"
"""The folder of templates for a system."""
_OTHERS = ("common", SYSTEM)
"""The folders of templates that belong to no platform."""


@dataclass(frozen=True)
class StandIn:
    """A component with a topic that takes the place of a port's sensor or actuator until the user replaces it."""

    name: str
    kind: str
    type: str
    """The component's parameter ``type``.  Empty for the default, real numbers."""


@dataclass(frozen=True)
class MovedAxis:
    """An axis that a scenario moves.

    ``setpoint`` is the topic with its setpoint, ``position`` the signal that follows the setpoint, and ``duty`` the
    signal that drives the motor, or empty.  ``unit`` is the unit of the topic and of the position: ``none`` for numbers
    without a unit, empty for the default unit of scenarios.
    """

    name: str
    setpoint: str
    position: str
    duty: str
    unit: str = ""


@dataclass(frozen=True)
class ProjectPlan:
    """The values that the templates of a project can use.

    ``extends`` is the predefined ``.tcf`` that the project extends.  It is empty if the project starts from
    ``stand_ins`` instead.  ``middleware`` and ``transport`` are empty if the project keeps those of ``extends``.

    ``console`` is True if the user can type commands to the firmware, and ``plant`` if the project has a simulated
    robot.  ``agent`` is the agent that makes the firmware a ROS 2 node, or empty.  ``axes`` are the axes that its
    scenario moves.

    ``pins`` are free pins for the components of ``extends`` that have none on this board.
    ``actuators`` and ``carriers`` are components of ``extends``: those that move something, and those that carry the
    bytes of a middleware.

    ``model`` is the path of the model's folder relative to the project.  ``versions`` are the versions of EPG and of
    the tools, by name.
    """

    name: str
    target: Computer
    extends: str
    middleware: str
    transport: str
    console: bool
    agent: str
    model: str
    model_name: str
    stand_ins: Sequence[StandIn]
    subscriptions: Sequence[str]
    actuators: Sequence[str]
    carriers: Sequence[str]
    versions: Mapping[str, str]
    pins: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    plant: bool = False
    axes: Sequence[MovedAxis] = ()

    activate: ClassVar[str] = ACTIVATE
    install: ClassVar[str] = install_command()
    install_with_west: ClassVar[str] = install_command("west <folder of EPG>")


@dataclass(frozen=True)
class SystemPlan:
    """The values that the templates of a project for a system can use.

    ``system`` is the path of the system's file relative to the project, and ``targets`` are the names of its targets.
    ``axes`` are the axes that its scenario moves: those whose ``setpoint`` is one of ``topics``, which the scenario
    sends, and those that follow another target.
    """

    name: str
    system: str
    targets: Sequence[str]
    topics: Sequence[str]
    axes: Sequence[MovedAxis]
    versions: Mapping[str, str]

    activate: ClassVar[str] = ACTIVATE
    install: ClassVar[str] = install_command()


def project_folder(names: Iterable[str], roots: Iterable[Path]) -> Path | None:
    """The folder of templates of the first name in ``names`` that has one, or None.

    Callers give the name of the platform first, then the names of what it shares with other platforms.
    """
    roots = list(roots)
    for name in names:
        for root in roots:
            if (root / "projects" / name).is_dir():
                return root / "projects" / name
    return None


def project_names(roots: Iterable[Path]) -> list[str]:
    """The names for which :func:`project_folder` finds a folder, sorted."""
    folders = (folder for root in roots for folder in (root / "projects").glob("*/"))
    return sorted({folder.name for folder in folders if folder.is_dir() and folder.name not in _OTHERS})


def project_files(plan: ProjectPlan | SystemPlan, folder: Path, roots: Iterable[Path]) -> dict[str, str]:
    """The text of each file of the project that ``folder`` makes, by its path in the project.

    A template can make an empty text; the project then does not have that file.
    """
    env = environment([folder, *(root / "projects" for root in roots)], ProjectText)
    files = {}
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        source = path.relative_to(folder).as_posix()
        name = source.removesuffix(SUFFIX).replace(NAME, plan.name)
        files[name] = env.get_template(source).render(plan=plan) if path.suffix == SUFFIX else path.read_text("utf-8")
    return {name: text for name, text in files.items() if text.strip()}
