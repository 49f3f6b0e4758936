"""``modelDescription.xml`` of FMI 2.0 and 3.0: what an FMU offers, and whether a target can use it."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from epg.diagnostics import Diagnostics
from epg.load.models.assignments import exact_number, is_step
from epg.load.models.identifiers import one_line
from epg.load.models.xml_file import Element
from epg.source import Span

#: types of variables that have a number, and what a port of that type is called (FMI 2.0.4, 2.2.7)
TYPES_2 = {"Real": "real", "Integer": "integer", "Enumeration": "integer", "Boolean": "boolean"}
TYPES_3 = {
    "Float64": "real",
    "Float32": "real",
    **{f"{sign}Int{bits}": "integer" for sign in ("", "U") for bits in (8, 16, 32, 64)},
    "Enumeration": "integer",
    "Boolean": "boolean",
}
_NUMBERED = {False: "Integer", True: "Int64"}  # how enumerations of FMI 2.0 and 3.0 are get and set
_NO_NUMBERS = ("String", "Binary", "Clock")
_LARGEST_ARRAY = 256
_LARGEST_VARIABLES = 100_000


@dataclass(frozen=True)
class Variable:
    """A scalar, or an array of FMI 3.0 with constant ``dimensions``.

    ``type`` is the standard's name: "Real", "Float64", ...; ``state`` tells that the FMU integrates it.
    """

    name: str
    reference: int
    causality: str
    variability: str
    type: str
    dimensions: tuple[int, ...]
    start: str
    unit: str
    description: str
    state: bool
    span: Span

    @property
    def count(self) -> int:
        return math.prod(self.dimensions)

    def element_names(self) -> list[str]:
        """``x``; of an array ``x[1]``, ``x[2]``, or ``x[1,1]``, ... in the order of its values: row by row."""
        names = [""]
        for size in self.dimensions:
            names = [f"{before},{index}" if before else str(index) for before in names for index in range(1, size + 1)]
        return [f"{self.name}[{name}]" for name in names] if self.dimensions else [self.name]


@dataclass(frozen=True)
class Description:
    """What the rest of EPG needs of the description.  ``standard`` is 2 or 3, ``step`` None when there is none.

    ``sources`` are the files of ``<SourceFiles>`` of FMI 2.0, each with its position; None when there is no such list.
    """

    standard: int
    version: str
    name: str
    guid: str
    tool: str
    identifier: str
    once: bool
    step: Fraction | None
    step_span: Span
    internal_step: Fraction | None
    variables: tuple[Variable, ...]
    sources: tuple[tuple[str, Span], ...] | None
    span: Span

    @property
    def is_20sim(self) -> bool:
        return self.tool.startswith("20-sim")


def read_description(root: Element, diagnostics: Diagnostics) -> Description | None:
    """The description, or None after reporting why this FMU cannot be a model."""
    version = root.attributes.get("fmiVersion", "")
    match = re.match(r"([23])\.", version)
    if root.name != "fmiModelDescription" or match is None:
        message = "this is no description of an FMU"
        if root.name == "fmiModelDescription":
            message = f"this FMU is of FMI {one_line(version)[:20] or 'unknown'}: EPG reads FMI 2.0 and 3.0"
        diagnostics.error("fmu-version", root.span, message, hint="export it as FMI 2.0 or 3.0 for co-simulation")
        return None
    standard = int(match[1])
    interface = root.find("CoSimulation")
    if interface is None:
        others = [name for name in ("ModelExchange", "ScheduledExecution") if root.find(name) is not None]
        message = f"this FMU is for {' and '.join(others) or 'nothing'} only: it does not integrate its own equations"
        diagnostics.error("fmu-interface", root.span, message, hint="export it for co-simulation")
        return None
    if _flag(interface, "needsExecutionTool"):
        message = "this FMU runs inside the program that made it (needsExecutionTool)"
        diagnostics.error("fmu-needs-tool", interface.span, message, hint="export it stand-alone, with sources")
        return None
    identifier = interface.attributes.get("modelIdentifier", "")
    experiment = root.find("DefaultExperiment")
    step_span = experiment.span if experiment is not None else root.span
    step = _time(experiment, "stepSize", diagnostics)
    internal = _time(interface, "fixedInternalStepSize", diagnostics)
    variables = _variables_2(root, diagnostics) if standard == 2 else _variables_3(root, diagnostics)
    guid = root.attributes.get("guid" if standard == 2 else "instantiationToken", "")
    return Description(
        standard=standard,
        version=one_line(version)[:20],
        name=one_line(root.attributes.get("modelName", "") or identifier or "FMU"),
        guid=guid,
        tool=one_line(root.attributes.get("generationTool", "")),
        identifier=identifier,
        once=_flag(interface, "canBeInstantiatedOnlyOncePerProcess"),
        step=step or internal,
        step_span=step_span,
        internal_step=internal,
        variables=variables,
        sources=_sources_2(interface) if standard == 2 else None,
        span=root.span,
    )


def _flag(element: Element, name: str) -> bool:
    return element.attributes.get(name, "").strip() in ("true", "1")


def _time(element: Element | None, name: str, diagnostics: Diagnostics) -> Fraction | None:
    text = element.attributes.get(name) if element is not None else None
    if element is None or text is None:
        return None
    value = exact_number(text.strip())
    if value is None or not is_step(value):
        message = f"{name} is '{one_line(text)[:40]}', which is no step in seconds"
        diagnostics.error("fmu-step", element.span, message, hint="steps are from 1 ns to 1000000 s")
        return None
    return value


def _sources_2(interface: Element) -> tuple[tuple[str, Span], ...] | None:
    """``<SourceFiles>`` of FMI 2.0.4, 4.3.1: names relative to ``sources``."""
    listed = interface.find("SourceFiles")
    if listed is None:
        return None
    return tuple((file.attributes.get("name", ""), file.span) for file in listed.children if file.name == "File")


# variables -----------------------------------------------------------------------------------------------------------


def _units_of_types(root: Element, standard: int) -> dict[str, str]:
    """Units of the types that variables may refer to by name: ``<TypeDefinitions>``."""
    definitions = root.find("TypeDefinitions")
    units: dict[str, str] = {}
    for item in definitions.children if definitions is not None else ():
        holder = item.find("Real") if standard == 2 else item
        if holder is not None:
            units[item.attributes.get("name", "")] = holder.attributes.get("unit", "")
    return units


def _variables_2(root: Element, diagnostics: Diagnostics) -> tuple[Variable, ...]:
    units = _units_of_types(root, 2)
    elements = _listed(root, diagnostics)
    states: set[int] = set()  # positions in the list, from 0
    for element in elements:
        real = element.find("Real")
        derivative = real.attributes.get("derivative", "") if real is not None else ""
        if derivative.isdecimal():
            states.add(int(derivative) - 1)
    found = []
    for position, element in enumerate(elements):
        typed = next((child for child in element.children if child.name in (*TYPES_2, *_NO_NUMBERS)), None)
        variable = _variable(element, typed, (), units, position in states, diagnostics)
        if variable is not None:
            found.append(variable)
    return tuple(found)


def _variables_3(root: Element, diagnostics: Diagnostics) -> tuple[Variable, ...]:
    units = _units_of_types(root, 3)
    elements = _listed(root, diagnostics)
    states = {element.attributes["derivative"] for element in elements if "derivative" in element.attributes}
    found = []
    for element in elements:
        if element.name not in (*TYPES_3, *_NO_NUMBERS):
            continue
        dimensions = _dimensions(element, diagnostics)
        state = element.attributes.get("valueReference") in states
        if dimensions is not None:
            variable = _variable(element, element, dimensions, units, state, diagnostics)
            if variable is not None:
                found.append(variable)
    return tuple(found)


def _listed(root: Element, diagnostics: Diagnostics) -> list[Element]:
    listed = root.find("ModelVariables")
    elements = listed.children if listed is not None else []
    if len(elements) > _LARGEST_VARIABLES:
        message = f"the FMU has more than {_LARGEST_VARIABLES} variables"
        diagnostics.error("fmu-variable", root.span, message, hint="export the controller alone")
        return []
    return elements


def _dimensions(element: Element, diagnostics: Diagnostics) -> tuple[int, ...] | None:
    """The sizes of an array; None after reporting one that is not constant, or too large, where it is a port."""
    sizes = []
    for dimension in element.children:
        if dimension.name == "Dimension":
            start = dimension.attributes.get("start", "")
            sizes.append(int(start) if re.fullmatch(r"\d{1,6}", start) else 0)
    if all(sizes) and math.prod(sizes) <= _LARGEST_ARRAY:
        return tuple(sizes)
    if element.attributes.get("causality") in ("input", "output"):
        name = one_line(element.attributes.get("name", ""))
        message = f"'{name}' is an array " + (
            f"of more than {_LARGEST_ARRAY} values" if all(sizes) else "without a size"
        )
        hint = "give it a constant size ('start' of its dimensions), or export its elements one by one"
        diagnostics.error("fmu-variable", element.span, message, hint=hint)
    return None


def _variable(
    element: Element,
    typed: Element | None,
    dimensions: tuple[int, ...],
    units: Mapping[str, str],
    state: bool,
    diagnostics: Diagnostics,
) -> Variable | None:
    """A variable that is a number, or None: then it was reported if it is a port."""
    attributes = element.attributes
    name = one_line(attributes.get("name", ""))
    causality = attributes.get("causality", "local")
    is_port = causality in ("input", "output")
    reference = attributes.get("valueReference", "")
    if typed is None or typed.name in _NO_NUMBERS:
        if is_port:
            what = typed.name if typed is not None else "no type"
            message = f"{causality} '{name}' is of type {what}: ports are numbers"
            diagnostics.error("fmu-variable", element.span, message, hint="export it without this variable")
        return None
    if not name or not re.fullmatch(r"\d{1,10}", reference) or int(reference) >= 1 << 32:
        if is_port:
            message = f"{causality} '{name}' has no name or no value reference"
            diagnostics.error("fmu-variable", element.span, message, hint="export the FMU again")
        return None
    unit = typed.attributes.get("unit", "") or units.get(typed.attributes.get("declaredType", ""), "")
    return Variable(
        name=name,
        reference=int(reference),
        causality=causality,
        variability=attributes.get("variability", "continuous"),
        type=_NUMBERED[typed is element] if typed.name == "Enumeration" else typed.name,
        dimensions=dimensions,
        start=typed.attributes.get("start", "").strip(),
        unit=one_line(unit),
        description=one_line(attributes.get("description", "")),
        state=state and typed.name in ("Real", "Float64") and not dimensions,
        span=element.span,
    )
