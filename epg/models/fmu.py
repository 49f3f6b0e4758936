# SPDX-License-Identifier: Apache-2.0
"""Imports source-code FMUs of FMI 2.0 and 3.0 for co-simulation: a ``.fmu``, or the folder of an unpacked one.

>>> # model = load_fmu(Path("servo.fmu"), diagnostics)
>>> # model.origin, [port.name for port in model.inputs]  ->  'FMI 2.0 FMU', ['setpoint', 'position']
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from epg.diagnostics import Diagnostics
from epg.documents.text_file import one_line
from epg.documents.xml_file import parse_xml
from epg.models.assignments import assignments, exact_number, is_step, number
from epg.models.c_code import typedefs
from epg.models.details import FmuExport, FmuParameter, FmuPorts, GlobalVariable
from epg.models.features import FIXED_STEP_METHODS
from epg.models.fmu_description import Description, read_description
from epg.models.fmu_features import check_fmu, check_guid, uses_heap
from epg.models.fmu_files import DESCRIPTION, read_fmu_files
from epg.models.fmu_sources import FMI_HEADERS, FmuSources, find_sources
from epg.models.fmu_variables import TYPES_2, TYPES_3, FmuVariable
from epg.models.global_variables import global_variables
from epg.models.identifiers import to_identifier, unique_identifiers, unique_titles
from epg.models.link import Linked
from epg.models.metadata import warn_of_values
from epg.models.model import Model, Parameter, Port
from epg.models.ports import check_identifiers
from epg.source import Span

HEAP = 16 << 10
"""The default heap of each instance, in bytes.  FMUs of 20-sim need heap for their variables."""

_HINT = "export the FMU again"
_MOST_CALLS = 100_000  # calls of DoStep in one step of the model; more would take too long on every target
_STEP_SIZE = re.compile(r"(?<!\w)(\w{1,64}(?:->|_))?step_size\s{0,80}=(?!=)\s{0,80}([^=;]{1,40});", re.ASCII)
_TYPES = {**TYPES_2, **TYPES_3}


# One function, because it is a list of steps: each needs results of those before it.
def load_fmu(
    path: Path,
    diagnostics: Diagnostics,
    *,
    step: Fraction | None = None,
    step_span: Span | None = None,
    heap: int | None = None,
    definitions: tuple[tuple[str, str], ...] = (),
    beside: Path | None = None,
) -> Model | None:
    """The model in the FMU at ``path``.  None if it cannot be used; the reasons are reported.

    ``step``, in seconds, replaces the step of the FMU; it is written at ``step_span``.  ``heap``, in bytes, replaces
    the default :data:`HEAP`.  ``definitions`` are macros for its sources.  ``beside`` is the model.yaml that contains
    these values, if there is one.
    """
    before = diagnostics.error_count
    files = read_fmu_files(path, diagnostics)
    if files is None:
        return None
    whole = Span(str(files.path(DESCRIPTION)))
    root = parse_xml(files.contents[DESCRIPTION], whole, diagnostics, hint=_HINT, shown=files.archive)
    description = read_description(root, diagnostics) if root is not None else None
    if description is None:
        return None
    sources = find_sources(files, description, diagnostics)
    own_step = _own_step(description, sources) if sources is not None else None
    step = _step(description, own_step, step, step_span, diagnostics)
    if sources is None:
        return None
    rounded = check_fmu(sources.linked, description.standard, diagnostics)
    check_guid(sources.codes.values(), description.guid, description.span, description.standard, diagnostics)
    inputs, outputs = (_ports(description, direction, diagnostics) for direction in ("input", "output"))
    parameters, places = _parameters(description)
    if own_step is not None:
        _check_method(sources, diagnostics)
        parameters = _values_of_sources(parameters, sources, diagnostics)
    if step is None or diagnostics.error_count > before:
        return None
    variables = _global_memory(sources.linked) if own_step is not None else ()
    states = {variable.reference: variable.count for variable in description.variables if variable.state}
    needed = uses_heap(sources.codes.values())
    names = sorted({*sources.units, *sources.headers})
    read = {files.path(name) for name in names} if not files.archive else set()
    return Model(
        name=description.name,
        origin=f"FMI {description.version} FMU",
        language="c",
        version="",
        method="",
        step=step,
        inputs=inputs,
        outputs=outputs,
        parameters=parameters,
        rounded=rounded,
        directory=beside.parent if beside is not None else path,
        files=tuple(sorted({*files.inputs, *read, *([beside] if beside is not None else [])})),
        span=description.span,
        details=FmuExport(
            standard=description.standard,
            tool=description.tool,
            guid=description.guid,
            instance_name=_ascii(description.name),
            linked=sources.linked,
            root=files.root,
            units=sources.units,
            include_dirs=sources.include_dirs,
            packed=tuple((name, sources.codes[name].file.text) for name in names) if files.archive else (),
            headers=tuple(name for name in FMI_HEADERS[description.standard] if name not in sources.own_headers),
            definitions=tuple({**dict(sources.definitions), **dict(definitions)}.items()),
            renames=_renames(sources.linked),
            prefixes=_prefixes(sources.linked, description.identifier),
            plain_names=not _names_by_header(description.standard, sources),
            inputs=_groups(description, "input"),
            outputs=_groups(description, "output"),
            parameters=places,
            states=tuple(sorted(states)),
            state_count=sum(states.values()),
            variables=variables,
            own_step=own_step,
            terminated="fmi2GetBooleanStatus" in {f.name for _, f in sources.linked.functions()},
            heap=(HEAP if heap is None else heap) if needed else 0,
            instantiable=not description.once and not variables,
        ),
    )


def _own_step(description: Description, sources: FmuSources) -> Fraction | None:
    """The step of the integration method of an FMU of 20-sim, in seconds.  None for other FMUs.

    The sources set it: ``xx_step_size = 0.001`` in version 4.5, ``model_instance->step_size = 0.001`` in later ones.
    If they do not set exactly one value, it is the step of the description.
    """
    names = {function.name for _, function in sources.linked.functions()}
    if description.standard != 2 or not (
        description.is_20sim or any(name.endswith("CalculateSubmodel") for name in names)
    ):
        return None
    found = set()
    for code in sources.codes.values():
        for match in _STEP_SIZE.finditer(code.file.code):
            value = exact_number(match[2])
            if value is not None and is_step(value) and not re.search("initial|max|min", match[1] or ""):
                found.add(value)
    return found.pop() if len(found) == 1 else description.step


def _check_method(sources: FmuSources, diagnostics: Diagnostics) -> None:
    """Warns of an integration method with a variable step.

    Such an FMU reaches the end of each step, but the time that it needs for that has no upper limit.
    """
    for code, function in sources.linked.functions():
        for name, start in code.calls(function) if function.name.endswith("CalculateSubmodel") else ():
            method = name.removeprefix("XX").removesuffix("Step")
            if name == f"XX{method}Step" and method not in FIXED_STEP_METHODS:
                message = (
                    f"integration method '{method}' has a variable number of steps: the time of a cycle has no limit"
                )
                hint = (
                    "for a target in real time, choose Discrete, Euler, Runge Kutta 2 or 4 in 20-sim and export again"
                )
                diagnostics.warning("model-variable-step", code.file.span(start, start + len(name)), message, hint=hint)


def _step(
    description: Description,
    own_step: Fraction | None,
    wanted: Fraction | None,
    wanted_span: Span | None,
    diagnostics: Diagnostics,
) -> Fraction | None:
    """The time between two steps of the model, in seconds.  None if there is none, or if the FMU cannot make it."""
    step = wanted or description.step
    if step is None:
        if any(item.id == "fmu-step" for item in diagnostics):
            return None  # the FMU has a step that is not a number, which is already reported
        message = "the FMU does not set its step: there is no stepSize in its DefaultExperiment"
        hint = (
            "write a model.yaml with 'version: 1', 'fmu: <its file or folder>' and 'step: 1 ms', "
            "and name this file as the model"
        )
        diagnostics.error("fmu-step", description.step_span, message, hint=hint)
        return None
    base = description.internal_step or own_step
    message = ""
    if base is not None and (step / base).denominator != 1:
        message = f"the step {float(step):g} s is not a multiple of the FMU's internal step, {float(base):g} s"
    elif own_step is not None and step / own_step > _MOST_CALLS:
        needs = f"the step {float(step):g} s needs more than {_MOST_CALLS} internal steps of the FMU"
        message = f"{needs}, {float(own_step):g} s each"
    if message:
        span = wanted_span or description.step_span
        diagnostics.error("fmu-step", span, message, hint="export the FMU with the step of the target")
        return None
    return step


# ports and parameters ------------------------------------------------------------------------------------------------


def _ports(description: Description, direction: str, diagnostics: Diagnostics) -> tuple[Port, ...]:
    ports: list[Port] = []
    for variable in description.variables:
        if variable.causality != direction:
            continue
        for name in variable.element_names():
            port = Port(
                name,
                to_identifier(name.rstrip("]") if variable.dimensions else name),
                direction,
                "" if variable.unit == "1" else variable.unit,
                _TYPES[variable.type],
                len(ports),
                variable.span,
                variable.description,
            )
            ports.append(port)
    check_identifiers(ports, diagnostics)
    return tuple(ports)


def _groups(description: Description, direction: str) -> tuple[FmuPorts, ...]:
    """The ports grouped by type, because each function of FMI gets or sets values of one type."""
    groups: dict[str, tuple[list[int], list[int], list[tuple[int, int] | None]]] = {}
    position = 0
    for variable in description.variables:
        if variable.causality == direction:
            references, positions, limits = groups.setdefault(variable.type, ([], [], []))
            references.append(variable.reference)
            positions.extend(range(position, position + variable.count))
            limits.extend([variable.limits] * variable.count)
            position += variable.count
    return tuple(FmuPorts(kind, tuple(of), tuple(at), tuple(to)) for kind, (of, at, to) in sorted(groups.items()))


def _parameters(description: Description) -> tuple[tuple[Parameter, ...], tuple[FmuParameter, ...]]:
    """The scalar parameters whose start value is a number, tunable ones first.  Others keep their start values."""
    chosen: list[tuple[FmuVariable, float]] = []
    for variable in description.variables:
        if variable.causality == "parameter" and not variable.dimensions:
            value = number(variable.start)
            if value is not None:
                chosen.append((variable, value))
    chosen.sort(key=lambda item: item[0].variability != "tunable")
    titles = unique_titles(variable.name for variable, _ in chosen)
    parameters = []
    for index, ((variable, value), title, identifier) in enumerate(
        zip(chosen, titles, unique_identifiers(titles), strict=True)
    ):
        unit = "" if variable.unit == "1" else variable.unit
        tunable = variable.variability == "tunable"
        parameters.append(Parameter(title, identifier, value, unit, index, variable.span, tunable))
    places = [FmuParameter(variable.type, variable.reference) for variable, _ in chosen]
    return tuple(parameters), tuple(places)


def _values_of_sources(
    parameters: tuple[Parameter, ...], sources: FmuSources, diagnostics: Diagnostics
) -> tuple[Parameter, ...]:
    """The parameters of an FMU of 20-sim, with their values in the sources.  Warns if the description differs.

    Elements of arrays keep the values of the description: some versions count them from 0 there.
    """
    told: dict[str, set[float]] = {}
    places: dict[str, Span] = {}
    for name in sources.units:
        file = sources.codes[name].file
        for line in assignments(file):
            value = number(line.value)
            if line.array.endswith(("P", "I")) and line.name and "[" not in line.name and value is not None:
                title = line.name.replace("\\", ".")
                told.setdefault(title, set()).add(value)
                places.setdefault(title, line.span)
    result, different = [], []
    for parameter in parameters:
        values = told.get(parameter.name, set())
        if len(values) == 1 and values != {parameter.value}:
            value = min(values)
            different.append((parameter.span, parameter.value, value, parameter.name, places[parameter.name]))
            parameter = replace(parameter, value=value)
        result.append(parameter)
    warn_of_values(DESCRIPTION, different, diagnostics)
    return tuple(result)


# sources -------------------------------------------------------------------------------------------------------------


def _prefixes(linked: Linked, identifier: str) -> tuple[str, ...]:
    """The prefixes that the FMU's sources themselves define for the names of FMI's functions.

    If the prefix is composed of other macros, it is the one that the standard requires (FMI 2.0.4, section 2.1.1).
    """
    found = {
        macro.value if macro.value.isidentifier() else f"{identifier}_"
        for code in linked.all
        for macro in code.macros
        if macro.name in ("FMI2_FUNCTION_PREFIX", "FMI3_FUNCTION_PREFIX") and macro.value
    }
    return tuple(sorted(name for name in found if name.isascii() and name.isidentifier()))


def _names_by_header(standard: int, sources: FmuSources) -> bool:
    """True if the sources include the header that gives the functions of FMI their prefix."""
    header = FMI_HEADERS[standard][2]
    if header in sources.own_headers:
        return True
    return any(include.name.endswith(header) for code in sources.codes.values() for include in code.includes)


def _global_memory(linked: Linked) -> tuple[GlobalVariable, ...]:
    """The global variables of an FMU of 20-sim 4.5 or 4.6.0; empty for later versions.

    These FMUs keep their state in global variables, and do not reset all of them at a start.
    """
    variables = [variable for code in linked.units for variable in code.variables if not variable.static]
    if not any(variable.name.endswith("MEMORY") for variable in variables):
        return ()
    types = {name: base.removeprefix("const ") for code in linked.all for name, base in typedefs(code)}
    defined = {variable.name: variable for variable in variables if _is_defined(variable.type)}
    return global_variables(defined.values(), types, linked.macros())


def _renames(linked: Linked) -> tuple[str, ...]:
    """The global symbols of the FMU, including the functions of FMI."""
    names: set[str] = set()
    for code in linked.all:
        names |= {function.name for function in code.functions if not function.static}
        names |= {variable.name for variable in code.variables if not variable.static and _is_defined(variable.type)}
    macros = linked.macro_names()
    return tuple(sorted(_identifiers(names - macros)))


def _is_defined(type: str) -> bool:
    return type not in ("extern", "struct", "union", "enum")


def _identifiers(names: Iterable[str]) -> list[str]:
    return [name for name in names if name.isascii() and name.isidentifier() and name not in ("main", "defined")]


def _ascii(text: str) -> str:
    return one_line(text).encode("ascii", "replace").decode("ascii") or "model"
