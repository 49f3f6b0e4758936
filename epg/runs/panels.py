# SPDX-License-Identifier: Apache-2.0
"""Arranges the signals of a recording in panels: a setpoint and the values that follow it share one.

A setpoint is known as such, or its name has a word such as "setpoint".  A value follows it if both have the same unit,
and a word in common that not all setpoints have: ``setpoint_pan``, ``position_pan``.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from epg.generator.dataclass import dataclass

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
        return " ".join(word for word in words_in(self.names[0]) if word in common) or "value"


def panels_of(names: Iterable[str], known_setpoints: Collection[str], units: Mapping[str, str]) -> list[Panel]:
    """The panels, in the order of the signals.

    >>> panels_of(["inputs.position_pan", "inputs.setpoint_pan", "outputs.pwm_pan", "spare"], (), {})
    [Panel(setpoints=('inputs.setpoint_pan',), values=('inputs.position_pan',), unit=''), \
Panel(setpoints=(), values=('outputs.pwm_pan',), unit=''), Panel(setpoints=(), values=('spare',), unit='')]
    """
    names = list(names)
    setpoints = [name for name in names if name in known_setpoints or _words(name) & _SETPOINT]
    axes = _axes(setpoints, units)
    single = []  # values that follow no setpoint
    for name in names:
        if name not in setpoints:
            axis = _followed(name, axes, units)
            if axis is not None:
                axis.values.append(name)
            else:
                single.append(_Axis(frozenset(), [], [name]))
    panels = [Panel(tuple(axis.setpoints), tuple(axis.values), axis.unit(units)) for axis in (*axes, *single)]
    return sorted(panels, key=lambda panel: min(map(names.index, panel.names)))


class _Axis(NamedTuple):
    """Setpoints with the same ``words``, and the values that follow them.  A value without a setpoint is alone."""

    words: frozenset[str]
    setpoints: list[str]
    values: list[str]

    def unit(self, units: Mapping[str, str]) -> str:
        return next((units[name] for name in (*self.setpoints, *self.values) if units.get(name)), "")

    def is_alike(self, name: str, units: Mapping[str, str]) -> bool:
        """True if the signal ``name`` can be of the same quantity as the setpoints."""
        first = self.setpoints[0]
        if first in units and name in units and units[first] != units[name]:
            return False
        kinds = [(bool(words & _RATES), words & _OTHER) for words in (_words(first), _words(name))]
        return kinds[0] == kinds[1]


def _axes(setpoints: Sequence[str], units: Mapping[str, str]) -> list[_Axis]:
    """The axes of the setpoints, still without values."""
    common = frozenset.intersection(*map(_words, setpoints)) if len(setpoints) > 1 else frozenset()
    axes: list[_Axis] = []
    for name in setpoints:
        words = _words(name) - _SETPOINT - _PLACES - _RATES - common
        axis = next((axis for axis in axes if axis.words == words and axis.is_alike(name, units)), None)
        if axis is None:
            axes.append(_Axis(words, [name], []))
        else:
            axis.setpoints.append(name)
    return axes


def _followed(value: str, axes: Sequence[_Axis], units: Mapping[str, str]) -> _Axis | None:
    """The axis whose setpoint the signal ``value`` follows: that with the most words in common; None if there is none.

    A single axis whose name has no words of its own is followed by all values of its quantity.
    """
    words = _words(value)
    alike = [axis for axis in axes if axis.is_alike(value, units)]
    nearest = max(alike, key=lambda axis: len(axis.words & words), default=None)
    if nearest is None or nearest.words & words or (len(axes) == 1 and not nearest.words):
        return nearest
    return None


def _words(name: str) -> frozenset[str]:
    return frozenset(words_in(name))


def words_in(name: str) -> list[str]:
    """The words of a name in their order, such as ``inputs.setpointPan_2``: inputs, setpoint, pan, 2."""
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
