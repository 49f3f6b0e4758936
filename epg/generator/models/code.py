# SPDX-License-Identifier: Apache-2.0
"""The model's own code, as its importer has found it: the one class that the generator asks about it.

>>> # files = model.code.files(library, render)        the access to the code, for the library's frame

Each importer derives a class of its own.  ``check``, ``resolve`` and ``emit`` know only the class here.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from epg.generator.dataclass import dataclass

if TYPE_CHECKING:
    from epg.generator.models.model import Model

Render = Callable[..., str]
"""Renders a template of the importer's folder, or of all importers: ``render("tokens.c.j2", helpers=helpers)``.

Each template also has the variables of the library: ``model``, ``name``, ``instances``, ``parameters``, and ``e``, the
object of :class:`ModelCode`.
"""


@dataclass(frozen=True)
class ModelLibrary:
    """A library that EPG makes of a model.  All its files and symbols begin with ``name``, a C identifier.

    ``values`` are new values of parameters by their names in the model.  Without ``terminate``, the library has no
    function that ends the model.
    """

    model: Model
    name: str
    values: Mapping[str, float]
    instances: int = 1
    terminate: bool = True


@dataclass(frozen=True)
class ModelBuild:
    """The sources of a model's library.  Names (``str``) are relative to the folder of the generated files.

    ``generated`` are compiled with the project's options.

    ``exported_generated`` and ``exported`` are the model's own code.  They are compiled without warnings, as C11 or
    C++17, with ``-ffp-contract=off``, and with ``forced_header`` included first.  Their private include path is
    ``include_dirs`` and ``generated_include_dirs``, then the generated folder and its ``<name>_headers``.
    """

    generated: tuple[str, ...]
    exported_generated: tuple[str, ...]
    exported: tuple[Path, ...]
    include_dirs: tuple[Path, ...]
    forced_header: str | None
    language: str  # "c" or "c++"
    generated_include_dirs: tuple[str, ...] = ()
    foreign: Path | None = None  # the description of an FMU: its code is linked alone, to find what it lacks
    heap: int = 0  # bytes of each instance


class ModelCode(ABC):
    """How the library of a model calls the model's own code.  A subclass is a frozen data class."""

    templates: Path
    """The folder of the templates."""

    heap = 0
    """Bytes that each instance can allocate."""

    writes_every_output = False
    """True if each call writes all outputs, so that the code can get the caller's structure."""

    @property
    def derives(self) -> bool:
        """True if values that follow from parameters are computed only at the start and after a change.

        Then the code has the function ``<name>_export_derive()``.
        """
        return False

    @property
    def starts_by_step(self) -> bool:
        """True if the first step computes the outputs at time 0, because the code has no function for that."""
        return False

    judges_itself = False
    """True if the code reports errors of its own, so that EPG need not look for NaN and infinite numbers first."""

    on_end = "Computes the model's final equations."
    """A comment: the effect of the function that ends the model."""

    on_stop = "executed `stopsimulation`"
    """A comment: the last thing that the model does before it has stopped."""

    @property
    def finite_while(self) -> str:
        """A comment: the condition that the library checks after each step."""
        return "no state or rate is NaN or infinite"

    alone = "keeps its state in global variables"
    """Why a program can have only one instance, if it can have only one."""

    other_instance = ", or export it as a C++ class"
    """The rest of a hint: another way to a second instance."""

    @property
    def instantiable(self) -> bool:
        """True if a program can have several instances."""
        return True

    @abstractmethod
    def files(self, library: ModelLibrary, render: Render) -> dict[str, str]:
        """The files of the library that call the model's own code: file name to text.

        One of them is ``<name>_export.c``, or ``.cpp`` for C++.  It defines the functions of ``<name>_export.h``.
        """

    @abstractmethod
    def build(self, library: ModelLibrary, frame: ModelBuild) -> ModelBuild:
        """How to compile the library: ``frame``, which has only generated files, with what the model's code needs."""

    def limits_values(self, model: Model) -> bool:
        """True if the library limits numbers to the types that hold them in the model's own code."""
        return False

    def rounded(self, model: Model) -> frozenset[str]:
        """The functions that the code calls and whose last bits depend on the C library: "sin", "exp"."""
        return model.rounded

    def about(self, model: Model) -> str:
        """A sentence about the model, for a comment."""
        names = {"RungeKutta2": "Runge Kutta 2", "RungeKutta4": "Runge Kutta 4"}
        return f"Integration method: {names.get(model.method, model.method)}."

    def with_step(self, model: Model, step: Fraction) -> Model | None:
        """``model`` with another step, in seconds; None if its code has a fixed step."""
        return None
