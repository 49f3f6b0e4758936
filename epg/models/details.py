# SPDX-License-Identifier: Apache-2.0
"""The data of a model that only the emitter needs, beside :class:`~epg.models.model.Model`.  One class per origin."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

from epg.dataclass import dataclass
from epg.models.link import Linked
from epg.models.tokens import Tokens


@dataclass(frozen=True)
class EntryPoint:
    """A function of the export that the wrapper calls.  ``arguments`` are the meanings of its arguments, in order.

    "u" and "y" are the vectors of ports.  "time" is the time before the step and "next_time" the time after it.
    "step" is the step size, which some users pass instead of the time.  "instance" is a pointer to the model's memory.
    """

    name: str
    arguments: tuple[str, ...]
    result: str = "void"  # the type of its result, in C


@dataclass(frozen=True)
class PortElement:
    """The array element that holds a port, in exports without ``u[]`` and ``y[]``: sources of FMUs."""

    array: str
    index: int


@dataclass(frozen=True)
class Place:
    """The place of a parameter's value in the sources.  ``start`` and ``end`` are offsets into the text of ``file``."""

    file: Path
    start: int
    end: int


@dataclass(frozen=True)
class GlobalVariable:
    """A variable of the export that the wrapper resets to its initial value at each start.

    ``count`` is the number of elements of an array, which becomes zero.  It is 0 for a scalar, which becomes ``value``.
    """

    name: str
    type: str  # of C: "double", "int", "char"
    count: int
    value: str


@dataclass(frozen=True)
class CFunctionExport:
    """An export of 20-sim's C function target, or the C sources of its FMU target."""

    linked: Linked
    real: str  # the C type of XXDouble
    initialize: EntryPoint
    calculate: EntryPoint
    terminate: EntryPoint
    calculate_static: EntryPoint | None
    model_initialize: EntryPoint | None  # None if Initialize calls it; it does not in FMUs of 20-sim 4.6 and later
    inputs: tuple[PortElement, ...]  # empty if the entry points take vectors of ports
    outputs: tuple[PortElement, ...]
    parameters: str  # names of arrays
    states: str
    rates: str
    state_count: int
    pointers: tuple[str, ...]  # the global variables that are pointers, for example into the export's memory
    time: str  # names of variables; empty if the model does not have them
    stop: str
    variables: tuple[GlobalVariable, ...]
    places: tuple[tuple[Place, ...], ...]  # the places of each parameter's value
    instance_type: str  # the typedef of the model's memory; empty for exports with global variables
    instance_header: str  # the header that declares this type
    memory: tuple[tuple[str, str], ...]  # the pointers in an instance, each with its offset in MEMORY
    declared: bool  # True if that header also declares the entry points
    renames: tuple[str, ...]  # the global symbols, which generated macros rename

    @property
    def instantiable(self) -> bool:
        return bool(self.instance_type)


@dataclass(frozen=True)
class CppClassExport:
    """An export of 20-sim's C++ class target."""

    linked: Linked
    class_name: str
    real: str
    methods: frozenset[str]  # of the class: not every version of 20-sim has "Reset" and "SetFinishTime"
    members: frozenset[str]  # data members of the class and its bases: "m_stop_run", ...
    state_count: int
    parameters: str  # names of arrays
    states: str
    rates: str
    places: tuple[tuple[Place, ...], ...]
    instantiable = True


@dataclass(frozen=True)
class TokensExport:
    """A ``tokens.xml`` without exported C or C++ files."""

    tokens: Tokens
    functions: tuple[str, ...]  # the helper functions that the equations call, without prefix: "Absolute", "Sign", ...
    instantiable = True


@dataclass(frozen=True)
class HandWritten:
    """A controller written by hand: a ``model.yaml`` and the user's own sources."""

    style: str  # "struct" or "arrays"
    header: str
    sources: tuple[Path, ...]
    include_dirs: tuple[Path, ...]
    instance: str  # the C type of an instance; empty if the functions do not take an instance
    inputs_type: str
    outputs_type: str
    init: str
    step: str
    terminate: str
    stopped: str
    finite: str
    members: tuple[str, ...]  # for each parameter, the member of the instance or the global variable
    renames: tuple[str, ...]
    system_headers: tuple[str, ...]

    @property
    def instantiable(self) -> bool:
        return bool(self.instance)


@dataclass(frozen=True)
class FmuPorts:
    """All inputs, or all outputs, of one type of FMI, for example "Real" or "Float64".

    ``references`` are value references; ``positions`` are positions among all inputs or outputs.  An array has one
    reference and several positions.  ``limits`` has for each position the limits of an enumeration, or None.
    """

    type: str
    references: tuple[int, ...]
    positions: tuple[int, ...]
    limits: tuple[tuple[int, int] | None, ...]


@dataclass(frozen=True)
class FmuParameter:
    """A parameter in FMI: its type and its value reference."""

    type: str
    reference: int


@dataclass(frozen=True)
class FmuExport:
    """A source-code FMU of FMI 2.0 or 3.0.

    The names of files and folders are relative to ``root``, the folder or the archive.  For an archive, ``packed``
    holds its files with their texts; for a folder, it is empty.
    """

    standard: int  # 2 or 3
    tool: str  # the program that made the FMU
    guid: str  # in FMI 3.0, the instantiation token
    instance_name: str
    linked: Linked
    root: Path
    units: tuple[str, ...]
    include_dirs: tuple[str, ...]
    packed: tuple[tuple[str, str], ...]
    headers: tuple[str, ...]  # the headers of the standard that the FMU does not contain
    definitions: tuple[tuple[str, str], ...]  # macros with their values
    renames: tuple[str, ...]  # the global symbols; those that are functions of FMI get a prefix instead
    prefixes: tuple[str, ...]  # prefixes that the sources themselves give to the functions of FMI
    plain_names: bool  # True if no header gives a prefix to the functions of FMI
    inputs: tuple[FmuPorts, ...]
    outputs: tuple[FmuPorts, ...]
    parameters: tuple[FmuParameter, ...]
    states: tuple[int, ...]  # value references of continuous states
    state_count: int  # the number of their values: an array has several
    variables: tuple[GlobalVariable, ...]  # reset at a start; empty if the FMU has memory for each instance
    own_step: Fraction | None  # seconds: the step of an FMU of 20-sim, which each call of DoStep requests
    terminated: bool  # True if the function fmi2GetBooleanStatus exists
    heap: int  # bytes of heap for each instance; 0 if the FMU does not allocate memory
    instantiable: bool
