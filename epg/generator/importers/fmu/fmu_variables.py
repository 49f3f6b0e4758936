# SPDX-License-Identifier: Apache-2.0
"""Reads the variables of an FMU from its ``modelDescription.xml``."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.documents.text_file import one_line
from epg.generator.documents.xml_file import Element
from epg.generator.source import Span

#: types of variables that are numbers (FMI 2.0.4, section 2.2.7), with the type of a port for each
TYPES_2 = {"Real": "real", "Integer": "integer", "Enumeration": "integer", "Boolean": "boolean"}
TYPES_3 = {
    "Float64": "real",
    "Float32": "real",
    **{f"{sign}Int{bits}": "integer" for sign in ("", "U") for bits in (8, 16, 32, 64)},
    "Enumeration": "integer",
    "Boolean": "boolean",
}
_NUMBERED = {False: "Integer", True: "Int64"}  # types whose functions get and set enumerations, in FMI 2.0 and 3.0
_TEXT = ("String", "Binary")
_NO_NUMBERS = (*_TEXT, "Clock")
_LARGEST_ARRAY = 256
_LARGEST_VARIABLES = 100_000


@dataclass(frozen=True)
class FmuVariable:
    """A scalar, or an array of FMI 3.0.  Its ``dimensions`` are constant, because EPG never changes them.

    ``type`` is the name in the standard: "Real", "Float64", ...  ``state`` is True for a continuous state, which the
    FMU integrates.  ``limits`` are the lowest and the highest item of an enumeration.
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
    limits: tuple[int, int] | None
    span: Span

    @property
    def count(self) -> int:
        return math.prod(self.dimensions)

    def element_names(self) -> list[str]:
        """The names of the values, in their order: ``x``, or ``x[1]``, ``x[2]``, ..., or row by row ``x[1,1]``, ..."""
        names = [""]
        for size in self.dimensions:
            names = [f"{before},{index}" if before else str(index) for before in names for index in range(1, size + 1)]
        return [f"{self.name}[{name}]" for name in names] if self.dimensions else [self.name]


def read_variables(root: Element, standard: int, diagnostics: Diagnostics) -> tuple[FmuVariable, ...]:
    """All variables that are numbers.  Reports inputs and outputs that cannot be ports."""
    units, limits = _types(root, standard)
    elements = _listed(root, diagnostics)
    candidates = _candidates_2(elements) if standard == 2 else _candidates_3(elements, diagnostics)
    made = (_variable(*candidate, units, limits, diagnostics) for candidate in candidates)
    variables = tuple(variable for variable in made if variable is not None)
    _check_references(variables, standard, diagnostics)
    if standard == 3:
        _report_aliases(elements, diagnostics)
    return variables


def _types(root: Element, standard: int) -> tuple[dict[str, str], dict[str, tuple[int, int]]]:
    """The units, and the lowest and highest items of enumerations, of the types in ``<TypeDefinitions>`` by name."""
    definitions = root.find("TypeDefinitions")
    units: dict[str, str] = {}
    limits: dict[str, tuple[int, int]] = {}
    for item in definitions.children if definitions is not None else ():
        name = item.attributes.get("name", "")
        real, enumeration = (item.find("Real"), item.find("Enumeration")) if standard == 2 else (item, item)
        if real is not None:
            units[name] = real.attributes.get("unit", "")
        items = [child for child in enumeration.children if child.name == "Item"] if enumeration is not None else []
        texts = [child.attributes.get("value", "") for child in items]
        values = [int(text) for text in texts if re.fullmatch(r"-?\d{1,9}", text)]
        if values:
            limits[name] = min(values), max(values)
    return units, limits


def _candidates_2(elements: list[Element]) -> Iterator[tuple[Element, Element | None, tuple[int, ...], bool]]:
    """Each variable of FMI 2.0: its element, the one with its type, its dimensions, and True if it is a state."""
    states: set[int] = set()  # positions in the list, from 0
    for element in elements:
        real = element.find("Real")
        derivative = real.attributes.get("derivative", "") if real is not None else ""
        if derivative.isdecimal():
            states.add(int(derivative) - 1)
    for position, element in enumerate(elements):
        typed = next((child for child in element.children if child.name in (*TYPES_2, *_NO_NUMBERS)), None)
        yield element, typed, (), position in states


def _candidates_3(
    elements: list[Element], diagnostics: Diagnostics
) -> Iterator[tuple[Element, Element | None, tuple[int, ...], bool]]:
    """The same for FMI 3.0, in which the element of a variable has its type."""
    states = {element.attributes["derivative"] for element in elements if "derivative" in element.attributes}
    sizes = _sizes(elements)
    for element in elements:
        dimensions = _dimensions(element, sizes, diagnostics) if element.name in (*TYPES_3, *_NO_NUMBERS) else None
        if dimensions is not None:
            yield element, element, dimensions, element.attributes.get("valueReference") in states


def _listed(root: Element, diagnostics: Diagnostics) -> list[Element]:
    """The elements of all variables.  Empty, after an error, if there are too many."""
    listed = root.find("ModelVariables")
    elements = listed.children if listed is not None else []
    if len(elements) > _LARGEST_VARIABLES:
        message = f"the FMU has more than {_LARGEST_VARIABLES} variables"
        diagnostics.error("fmu-variable", root.span, message, hint="export the controller alone")
        return []
    return elements


