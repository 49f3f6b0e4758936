# SPDX-License-Identifier: Apache-2.0
"""A target as the page and the terminal show it: plain data, made from the files and the draft only.

The messages have the words, positions and order of ``epg check --json``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from epg.connect.json_data import Data
from epg.connect.loaded import Loaded
from epg.connect.places import Places
from epg.edit.bindings import WireEnd
from epg.generator.catalog.kind import KindPort
from epg.generator.check.configuration import Component
from epg.generator.check.names import absolute_topic
from epg.generator.diagnostics import Diagnostic
from epg.generator.emit.hardware import hardware_rows
from epg.generator.models.model import Model, Port
from epg.generator.quantity import UNITS, normal_unit
from epg.generator.resolve.application import ConversionStep
from epg.generator.resolve.claims import TICK
from epg.generator.resolve.fitting import component_steps, fits
from epg.generator.resolve.matching import Match
from epg.graph.application import conversion
from epg.graph.terminals import wire_texts


def view_of(loaded: Loaded) -> Data:
    """The part of the state that follows from the files and the draft."""
    model = loaded.parts.model
    return {
        "model": model_view(model) if model is not None else None,
        "components": _components(loaded),
        "wires": _wires(loaded),
        "by_system": loaded.by_system,
        "proposals": proposals_of(loaded),
        "candidates": {name: list(match.candidates) for name, match in loaded.matches.items()},
        "fits": {name: _fitting(match, loaded) for name, match in loaded.matches.items()},
        "diagnostics": [diagnostic_view(diagnostic, loaded.places) for diagnostic in loaded.diagnostics],
        "hardware": _hardware(loaded),
        "units": {unit: [dimension, float(factor)] for unit, (dimension, factor) in UNITS.items()},
        "pictures": pictures(loaded),
    }


def proposals_of(loaded: Loaded) -> dict[str, str]:
    """The proposed reference of each port that has no wire."""
    return {name: match.proposal for name, match in loaded.matches.items() if match.proposal is not None}


def pictures(loaded: Loaded) -> dict[str, bool]:
    """The pictures of this target: True for those that can be drawn, False for those that errors prevent.

    A target without pins has no pinout.  The pinout also shows conflicts between pins.
    """
    whole = loaded.parts.application is not None
    shown = {"application": whole, "schedule": whole}
    if loaded.target is not None and loaded.target.board.layout is None:
        return shown
    return {"wiring": loaded.wired is not None, **shown}


def model_view(model: Model) -> Data:
    """A model and its ports.  ``step`` is in seconds."""
    return {
        "name": model.name,
        "origin": model.origin,
        "step": float(model.step),
        "inputs": [_port(port) for port in model.inputs],
        "outputs": [_port(port) for port in model.outputs],
    }


def _port(port: Port) -> Data:
    return {"name": port.name, "unit": port.unit, "type": port.type, "description": port.description}


def _components(loaded: Loaded) -> list[Data]:
    claims: dict[str, dict[str, Any]] = {}
    for (owner, claim), found in loaded.wiring.items():
        claims.setdefault(owner, {})[claim] = found
    return [_component(component, loaded, claims.get(component.name, {})) for component in loaded.components.values()]


def _component(component: Component, loaded: Loaded, claims: dict[str, Any]) -> Data:
    kind = component.kind
    resources = dict.fromkeys(found.resource for found in claims.values())
    topic = component.parameters.get("topic") if kind.communication else None
    configuration, target = loaded.parts.configuration, loaded.target
    return {
        "name": component.name,
        "kind": kind.name,
        "summary": kind.summary,
        "where": wire_texts(kind, claims, target) if target is not None else [],
        "peripheral": ", ".join(name for name in resources if name and not name.startswith("pin ")),
        "topic": absolute_topic(str(topic), configuration.namespace, configuration.node)
        if topic and configuration is not None
        else "",
        "ports": [
            {
                "name": port.name,
                "direction": port.direction,
                "reference": component.kind.reference(component.name, port),
                "unit": component_steps(component, port)[1],
                "type": port.type,
                "summary": port.description,
            }
            for port in kind.ports
        ],
    }


def _wires(loaded: Loaded) -> dict[str, list[Data]]:
    directions = {"inputs": "source", "outputs": "sink"}
    return {
        name: [_wire(end, name, directions[section], loaded) for end in ends] for section, name, ends in loaded.wires
    }


def _wire(end: WireEnd, name: str, direction: str, loaded: Loaded) -> Data:
    """One end of a wire: its conversion in the bindings, and in ``from_tcf`` the conversion of its component.

    The units are those on both sides of the conversion in the bindings; empty if they are not known.
    """
    end_of_wire = _end(end.reference, direction, loaded.components)
    own = _said(end)
    given = ""
    unit = wanted = ""
    if end_of_wire is not None:
        component, port = end_of_wire
        steps, unit = component_steps(component, port)
        given = " ".join(part for part in (_units(steps), conversion(steps)) if part)
        model = loaded.parts.model
        ports = (*model.inputs, *model.outputs) if model is not None else ()
        wanted = next((normal_unit(end.unit or p.unit) for p in ports if p.name == name), "")
        if not end.scale and unit and wanted and unit != wanted:
            between = f"{unit} → {wanted}" if direction == "source" else f"{wanted} → {unit}"
            own = " ".join(part for part in (between, own) if part)
    return {**asdict(end), "text": own, "from_tcf": given, "component_unit": unit, "model_unit": wanted}


def _fitting(match: Match, loaded: Loaded) -> list[str]:
    """The candidates that agree with the port in type and unit, too: first the free ones, the best of them first."""
    direction = "source" if match.port.direction == "input" else "sink"
    ends = {reference: _end(reference, direction, loaded.components) for reference in match.candidates}
    used = (name for name, end in ends.items() if end is not None and fits(match.port, *end))
    return list(dict.fromkeys((*match.fitting, *used)))


def _end(reference: str, direction: str, components: Mapping[str, Component]) -> tuple[Component, KindPort] | None:
    name, _, port_name = reference.partition(".")
    component = components.get(name)
    if component is None:
        return None
    if not port_name:
        main = component.kind.main_port(direction)
        return (component, main) if main is not None else None
    return next(((component, port) for port in component.kind.ports if port.name == port_name), None)


def _said(end: WireEnd) -> str:
    """A conversion as the bindings write it, so that 1/4 stays 1/4: ``×1/4 +1 in 0…2``."""
    parts = [f"×{end.scale}"] if end.scale else []
    parts += [end.offset if end.offset.startswith(("-", "+")) else f"+{end.offset}"] if end.offset else []
    parts += [f"in {end.limits[0]}…{end.limits[1]}"] if end.limits is not None else []
    return " ".join(parts)


def _units(steps: list[ConversionStep]) -> str:
    return " ".join(step.reason.replace("->", "→") for step in steps if " -> " in step.reason)


def diagnostic_view(diagnostic: Diagnostic, places: Places | None = None) -> Data:
    """A message as in the command line's JSON, with the port and the component that it is about.

    ``ports`` are that port and the others that it names: the two outputs that drive one component port.  ``path`` are
    the keys of the value in a ``.tcf`` that it is about.
    """
    port = places.port(diagnostic) if places is not None else None
    others = [places.port_at(note.span) for note in diagnostic.notes] if places is not None else []
    return {
        **diagnostic.data(),
        "port": port,
        "ports": list(dict.fromkeys(name for name in (port, *others) if name is not None)),
        "component": places.component(diagnostic) if places is not None else None,
        "path": places.path(diagnostic) if places is not None else [],
    }


def _hardware(loaded: Loaded) -> list[Data]:
    configuration = loaded.parts.configuration
    rows = []
    for (key, found), (_, resource, pins, frequency, remark) in zip(
        loaded.hardware.items(), hardware_rows(loaded.hardware)
    ):
        owner, claim = key
        if configuration is not None and owner in configuration.components:
            wires = wire_texts(configuration.components[owner].kind, {claim: found}, configuration.target)
            pins = ", ".join(wires) or pins
        rows.append(
            {
                "component": "(control loop)" if key == TICK else owner,
                "claim": claim,
                "resource": resource,
                "pins": pins,
                "frequency": frequency,
                "remark": remark,
            }
        )
    return rows
