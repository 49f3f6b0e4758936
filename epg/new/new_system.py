# SPDX-License-Identifier: Apache-2.0
"""``epg new --system``: makes a project around the file of a system: simulation, scenario and images of all targets.

>>> # project = write_system_project(checked, Path("robots"), diagnostics)
>>> # project.files["scenario.yaml"]
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path

import epg
from epg.generator.data import data_folder
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.emit.folder import write_folder
from epg.generator.emit.project_files import SYSTEM, MovedAxis, SystemPlan, project_files, project_folder
from epg.generator.quantity import base_unit, dimension_of
from epg.new.new_project import IMPORT, refuse_present
from epg.new.new_simulation import nearest, plant_ports
from epg.system.check_system import CheckedSystem
from epg.system.system import End, System, SystemTarget


@dataclass(frozen=True)
class SystemProject:
    """A project for a system; ``files`` maps names below the project's folder to contents."""

    plan: SystemPlan
    files: Mapping[str, bytes]


def write_system_project(checked: CheckedSystem, folder: Path, diagnostics: Diagnostics) -> SystemProject:
    """Writes a new project for a system: either all of its files or none.  Existing files are never replaced.

    Raises :class:`~epg.generator.diagnostics.UserError`; then nothing was written.
    """
    system, roots = checked.system, checked.loader.roots
    axes = _axes(checked)
    sent = {_setpoint(end) for end in system.world}
    plan = SystemPlan(
        name=system.name,
        system=Path(os.path.relpath(system.path, folder)).as_posix(),
        targets=tuple(system.targets),
        topics=list(dict.fromkeys(axis.setpoint for axis in axes if axis.setpoint in sent)),
        axes=axes,
        versions={"epg": epg.__version__},
    )
    templates = project_folder((SYSTEM,), roots)
    assert templates is not None, "EPG's own folder"
    texts = project_files(plan, templates, roots)
    texts[IMPORT] = (data_folder("cmake") / IMPORT).read_text(encoding="utf-8")
    files = {name: text.encode() for name, text in sorted(texts.items())}
    refuse_present(folder, files, diagnostics)
    write_folder(folder, files)
    return SystemProject(plan, files)


def _setpoint(end: End) -> str:
    """The name in scenarios of a topic of the world."""
    return end.topic or str(end)


def _axes(checked: CheckedSystem) -> list[MovedAxis]:
    """The axes of the plants: those whose setpoint comes from other programs, and those that follow another axis."""
    system = checked.system
    ports = {name: _ports(system, target) for name, target in system.targets.items()}

    def signal(end: End, section: str) -> str:
        """The plant's port whose name is the most like that of the topic component; empty if there is none."""
        found = nearest(end.component, ports[end.target][section])
        return f"{end.target}/plant.{section}.{found}" if found else ""

    pairs: Iterable[tuple[str, End]] = [
        *((_setpoint(end), end) for end in system.world),
        *((signal(connection.sender, "outputs"), connection.receiver) for connection in system.connections),
    ]
    axes = {}
    for setpoint, end in pairs:
        position = signal(end, "outputs")
        if setpoint and position:
            name = str(end).replace("/", "_").replace(".", "_")
            axes[name] = MovedAxis(name, setpoint, position, signal(end, "inputs"), _unit(checked, end))
    return list(axes.values())


def _ports(system: System, target: SystemTarget) -> dict[str, dict[str, str]]:
    """The ports of the target's plant, or those of the system's plant that are bound to the target."""
    if target.plant_bindings is not None:
        return plant_ports(target.plant_bindings)
    whole = {"inputs": {}, "outputs": {}} if system.plant is None else plant_ports(system.plant.bindings)
    return {
        section: {port: bound for port, bound in ports.items() if f" {target.name}/" in f" {bound}"}
        for section, ports in whole.items()
    }


def _unit(checked: CheckedSystem, end: End) -> str:
    """The unit of an axis as a scenario writes it: empty for rad, its default, and ``none`` for numbers without one.

    It is the base unit of the topic's unit, which is that of a plant's ports.
    """
    inputs = checked.applications[end.target].inputs
    unit = next((wire.unit for wire in inputs if wire.component.name == end.component), "")
    dimension = dimension_of(unit) if unit else None
    if dimension is None:
        return "none"
    unit = base_unit(dimension)
    return "" if unit == "rad" else unit
