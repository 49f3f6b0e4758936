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

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.text_file import one_line
from epg.generator.documents.xml_file import parse_xml
from epg.generator.importers.fmu.fmu_description import FmuDescription, read_description
from epg.generator.importers.fmu.fmu_export import FmuExport, FmuParameter, FmuPorts
from epg.generator.importers.fmu.fmu_features import KNOWN, check_complete, check_fmu, check_guid, uses_heap
from epg.generator.importers.fmu.fmu_files import DESCRIPTION, FmuFiles, read_fmu_files
from epg.generator.importers.fmu.fmu_reader import FMI_HEADERS
from epg.generator.importers.fmu.fmu_sources import FmuSources, find_sources
from epg.generator.importers.fmu.fmu_variables import TYPES_2, TYPES_3, FmuVariable
from epg.generator.models.assignments import assignments, exact_number, is_step, number
from epg.generator.models.c_code import Function, Variable, typedefs
from epg.generator.models.code_parts import GlobalVariable
from epg.generator.models.conditions import NO, OPEN, YES, either
from epg.generator.models.features import FIXED_STEP_METHODS
from epg.generator.models.global_variables import global_variables
from epg.generator.models.identifiers import to_identifier, unique_identifiers, unique_titles
from epg.generator.models.link import Linked
from epg.generator.models.metadata import warn_of_values
from epg.generator.models.model import Model, Parameter, Port
from epg.generator.models.ports import check_identifiers
from epg.generator.quantity import show
from epg.generator.source import Span

HEAP = 16 << 10
"""The default heap of each instance, in bytes.  FMUs of 20-sim need heap for their variables."""

_HINT = "export the FMU again"
_MOST_CALLS = 100_000  # calls of DoStep in one step of the model; more would take too long on every target
_STEP_SIZE = re.compile(r"(?<!\w)(\w{1,64}(?:->|_))?step_size\s{0,80}=(?!=)\s{0,80}([^=;]{1,40});", re.ASCII)
_TYPES = {**TYPES_2, **TYPES_3}


@dataclass(frozen=True)
class FmuSettings:
    """The values of a model.yaml for an FMU.

    ``step``, in seconds, replaces the step of the FMU; it is written at ``step_span``.  ``heap``, in bytes, replaces
    the default :data:`HEAP`.  ``definitions`` are macros for its sources.  ``beside`` is the model.yaml, if there is
    one.
    """

    step: Fraction | None = None
    step_span: Span | None = None
    heap: int = HEAP
    definitions: tuple[tuple[str, str], ...] = ()
    beside: Path | None = None


def load_fmu(path: Path, diagnostics: Diagnostics, settings: FmuSettings) -> Model | None:
    """The model in the FMU at ``path``.  None if it cannot be used; the reasons are reported."""
    before = diagnostics.error_count
    files = read_fmu_files(path, diagnostics)
    if files is None:
        return None
    description = _description(files, diagnostics)
    if description is None:
        return None
    sources = find_sources(files, description, diagnostics, settings.definitions, settings.beside)
    if sources is None:
        _step(description, None, settings, diagnostics)  # a missing step is reported, too
        return None
    own_step = _own_step(description, sources)
    step = _step(description, own_step, settings, diagnostics, sources.hidden or ())
    if sources.hidden is not None:
        return None
    rounded = check_fmu(sources, description.standard, diagnostics)
    check_complete(sources, files, description.standard, diagnostics)
    check_guid(sources.codes.values(), description.guid, description.span, description.standard, diagnostics)
    inputs, outputs = (_ports(description, direction, diagnostics) for direction in ("input", "output"))
    parameters, places = _parameters(description, diagnostics)
    if own_step is not None:
        _check_method(sources, diagnostics)
        parameters = _values_of_sources(parameters, sources, diagnostics)
    if step is None or diagnostics.error_count > before:
        return None
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
        directory=settings.beside.parent if settings.beside is not None else path,
        files=tuple(sorted({*files.on_disk(sources.names), *filter(None, [settings.beside])})),
        span=description.span,
        searched=files.listed,
        considered=files.considered,
        code=_export(files, description, sources, own_step, places, settings),
    )


