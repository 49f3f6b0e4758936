# SPDX-License-Identifier: Apache-2.0
"""A controller or plant, in the same form for all tools and formats."""

from __future__ import annotations

from dataclasses import field
from fractions import Fraction
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.models.code import ModelCode
from epg.generator.source import Span


@dataclass(frozen=True)
class Port:
    """An input or output of a model.

    ``name`` is the name in the model, in which 20-sim allows ``\\`` and ``.``.  ``identifier`` is the C identifier in
    generated code.  ``unit`` is empty if the model does not state one.

    ``whole`` is True if the model's own code holds the value in an integer type, as far as EPG can see.

    ``index`` is the position in the ``u[]`` or ``y[]`` of the export.  It must not be used to identify a port, because
    a new port changes the positions of the others.
    """

    name: str
    identifier: str
    direction: str  # "input" or "output"
    unit: str
    type: str  # "real", "integer" or "boolean"
    index: int
    span: Span
    description: str = ""
    whole: bool = False


@dataclass(frozen=True)
class Parameter:
    """A parameter with its exported value.  ``name`` is the name in 20-sim, with ``\\`` between levels: ``PID1\\kp``.

    A parameter that is not ``tunable`` cannot change after the start.  Tunable parameters come first in a model.
    ``whole`` is as for ports.
    """

    name: str
    identifier: str
    value: float
    unit: str
    index: int
    span: Span
    tunable: bool = True
    whole: bool = False


@dataclass(frozen=True)
class Model:
    """One model.  ``step`` is the exact time between two steps, in seconds.

    ``directory`` is the folder of the model.  ``files`` are all files that were read; the model can change if one of
    them changes.  ``span`` is the place of messages about the whole model.
    """

    name: str
    origin: str  # "20-sim C function", "20-sim C++ class", "20-sim tokens", "FMI 2.0 FMU", "hand-written"
    language: str  # "c" or "c++"
    version: str  # of 20-sim, for example "5.1.4.13773"; empty if unknown
    method: str  # integration method: "Discrete", "Euler", "RungeKutta4", ...; empty for FMUs and hand-written models
    step: Fraction
    inputs: tuple[Port, ...]
    outputs: tuple[Port, ...]
    parameters: tuple[Parameter, ...]
    directory: Path
    files: tuple[Path, ...]
    span: Span
    code: ModelCode = field(repr=False)
    """How a library calls the model's own code, as the importer has found it."""
    searched: tuple[Path, ...] = ()
    """The folders beside ``directory`` that were searched: a new or removed file in them can change the model."""
    considered: tuple[Path, ...] = ()
    """Files that were read to find those of the model, and that may not belong to it.  Their changes can change it."""
    rounded: frozenset[str] = frozenset()
    """The functions that the model calls and whose last bits depend on the C library: "sin", "exp"."""

    @property
    def instantiable(self) -> bool:
        """True if a program can have several instances.

        Most exports of the C function target cannot: they keep their state in global variables.
        """
        return self.code.instantiable

    def with_step(self, step: Fraction) -> Model | None:
        """The model with a step of ``step`` seconds; None if its code has a fixed step."""
        return self if step == self.step else self.code.with_step(self, step)
