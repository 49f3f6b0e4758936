# SPDX-License-Identifier: Apache-2.0
"""A model as equations, and the arrays in which 20-sim's code keeps its values.

A definition is text, section by section::

    inputs      position {rad}
    outputs     pwm
    parameters  Pan\\PID\\kp = 2.6 {}
    states      Pan\\PID\\uI_previous = 0.0 : Pan\\PID\\uI
    static      Pan\\PID\\factor = 1 / (sampletime + Pan\\PID\\tauD)
    dynamic     ...
    output      pwm = ...

A state names its initial value and, after the colon, its rate (in a discrete model: its next value).
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from writer import equations

_SECTIONS = ("inputs", "outputs", "parameters", "states", "static", "dynamic", "output")
_VARIABLE = re.compile(r"([\w\\]+)\s*(?:=\s*([-+\w.]+)\s*)?(?:\{(.*?)\})?\s*(?::\s*([\w\\]+))?")


@dataclass(frozen=True)
class Quantity:
    """A port, parameter or state.  ``unit`` is None if 20-sim would not print a unit; only states have a ``rate``."""

    name: str
    value: str = "0.0"
    unit: str | None = None
    rate: str = ""

    @property
    def braces(self) -> str:
        return "" if self.unit is None else f" {{{self.unit}}}"


@dataclass(frozen=True)
class Definition:
    """A model before its values have places in arrays.  ``step`` and ``finish`` are numbers as C prints them, in s."""

    name: str
    method: str  # "Discrete" or "RungeKutta4"
    step: str
    finish: str
    inputs: tuple[Quantity, ...]
    outputs: tuple[Quantity, ...]
    parameters: tuple[Quantity, ...]
    states: tuple[Quantity, ...]
    equations: dict[str, tuple[tuple[str, str], ...]]  # section -> (left, right)

    @property
    def variables(self) -> tuple[str, ...]:
        """Everything in the array V: first the results of equations, then outputs, then inputs, in 20-sim's order."""
        rates = {state.rate for state in self.states}
        ports = {port.name for port in self.inputs + self.outputs}
        computed = [left for section in ("static", "dynamic", "output") for left, _ in self.equations[section]]
        inner = [left for left in computed if left not in rates and left not in ports]
        return (*sorted(inner), *(port.name for port in self.outputs), *(port.name for port in self.inputs))

    @property
    def functions(self) -> set[str]:
        return {f for section in self.equations.values() for _, right in section for f in equations.functions(right)}

    def symbol(self, name: str, prefix: str) -> str:
        """The C expression for ``name``: ``xx_V[3]``, ``m_P[0]``, ``xx_step_size``."""
        if name in ("sampletime", "time"):
            return prefix + {"sampletime": "step_size", "time": "time"}[name]
        tables: tuple[tuple[str, tuple[str, ...]], ...] = (
            ("P", tuple(p.name for p in self.parameters)),
            ("s", tuple(s.name for s in self.states)),
            ("R", tuple(s.rate for s in self.states)),
            ("V", self.variables),
        )
        for array, names in tables:
            if name in names:
                return f"{prefix}{array}[{names.index(name)}]"
        raise KeyError(f"{self.name}: no equation gives '{name}'")

    def code(self, section: str, prefix: str) -> str:
        """The equations of one section as C, each after a comment with its source; empty or ending in a newline."""
        lines = []
        for left, right in self.equations[section]:
            lines.append(f"\t/* {left} = {equations.parse(right).text}; */\n")
            value = equations.to_c(right, lambda name: self.symbol(name, prefix))
            lines.append(f"\t{self.symbol(left, prefix)} = {value};\n\n")
        return "".join(lines)


def define(name: str, method: str, step: str, finish: str, text: str) -> Definition:
    """Reads a definition; checks that each name is defined once, and before its use."""
    rows: dict[str, list[str]] = {section: [] for section in _SECTIONS}
    section = ""
    for line in re.sub(r"\n {6,}", " ", text).splitlines():  # continuation lines are indented by six or more
        if line.strip() in _SECTIONS:
            section = line.strip()
        elif line.strip():
            rows[section].append(line.strip())
    model = Definition(
        name,
        method,
        step,
        finish,
        tuple(sorted(_quantities(rows["inputs"]), key=lambda port: port.name)),
        tuple(sorted(_quantities(rows["outputs"]), key=lambda port: port.name)),
        _quantities(rows["parameters"]),
        _quantities(rows["states"]),
        {kind: tuple(_equation(row) for row in rows[kind]) for kind in ("static", "dynamic", "output")},
    )
    _check(model)
    return model


def _quantities(rows: list[str]) -> tuple[Quantity, ...]:
    found = []
    for row in rows:
        match = _VARIABLE.fullmatch(row)
        if not match:
            raise ValueError(f"not understood: {row!r}")
        found.append(Quantity(match[1], match[2] or "0.0", match[3], match[4] or ""))
    return tuple(found)


def _equation(row: str) -> tuple[str, str]:
    left, _, right = row.rstrip(";").partition(" = ")
    return left.strip(), " ".join(right.split())


def _check(model: Definition) -> None:
    known = {q.name for q in model.inputs + model.parameters + model.states} | {"sampletime", "time"}
    for section in ("static", "dynamic", "output"):
        for left, right in model.equations[section]:
            missing = equations.names(right) - known
            if missing or left in known:
                raise ValueError(f"{model.name}: {left}: uses {sorted(missing)} too early, or is given twice")
            known.add(left)
    missing = {q.rate for q in model.states} | {q.name for q in model.outputs}
    if missing - known:
        raise ValueError(f"{model.name}: no equation gives {sorted(missing - known)}")