def _description(files: FmuFiles, diagnostics: Diagnostics) -> FmuDescription | None:
    whole = Span(str(files.path(DESCRIPTION)))
    root = parse_xml(files.contents[DESCRIPTION], whole, diagnostics, hint=_HINT, shown=files.archive)
    return read_description(root, diagnostics) if root is not None else None


def _export(
    files: FmuFiles,
    description: FmuDescription,
    sources: FmuSources,
    own_step: Fraction | None,
    parameters: tuple[FmuParameter, ...],
    settings: FmuSettings,
) -> FmuExport:
    """The data that the access to an FMU without mistakes needs."""
    standard, linked = description.standard, sources.linked
    variables = _global_memory(linked) if own_step is not None else ()
    states = {variable.reference: variable.count for variable in description.variables if variable.state}
    renames, conditional_renames = _renames(sources)
    return FmuExport(
        standard=standard,
        tool=description.tool,
        guid=description.guid,
        instance_name=_ascii(description.name),
        linked=linked,
        root=files.root,
        units=sources.units,
        include_dirs=sources.include_dirs,
        packed=tuple((name, sources.text(name)) for name in sources.names) if files.archive else (),
        headers=tuple(name for name in FMI_HEADERS[standard] if name not in sources.own_headers),
        definitions=tuple({**dict(sources.definitions), **dict(settings.definitions)}.items()),
        renames=renames,
        conditional_renames=conditional_renames,
        prefixes=_prefixes(linked, description.identifier),
        plain_names=not _names_by_header(standard, sources),
        inputs=_groups(description, "input"),
        outputs=_groups(description, "output"),
        parameters=parameters,
        states=tuple(sorted(states)),
        state_count=sum(states.values()),
        variables=variables,
        own_step=own_step,
        threads=any({"__thread", "_Thread_local"} & code.identifiers for code in sources.codes.values()),
        terminated="fmi2GetBooleanStatus" in {function.name for _, function in linked.functions()},
        heap=settings.heap if uses_heap(sources.codes.values()) else 0,
        several=not description.once and not variables,
    )


def _own_step(description: FmuDescription, sources: FmuSources) -> Fraction | None:
    """The step of the integration method of an FMU of 20-sim, in seconds.  None for other FMUs.

    The sources set it: ``xx_step_size = 0.001`` in version 4.5, ``model_instance->step_size = 0.001`` in later ones.
    If they do not set exactly one value, it is the step of the description.
    """
    if not _is_of_20sim(description, sources):
        return None
    steps = set()
    for code in sources.codes.values():
        for match in _STEP_SIZE.finditer(code.file.code):
            value = exact_number(match[2])
            if value is not None and is_step(value) and not re.search("initial|max|min", match[1] or ""):
                steps.add(value)
    return steps.pop() if len(steps) == 1 else description.step


def _is_of_20sim(description: FmuDescription, sources: FmuSources) -> bool:
    """True for an FMU of 20-sim, also if another program has written its description."""
    by_name = any(function.name.endswith("CalculateSubmodel") for _, function in sources.linked.functions())
    return description.standard == 2 and (description.is_20sim or by_name)


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
    description: FmuDescription,
    own_step: Fraction | None,
    settings: FmuSettings,
    diagnostics: Diagnostics,
    macros: tuple[str, ...] = (),
) -> Fraction | None:
    """The time between two steps of the model, in seconds.  None if there is none, or if the FMU cannot make it.

    ``macros`` are those that the model.yaml must define, too.
    """
    step = settings.step or description.step
    if step is None:
        _report_no_step(description, macros, diagnostics)
        return None
    base = description.internal_step or own_step
    message, hint = "", "export the FMU with the step of the target"
    if base is not None and (step / base).denominator != 1:
        message = f"the step {float(step):g} s is not a multiple of the FMU's internal step, {float(base):g} s"
        if settings.step is not None:
            multiple = show(max(1, round(step / base)) * base, "time", digits=17)
            hint = f"write a multiple of it, such as 'step: {multiple}', or {hint}"
    elif own_step is not None and step / own_step > _MOST_CALLS:
        needs = f"the step {float(step):g} s needs more than {_MOST_CALLS} internal steps of the FMU"
        message = f"{needs}, {float(own_step):g} s each"
    if message:
        diagnostics.error("fmu-step", settings.step_span or description.step_span, message, hint=hint)
        return None
    return step


