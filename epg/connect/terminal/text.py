# SPDX-License-Identifier: Apache-2.0
"""The ports, wires and candidates of a session's state as text for the terminal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from epg.connect.json_data import State
from epg.generator.dataclass import dataclass

OPEN, UNCONNECTED = "(open)", "(unconnected)"


@dataclass(frozen=True)
class ModelPort:
    """A port of the model."""

    name: str
    direction: str  # "input" or "output"
    unit: str
    type: str
    description: str

    @property
    def title(self) -> str:
        """A text such as ``input position_pan in rad``.  The type is added if it is not real."""
        kind = f" ({self.type})" if self.type != "real" else ""
        return f"{self.direction} {self.name}" + (f" in {self.unit}" if self.unit else "") + kind

    @property
    def arrow(self) -> str:
        return "<-" if self.direction == "input" else "->"


def ports_of(state: State) -> list[ModelPort]:
    """The ports, inputs first; none if the model cannot be read."""
    model = state["model"]
    return [
        ModelPort(port["name"], direction, port["unit"], port["type"], port["description"])
        for direction, key in (("input", "inputs"), ("output", "outputs"))
        for port in (model[key] if model is not None else ())
    ]


def is_open(state: State, port: ModelPort) -> bool:
    return port.name not in state["wires"] and port.name not in state["by_system"]


def wire_text(state: State, port: ModelPort) -> str:
    """The component ports that a port is connected with, and the conversions."""
    if is_open(state, port):
        return OPEN
    if port.name in state["by_system"]:
        return f"topic {state['by_system'][port.name]}, by the system"
    ends = state["wires"][port.name]
    return ", ".join(f"{end['reference']} {end['text']}".rstrip() for end in ends) or UNCONNECTED


def wire_rows(state: State) -> Iterator[tuple[str, str, str, str]]:
    """A row for each port: name, arrow, component, and the component's place on the board."""
    components = {component["name"]: component for component in state["components"]}
    for port in ports_of(state):
        names = [end["reference"].partition(".")[0] for end in state["wires"].get(port.name, ())]
        where = [_where(components[name]) for name in names if name in components]
        yield port.name, port.arrow, wire_text(state, port), "; ".join(text for text in where if text)


def candidate_rows(state: State, port: ModelPort) -> Iterator[tuple[str, str, str]]:
    """A row for each component port that may be connected: number, reference, and a description with its place."""
    found = {
        offered["reference"]: (component, offered)
        for component in state["components"]
        for offered in component["ports"]
    }
    users = users_of(state)
    for number, reference in enumerate(state["candidates"].get(port.name, ()), 1):
        component, offered = found[reference]
        unit = f"in {offered['unit']}" if offered["unit"] else ""
        other = [name for name in users.get(reference, ()) if name != port.name]
        used = f"used by {', '.join(other)}" if other and port.direction == "output" else ""
        parts = (offered["summary"] or component["summary"], unit, component["kind"], _where(component), used)
        yield str(number), reference, "; ".join(part for part in parts if part)


def users_of(state: State) -> dict[str, list[str]]:
    """The model ports that are connected with each component port."""
    users: dict[str, list[str]] = {}
    for name, ends in state["wires"].items():
        for end in ends:
            users.setdefault(end["reference"], []).append(name)
    return users


def _where(component: Mapping[str, Any]) -> str:
    """The place of a component: its pins, or its topic."""
    return ", ".join(component["where"]) or (f"topic {component['topic']}" if component["topic"] else "")
