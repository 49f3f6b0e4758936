# SPDX-License-Identifier: Apache-2.0
"""Arranges the signals of a recording in panels: a setpoint and the values that follow it share one.

A setpoint is known as such, or its name has a word such as "setpoint".  A value follows it if both have the same unit,
and a word in common that not all setpoints have: ``setpoint_pan``, ``position_pan``.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any

from epg.dataclass import dataclass

_SETPOINT = {"setpoint", "setpoints", "reference", "desired", "target", "command", "subscriber", "sp"}
_PLACES = {"inputs", "outputs", "plant", "publisher", "logging"}
_OTHER = {"duty", "pwm", "steer", "current", "voltage", "torque", "effort", "reset", "level", "error", "enabled"}
_RATES = {"velocity", "speed", "omega", "rate"}


@dataclass(frozen=True)
class Panel:
    """Signals that are drawn together, with the setpoints first.  ``unit`` can be empty."""

    setpoints: tuple[str, ...]
    values: tuple[str, ...]
    unit: str

    @property
    def names(self) -> tuple[str, ...]:
        return self.setpoints + self.values

    @property
    def title(self) -> str:
        """The words that all its signals have, such as "pan"; "value" if there are none."""
        common = frozenset.intersection(*(_words(name) for name in self.names)) - _PLACES
        return " ".join(word for word in _in_order(self.names[0]) if word in common) or "value"


def panels_of(names: Iterable[str], known_setpoints: Collection[str], units: Mapping[str, str]) -> list[Panel]:
    """The panels, in the order of the signals.

    >>> panels_of(["inputs.position_pan", "inputs.setpoint_pan", "outputs.pwm_pan", "spare"], (), {})
    [Panel(setpoints=('inputs.setpoint_pan',), values=('inputs.position_pan',), unit=''), \
Panel(setpoints=(), values=('outputs.pwm_pan',), unit=''), Panel(setpoints=(), values=('spare',), unit='')]
    """
    names = list(names)
    words = {name: _words(name) for name in names}
    setpoints = [name for name in names if name in known_setpoints or words[name] & _SETPOINT]
    common = frozenset.intersection(*(words[name] for name in setpoints)) if len(setpoints) > 1 else frozenset()
    axes = {name: words[name] - _SETPOINT - _PLACES - _RATES - common for name in setpoints}
    groups: dict[str, list[str]] = {}  # those of one axis have one head: the first setpoint of the axis
    heads: list[str] = []
    for name in setpoints:
        head = next((h for h in heads if axes[h] == axes[name] and _alike(h, name, words, units)), name)
        heads += [head] if head == name else []
        groups.setdefault(head, []).append(name)
    for name in names:
        if name in setpoints:
            continue
        found = [head for head in heads if axes[head] & words[name] and _alike(head, name, words, units)]
        if not found and len(heads) == 1 and not axes[heads[0]] and _alike(heads[0], name, words, units):
            found = heads
        groups.setdefault(max(found, key=lambda head: len(axes[head] & words[name])) if found else name, []).append(
            name
        )
    result = []
    for name in names:
        head = next(head for head, members in groups.items() if name in members)
        members = groups[head]
        if name == next(member for member in names if member in members):
            chosen = tuple(member for member in members if member in setpoints)
            rest = tuple(member for member in members if member not in setpoints)
            result.append(Panel(chosen, rest, next((units[m] for m in members if units.get(m)), "")))
    return result


def _alike(one: str, other: str, words: Mapping[str, frozenset[str]], units: Mapping[str, str]) -> bool:
    """True if both signals can be of the same quantity."""
    if one in units and other in units and units[one] != units[other]:
        return False
    kinds = [(bool(words[name] & _RATES), words[name] & _OTHER) for name in (one, other)]
    return kinds[0] == kinds[1]


def _words(name: str) -> frozenset[str]:
    return frozenset(_in_order(name))


def _in_order(name: str) -> list[str]:
    return [word.lower() for word in re.findall(r"[A-Z]?[a-z]+|[A-Z]+|\d+", name)]


def units_of(description: Mapping[str, Any]) -> dict[str, str]:
    """The units of the signals and topics of a target, from its description ``<name>.json``."""
    units: dict[str, str] = {}
    for section in ("inputs", "outputs"):
        for wire in description.get(section, []):
            units[f"{section}.{wire['port']}"] = wire["unit"] or wire["component_unit"]
        for wire in (description.get("plant") or {}).get(section, []):
            units[f"plant.{section}.{wire['port']}"] = wire["unit"] or wire["component_unit"]
    ends = {
        (wire["component"], wire["component_port"]): wire["component_unit"] or wire["unit"]
        for section in ("inputs", "outputs")
        for wire in description.get(section, [])
    }
    for topic in [*description.get("subscriptions", []), *description.get("publications", [])]:
        for value, element in zip(topic["values"], topic["elements"]):
            units[value] = ends.get((topic["component"], element), "")
    return units


def read_units(file: Path) -> dict[str, str] | None:
    """The units in the description ``file``; None if it is not the description of a target."""
    try:
        data = json.loads(file.read_text(encoding="utf-8"))
        return {str(name): str(unit) for name, unit in units_of(data).items()} if "components" in data else None
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None