def _report_no_step(description: FmuDescription, macros: tuple[str, ...], diagnostics: Diagnostics) -> None:
    if any(item.id == "fmu-step" for item in diagnostics):
        return  # the FMU has a step that is not a number, which is already reported
    message = "the FMU does not set its step: there is no stepSize in its DefaultExperiment"
    keys = "'fmu: <its file or folder>' and 'step: 1 ms'"
    if macros:
        keys = f"'fmu: <its file or folder>', 'step: 1 ms' and 'definitions: {{{macros[0]}: 1}}'"
    hint = f"write a model.yaml with 'version: 1', {keys}, and name this file as the model"
    diagnostics.error("fmu-step", description.step_span, message, hint=hint)


# ports and parameters ------------------------------------------------------------------------------------------------


def _ports(description: FmuDescription, direction: str, diagnostics: Diagnostics) -> tuple[Port, ...]:
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


def _groups(description: FmuDescription, direction: str) -> tuple[FmuPorts, ...]:
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


def _parameters(
    description: FmuDescription, diagnostics: Diagnostics
) -> tuple[tuple[Parameter, ...], tuple[FmuParameter, ...]]:
    """The scalar parameters whose start value is a number, tunable ones first.  Others keep their start values."""
    settable = [v for v in description.variables if v.causality == "parameter" and not v.dimensions]
    chosen = [(variable, value) for variable in settable if (value := number(variable.start)) is not None]
    _report_unknown([variable for variable in settable if number(variable.start) is None], diagnostics)
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


def _report_unknown(unknown: list[FmuVariable], diagnostics: Diagnostics) -> None:
    """Reports, as a note, the parameters that EPG cannot set, because their start values are no numbers."""
    if not unknown:
        return
    names = ", ".join(f"'{variable.name[:80]}'" for variable in unknown[:8])
    more = f" and {len(unknown) - 8} more" if unknown[8:] else ""
    each = "these parameters" if unknown[1:] else "this parameter"
    message = f"EPG cannot set {names}{more}: modelDescription.xml has no number as the start value of {each}"
    hint = 'the FMU uses its own value; to set another one, add start="..." with a number to modelDescription.xml'
    diagnostics.note("fmu-no-parameter", unknown[0].span, message, hint=hint)


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


def _renames(sources: FmuSources) -> tuple[tuple[str, ...], tuple[tuple[str, tuple[str, ...]], ...]]:
    """The global symbols of the FMU, including the functions of FMI.

    First those that are always defined, then those that are defined under a condition, such as a ``time()`` for
    Windows: if it were renamed for other compilers, too, the function of the C library would be called by that name.
    """
    conditions = _conditions(sources)
    names = set(_identifiers(conditions.keys() - sources.linked.macro_names()))
    always = {name for name in names if conditions[name] == YES or (conditions[name] == OPEN and name not in KNOWN)}
    groups: dict[str, list[str]] = {}
    for name in sorted(names - always):
        if conditions[name] != OPEN:
            groups.setdefault(conditions[name], []).append(name)
    return tuple(sorted(always)), tuple((condition, tuple(group)) for condition, group in sorted(groups.items()))


def _conditions(sources: FmuSources) -> dict[str, str]:
    """The global symbols of the FMU, each with the condition under which one of its definitions is compiled."""
    conditions: dict[str, str] = {}
    for name, code in sources.codes.items():
        symbols: list[Function | Variable] = [function for function in code.functions if not function.static]
        symbols += [variable for variable in code.variables if not variable.static and _is_defined(variable.type)]
        for symbol in symbols:
            known = conditions.get(symbol.name, NO)
            conditions[symbol.name] = either(known, sources.condition(name, symbol.start))
    return conditions


def _is_defined(type: str) -> bool:
    return type not in ("extern", "struct", "union", "enum")


def _identifiers(names: Iterable[str]) -> list[str]:
    return [name for name in names if name.isascii() and name.isidentifier() and name not in ("main", "defined")]


def _ascii(text: str) -> str:
    return one_line(text).encode("ascii", "replace").decode("ascii") or "model"
