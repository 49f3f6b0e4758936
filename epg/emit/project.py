# SPDX-License-Identifier: Apache-2.0
"""A new project as text: the templates of ``targets/projects``, filled in.

>>> # files = project_files(plan, folder_of_project("rp2", roots), roots)
>>> # sorted(files)  ->  [".gitignore", ".vscode/launch.json", "CMakeLists.txt", ...]
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from epg.catalog.hardware import Target
from epg.emit.template import environment
from epg.emit.text import ProjectText
from epg.install import ACTIVATE, install_command

NAME = "NAME"
"""What stands in names of files for the name of the project."""
SUFFIX = ".j2"


@dataclass(frozen=True)
class StandIn:
    """A component, and topic, that stands for a port of the model until the user puts another in its place."""

    name: str
    kind: str
    type: str
    """What the component states as ``type``; empty for its default, real numbers."""


@dataclass(frozen=True)
class Axis:
    """What a scenario moves: the topic that is set, the signal that should follow, the one that drives (or empty).

    ``unit`` is that of the topic and the signal, ``none`` for plain numbers, empty for a scenario's default.
    """

    name: str
    setpoint: str
    position: str
    duty: str
    unit: str = ""


@dataclass(frozen=True)
class ProjectPlan:
    """What templates know of a project.

    ``extends`` is the predefined ``.tcf`` it builds on, empty for one that begins with ``stand_ins``.  ``middleware``
    and ``transport`` are empty where those of ``extends`` stay; ``console``: a person can type to the firmware;
    ``node``: it is a node of ROS 2.
    ``plant``: a simulated robot is among the project's files; ``axes``: what its scenario moves.
    ``model`` is the model's place relative to the project, ``versions`` those of EPG and of the tools, by name.
    """

    name: str
    target: Target
    extends: str
    middleware: str
    transport: str
    console: bool
    node: bool
    model: str
    model_name: str
    stand_ins: Sequence[StandIn]
    subscriptions: Sequence[str]
    actuators: Sequence[str]
    versions: Mapping[str, str]
    plant: bool = False
    axes: Sequence[Axis] = ()

    activate: ClassVar[str] = ACTIVATE
    install: ClassVar[str] = install_command()
    install_with_west: ClassVar[str] = install_command("west <folder of EPG>")


def project_folder(names: Iterable[str], roots: Iterable[Path]) -> Path | None:
    """The templates for the first of ``names`` that has some: a platform's own, or of what it shares."""
    roots = list(roots)
    for name in names:
        for root in roots:
            if (root / "projects" / name).is_dir():
                return root / "projects" / name
    return None


def project_names(roots: Iterable[Path]) -> list[str]:
    """Names that :func:`project_folder` knows."""
    folders = (folder for root in roots for folder in (root / "projects").glob("*/"))
    return sorted({folder.name for folder in folders if folder.is_dir() and folder.name != "common"})


def project_files(plan: ProjectPlan, folder: Path, roots: Iterable[Path]) -> dict[str, str]:
    """The text of every file that ``folder`` has templates for, by its name in the project."""
    env = environment([folder, *(root / "projects" for root in roots)], ProjectText)
    files = {}
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        source = path.relative_to(folder).as_posix()
        name = source.removesuffix(SUFFIX).replace(NAME, plan.name)
        files[name] = env.get_template(source).render(plan=plan) if path.suffix == SUFFIX else path.read_text("utf-8")
    return {name: text for name, text in files.items() if text.strip()}
