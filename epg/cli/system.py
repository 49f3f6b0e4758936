# SPDX-License-Identifier: Apache-2.0
"""For commands that take systems: the file of a system, and their output as a table and as data."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from epg.cli.table import table
from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.quantity import show
from epg.system import SYSTEM_FILES

if TYPE_CHECKING:
    from epg.generator.resolve.application import Plant
    from epg.generator.source import Span
    from epg.system.check_system import CheckedSystem, Link
    from epg.system.system import System, SystemTarget


def is_system(path: Path) -> bool:
    """True if ``path`` has the name of a file that describes a system."""
    return path.name.endswith(SYSTEM_FILES)


def read_system(path: Path, user_roots: Sequence[Path], diagnostics: Diagnostics) -> CheckedSystem | None:
    """The system in ``path``; None if it is another kind of file, or after reporting mistakes."""
    if not is_system(path):
        return None
    from epg.system.check_system import check_system
    from epg.system.load_system import load_system

    system = load_system(path, diagnostics)
    return None if system is None else check_system(system, user_roots, diagnostics)


def system_of(options: argparse.Namespace, diagnostics: Diagnostics) -> tuple[System, Span]:
    """The system that CMake names, and the place of its call.  Stops after reporting mistakes."""
    from epg.generator.documents.cmake_call import caller_span
    from epg.generator.source import Span
    from epg.system.load_system import load_system

    caller = caller_span(options.caller, options.name) if options.caller else Span("command line")
    return diagnostics.checked(load_system(options.system, diagnostics, caller)), caller


def target_of(system: System, name: str, span: Span, diagnostics: Diagnostics) -> SystemTarget:
    """The target ``name`` of a system.  Stops after reporting, at ``span``, that it does not exist."""
    target = system.targets.get(name)
    if target is None:
        message = f"the system '{system.name}' has no target '{name}'"
        hint = did_you_mean(name, system.targets, "targets")
        diagnostics.error("unknown-target", span, message, hint=hint)
    return diagnostics.checked(target)


def system_text(checked: CheckedSystem) -> str:
    """The targets, the connections and the loops of a system."""
    targets = [
        (name, application.target.name, application.communication.middleware.name, show(application.period, "time"))
        for name, application in checked.applications.items()
    ]
    parts = [table(("target", "board and platform", "middleware", "period"), targets)]
    if checked.links:
        header = ("from", "to", "message", "unit", "sent", "oldest value")
        parts.append(table(header, [_row(link) for link in checked.links]))
    parts += [str(loop) for loop in checked.loops]
    if checked.plant is not None:
        parts.append(_plant_text(checked, checked.plant))
    return "\n\n".join([checked.system.name, *parts])


def system_data(checked: CheckedSystem) -> dict[str, Any]:
    """The same as data; times in seconds."""
    return {
        "name": checked.system.name,
        "targets": {
            name: {
                "target": application.target.name,
                "node": f"{application.namespace}/{application.node}",
                "middleware": application.communication.middleware.name,
                "period": float(application.period),
                "serial": checked.system.targets[name].serial,
            }
            for name, application in checked.applications.items()
        },
        "connections": [
            {
                "from": str(link.connection.sender),
                "to": str(link.connection.receiver),
                "topic": checked.system.topic(link.connection.sender),
                "message": link.message,
                "unit": link.unit,
                "on_change": link.on_change,
                "period": float(link.period),
                "age": float(link.age),
            }
            for link in checked.links
        ],
        "loops": [{"targets": list(loop.targets), "age": float(loop.age)} for loop in checked.loops],
        "plant": None if checked.plant is None else _plant(checked.plant),
    }


def _plant(plant: Plant) -> dict[str, Any]:
    """The plant of a system as data: its step in seconds, and for each of its ports the components."""
    ports = {
        kind: [
            {"port": wire.port.name, "component": f"{wire.component.name}.{wire.component_port.name}"} for wire in wires
        ]
        for kind, wires in (("inputs", plant.inputs), ("outputs", plant.outputs))
    }
    return {"model": plant.model.name, "step": float(plant.model.step), **ports}


def _row(link: Link) -> tuple[object, ...]:
    ends = (link.connection.sender, link.connection.receiver)
    return (*ends, link.message, link.unit, link.sent, show(link.age, "time"))


def _plant_text(checked: CheckedSystem, plant: Plant) -> str:
    """The model of the plant, its step, and the targets that are bound to it."""
    names = ", ".join(name for name in checked.system.targets if name in checked.plant_wires)
    return f"plant {plant.model.name}: step {show(plant.model.step, 'time')}, bound to {names}"