def _check_references(variables: Iterable[FmuVariable], standard: int, diagnostics: Diagnostics) -> None:
    """Reports two inputs or parameters with one value reference: the FMU keeps only the value that is set last.

    In FMI 2.0, a reference is unique among the variables of a type, and variables that are only read may share it
    (FMI 2.0.4, section 2.2.7).  In FMI 3.0, each variable has its own (FMI 3.0.1, section 2.4.7).
    """
    first: dict[tuple[str, int], FmuVariable] = {}
    for variable in variables:
        if variable.causality not in ("input", "parameter"):
            continue
        other = first.setdefault((variable.type if standard == 2 else "", variable.reference), variable)
        if other is not variable:
            message = f"{variable.causality} '{variable.name}' has the value reference of {other.causality} "
            message += f"'{other.name}', {variable.reference}: each would overwrite the value of the other one"
            hint = "export the FMU again, with a separate value reference for each of them"
            notes = [Note(f"'{other.name}' is here", other.span)]
            diagnostics.error("fmu-same-reference", variable.span, message, hint=hint, notes=notes)


def _report_aliases(elements: Iterable[Element], diagnostics: Diagnostics) -> None:
    """Reports, as a note, the other names of ports and parameters (FMI 3.0.1, section 2.4.7): EPG uses the first."""
    aliases = [
        (f"'{_name(child)}' of '{_name(element)}'", child)
        for element in elements
        for child in element.children
        if child.name == "Alias" and element.attributes.get("causality") in ("input", "output", "parameter")
    ]
    if aliases:
        shown = ", ".join(text for text, _ in aliases[:8])
        message = f"EPG does not use other names of ports and parameters: {shown}"
        message += f" and {len(aliases) - 8} more" if aliases[8:] else ""
        diagnostics.note("fmu-alias", aliases[0][1].span, message, hint="write the first name in the bindings")


def _name(element: Element) -> str:
    return one_line(element.attributes.get("name", ""))[:80]


def _sizes(elements: Iterable[Element]) -> dict[str, str]:
    """The variables that can give an array its size, with their start values: structural parameters and constants.

    Both keep their start values.
    """
    return {
        element.attributes.get("valueReference", ""): element.attributes.get("start", "").strip()
        for element in elements
        if element.name == "UInt64"
        and (
            element.attributes.get("causality") == "structuralParameter"
            or element.attributes.get("variability") == "constant"
        )
    }


def _dimensions(element: Element, known: Mapping[str, str], diagnostics: Diagnostics) -> tuple[int, ...] | None:
    """The sizes of an array.  None if one is not constant or the array is too large; for a port, this is reported."""
    sizes = []
    for dimension in element.children:
        if dimension.name == "Dimension":
            start = dimension.attributes.get("start") or known.get(dimension.attributes.get("valueReference", ""), "")
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
    state: bool,
    units: Mapping[str, str],
    limits: Mapping[str, tuple[int, int]],
    diagnostics: Diagnostics,
) -> FmuVariable | None:
    """A variable that is a number.  None for other variables; if they are inputs or outputs, this is reported."""
    attributes = element.attributes
    name = one_line(attributes.get("name", ""))
    causality = attributes.get("causality", "local")
    is_port = causality in ("input", "output")
    reference = attributes.get("valueReference", "")
    if typed is None or typed.name in _NO_NUMBERS:
        if is_port:
            _report_no_number(element, typed, f"{causality} '{name}'", diagnostics)
        return None
    if not name or not re.fullmatch(r"\d{1,10}", reference) or int(reference) >= 1 << 32:
        if is_port:
            message = f"{causality} '{name}' has no name or no value reference"
            diagnostics.error("fmu-variable", element.span, message, hint="export the FMU again")
        return None
    declared = typed.attributes.get("declaredType", "")
    unit = typed.attributes.get("unit", "") or units.get(declared, "")
    return FmuVariable(
        name=name,
        reference=int(reference),
        causality=causality,
        variability=attributes.get("variability", "continuous"),
        type=_NUMBERED[typed is element] if typed.name == "Enumeration" else typed.name,
        dimensions=dimensions,
        start=typed.attributes.get("start", "").strip(),
        unit=one_line(unit),
        description=one_line(attributes.get("description", "")),
        state=state and typed.name in ("Real", "Float64"),
        limits=limits.get(declared) if typed.name == "Enumeration" else None,
        span=element.span,
    )


def _report_no_number(element: Element, typed: Element | None, port: str, diagnostics: Diagnostics) -> None:
    """Reports ``port``, an input or output that is not a number.  A warning if the FMU works without its value."""
    kind = typed.name if typed is not None else "no type"
    message = f"{port} is of type {kind}, which a port cannot have"
    is_input = element.attributes["causality"] == "input"
    if kind in _TEXT or (kind == "Clock" and not is_input):
        message += ": it keeps its start value" if is_input else ": it is not used"
        hint = "a port is a number: change the type if you need this port"
        diagnostics.warning("fmu-no-port", element.span, message, hint=hint)
    else:
        message += ": a port is a number"
        diagnostics.error("fmu-variable", element.span, message, hint="export the FMU without this variable")
