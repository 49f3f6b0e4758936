# SPDX-License-Identifier: Apache-2.0
"""A controller or plant as the rest of EPG sees it, whatever tool it came from."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path

from epg.source import Span


@dataclass(frozen=True)
class Port:
    """An input or output of a model.

    ``name`` is the name in the model (20-sim allows ``\\`` and ``.`` in it), ``identifier`` the C identifier used for
    it in generated code.  ``unit`` is empty when the model states none.  ``index`` is the position in the
    export's ``u[]`` or ``y[]``: an implementation detail, as adding a port renumbers the others.
    """

    name: str
    identifier: str
    direction: str  # "input" or "output"
    unit: str
    type: str  # "real", "integer" or "boolean"
    index: int
    span: Span
    description: str = ""


@dataclass(frozen=True)
class Parameter:
    """A parameter with its exported value; ``name`` as in 20-sim, hierarchical with ``\\``: ``PID1\\kp``.

    One that is not ``tunable`` has its value from the start on; those that are come first in a model.
    """

    name: str
    identifier: str
    value: float
    unit: str
    index: int
    span: Span
    tunable: bool = True


@dataclass(frozen=True)
class Model:
    """One model.  ``step`` is exact, in seconds.

    ``directory`` holds the files, ``files`` lists every file that was read (a change of one of them makes the model
    another model).  ``span`` is where the model begins, for messages about it as a whole.
    """

    name: str
    origin: str  # "20-sim C function", "20-sim C++ class", "20-sim tokens", "hand-written"
    language: str  # "c" or "c++"
    version: str  # of 20-sim, "5.1.4.13773"; empty when unknown
    method: str  # integration method: "Discrete", "Euler", "RungeKutta4", ...; empty for hand-written models
    step: Fraction
    inputs: tuple[Port, ...]
    outputs: tuple[Port, ...]
    parameters: tuple[Parameter, ...]
    directory: Path
    files: tuple[Path, ...]
    span: Span
    details: object = field(default=None, repr=False)
    """What only the importer's own emitter needs: sources, prefixes, class name; see ``details.py``."""
    finish_time: float | None = None
    """Where the experiment in 20-sim ends, in seconds.  Nothing ends there on a target."""
    searched: tuple[Path, ...] = ()
    """Folders beside ``directory`` in which files were looked for: others in them may make another model."""
    twins: tuple[Path, ...] = ()
    """Files that are no part of the model as long as they say the same as one that is."""

    @property
    def instantiable(self) -> bool:
        """Whether there can be several instances: exports as C functions keep their state in global variables."""
        return bool(getattr(self.details, "instantiable", False))
