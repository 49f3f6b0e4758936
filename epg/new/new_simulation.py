# SPDX-License-Identifier: Apache-2.0
"""The simulation of a new project: the plant of the robot, if EPG has one, and the axes that its scenario moves."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

from epg.generator.check.configuration import Component
from epg.generator.data import data_folder
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.tcf import find_tcf
from epg.generator.documents.yaml_file import load_yaml
from epg.generator.emit.project_files import MovedAxis
from epg.generator.importers import Model
from epg.generator.quantity import dimension_of, normal_unit

PLANT, BINDINGS = "plant", "plant.bindings.yaml"
_SIGNAL_PART = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def robot_folder(extends: str, roots: Sequence[Path]) -> Path | None:
    """The example with a plant for the robot whose predefined ``.tcf`` is ``extends``; None if there is none.

    The example is named as the robot's folder: the plant for ``robots/jiwy/host_jiwy.tcf`` is in
    ``examples/jiwy/plant``.
    """
    file = find_tcf(extends, roots[-1], roots)
    if file is None:
        return None
    try:
        folder = data_folder("examples") / file.parent.name
    except FileNotFoundError:
        return None
    return folder if (folder / PLANT).is_dir() and (folder / BINDINGS).is_file() else None


def plant_files(folder: Path) -> dict[str, bytes]:
    """The plant and its bindings, by their names in a project."""
    files = {
        f"{PLANT}/{path.relative_to(folder / PLANT).as_posix()}": path.read_bytes()
        for path in sorted((folder / PLANT).rglob("*"))
        if path.is_file()
    }
    lines = (folder / BINDINGS).read_text(encoding="utf-8").splitlines(keepends=True)
    # The comment for the YAML language server holds a path that exists in the example only.
    text = "".join(line for line in lines if not line.startswith("# yaml-language-server"))
    return {**files, BINDINGS: text.encode()}


def robot_axes(folder: Path, components: Mapping[str, Component], used: Collection[str]) -> list[MovedAxis]:
    """An axis for each subscriber among ``used`` that moves a plant output.

    The signal that follows is the plant output, and the signal that drives the plant input, whose names share the most
    words with the subscriber's name.
    """
    ports = {
        section: {port: component for port, component in bound.items() if component in components}
        for section, bound in plant_ports(folder / BINDINGS).items()
    }
    axes = []
    for component in components.values():
        topic = component.parameters.get("topic")
        if component.kind.communication != "subscribe" or component.name not in used or len(component.kind.ports) != 1:
            continue
        position = nearest(component.name, ports["outputs"])
        duty = nearest(component.name, ports["inputs"])
        if position:
            duty = f"plant.inputs.{duty}" if duty else ""
            axes.append(MovedAxis(component.name, str(topic), f"plant.outputs.{position}", duty))
    return axes


def plant_ports(bindings: Path) -> dict[str, dict[str, str]]:
    """The ports of a plant with their components, by section: ``{"inputs": {"duty_pan": "pwm_pan"}, "outputs": ...}``.

    Several components of one port are separated by blanks.  ``bindings`` is a file without mistakes.
    """
    root = load_yaml(bindings, Diagnostics())
    assert root is not None, "it was checked"
    found = {}
    for section, key in (("inputs", "from"), ("outputs", "to")):
        bound = root.get(section)
        ends = {port: node.elements() or (node,) for port, node in bound.items()} if bound is not None else {}
        found[section] = {
            port: " ".join(str((node.get(key) or node).value) for node in nodes) for port, nodes in ends.items()
        }
    return found


def model_axes(model: Model, topics: Mapping[str, str]) -> list[MovedAxis]:
    """An axis for each real input to which ``topics`` (port -> topic) gives a topic.

    The signal that follows is the input itself; the signal that drives is the first output of the model.
    """
    outputs = [port.name for port in model.outputs if _SIGNAL_PART.fullmatch(port.name)]
    duty = f"outputs.{outputs[0]}" if outputs else ""
    real = [port for port in model.inputs if port.type == "real" and port.name in topics]
    return [
        MovedAxis(topics[port.name], topics[port.name], f"inputs.{port.name}", duty, _unit(port.unit))
        for port in real
        if _SIGNAL_PART.fullmatch(port.name)
    ]


def _unit(unit: str) -> str:
    """The unit of a port as a scenario writes it; "none" for a unit that EPG does not know."""
    known = dimension_of(unit) is not None and re.fullmatch(r"[A-Za-z][A-Za-z/.]*", normal_unit(unit))
    return normal_unit(unit) if known else "none"


def nearest(name: str, ports: Mapping[str, str]) -> str:
    """The port whose name and component share the most words with ``name``; empty if no port shares one."""
    words = set(name.lower().split("_"))
    shared = {port: len(words & set(f"{port}_{component}".lower().split("_"))) for port, component in ports.items()}
    best = max(shared, key=lambda port: shared[port], default="")
    return best if best and shared[best] > 0 else ""
