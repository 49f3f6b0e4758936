# SPDX-License-Identifier: Apache-2.0
"""What the emitter needs of a model beyond :class:`~epg.models.model.Model`, one class per origin."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from epg.models.link import Linked
from epg.models.tokens import Tokens


@dataclass(frozen=True)
class EntryPoint:
    """A function of the export.  ``arguments`` name what it takes, in order.

    "u" and "y" are the port vectors, "time" the time before the step, "next_time" the time after it, "step" the step
    size (some developers pass it instead of the time), "instance" a pointer to the model's memory.
    """

    name: str
    arguments: tuple[str, ...]
    result: str = "void"  # type, of C or of the export's headers


@dataclass(frozen=True)
class Element:
    """An array element that holds a port: in FMU exports there are no ``u[]`` and ``y[]``."""

    array: str
    index: int


@dataclass(frozen=True)
class Place:
    """Where a parameter's value is written in the sources: offsets into the decoded text of ``file``."""

    file: Path
    start: int
    end: int


@dataclass(frozen=True)
class GlobalVariable:
    """A variable of the export that the wrapper puts back to its first value; ``count`` is 0 for a scalar."""

    name: str
    type: str  # of C: "double", "int", "char"
    count: int
    value: str


@dataclass(frozen=True)
class CFunctionExport:
    """The C function target, or the C sources of the FMU target."""

    linked: Linked
    real: str  # the C type behind XXDouble
    initialize: EntryPoint
    calculate: EntryPoint
    terminate: EntryPoint
    calculate_static: EntryPoint | None
    model_initialize: EntryPoint | None  # only where Initialize does not call it: FMU of 4.6 and later
    inputs: tuple[Element, ...]  # only where the entry points take no vectors
    outputs: tuple[Element, ...]
    parameters: str  # array
    states: str
    rates: str
    state_count: int
    pointers: tuple[str, ...]  # arrays that are pointers into the export's memory
    time: str
    stop: str  # variable; empty when the model has none
    variables: tuple[GlobalVariable, ...]
    places: tuple[tuple[Place, ...], ...]  # of each parameter
    instance_type: str  # typedef of the model's memory; empty for exports with global variables
    instance_header: str  # that declares it
    memory: tuple[tuple[str, str], ...]  # its pointers, each with the offset it has in its MEMORY
    declared: bool  # that header declares the entry points too
    renames: tuple[str, ...]  # global symbols

    @property
    def instantiable(self) -> bool:
        return bool(self.instance_type)


@dataclass(frozen=True)
class CppClassExport:
    """The C++ class target."""

    linked: Linked
    class_name: str
    real: str
    methods: frozenset[str]  # of the class: "Reset" and "SetFinishTime" are not in every version
    members: frozenset[str]  # data members of the base class: "m_stop_run", ...
    state_count: int
    parameters: str  # array
    states: str
    rates: str
    places: tuple[tuple[Place, ...], ...]
    instantiable = True


@dataclass(frozen=True)
class TokensExport:
    """``tokens.xml`` alone."""

    tokens: Tokens
    functions: tuple[str, ...]  # helper functions the equations call, without prefix: "Absolute", "Sign", ...
    instantiable = True


@dataclass(frozen=True)
class HandWritten:
    """``model.yaml`` and the user's own sources."""

    style: str  # "struct" or "arrays"
    header: str
    sources: tuple[Path, ...]
    include_dirs: tuple[Path, ...]
    instance: str  # type; empty: functions without an instance
    inputs_type: str
    outputs_type: str
    init: str
    step: str
    terminate: str
    stopped: str
    finite: str
    members: tuple[str, ...]  # of each parameter: member of the instance, or global variable
    renames: tuple[str, ...]
    system_headers: tuple[str, ...]

    @property
    def instantiable(self) -> bool:
        return bool(self.instance)


@dataclass(frozen=True)
class FmuPorts:
    """Ports of one type of FMI, "Real" or "Float64": value references, and positions among all inputs or outputs.

    An array has one reference and several positions.  ``limits`` are those of enumerations, by position.
    """

    type: str
    references: tuple[int, ...]
    positions: tuple[int, ...]
    limits: tuple[tuple[int, int] | None, ...]


@dataclass(frozen=True)
class FmuParameter:
    """How a parameter is set: its type in FMI, and its value reference."""

    type: str
    reference: int


@dataclass(frozen=True)
class FmuExport:
    """The sources of an FMU behind the functions of FMI 2.0 or 3.0.

    Names of files inside an archive (``packed``, with their texts) begin with ``sources/``; they are empty for a
    folder, and ``units`` and ``include_dirs`` exist for a folder only.
    """

    standard: int  # 2 or 3
    tool: str  # that made it
    guid: str  # FMI 3.0: instantiation token
    instance_name: str
    linked: Linked
    units: tuple[Path, ...]
    include_dirs: tuple[Path, ...]
    packed: tuple[tuple[str, str], ...]
    packed_units: tuple[str, ...]
    packed_include_dirs: tuple[str, ...]
    headers: tuple[str, ...]  # of the standard, that the FMU does not bring
    definitions: tuple[tuple[str, str], ...]
    renames: tuple[str, ...]  # global symbols; FMI's functions, among them, get a prefix instead
    prefixes: tuple[str, ...]  # that the sources themselves put before the names of FMI's functions
    plain_names: bool  # no header puts a prefix before these names
    inputs: tuple[FmuPorts, ...]
    outputs: tuple[FmuPorts, ...]
    parameters: tuple[FmuParameter, ...]
    states: tuple[int, ...]  # value references of continuous states
    state_count: int  # of their values: arrays have several
    variables: tuple[GlobalVariable, ...]  # that a start puts back; only where the FMU has no memory per instance
    own_step: Fraction | None  # of 20-sim's FMUs, in seconds: each call of DoStep asks for one of these
    endless: bool  # an end of the experiment is given, far away: without it the FMU takes its own
    terminated: bool  # fmi2GetBooleanStatus exists
    heap: int  # bytes of each instance; 0: the FMU allocates nothing
    instantiable: bool
