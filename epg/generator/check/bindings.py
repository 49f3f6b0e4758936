# SPDX-License-Identifier: Apache-2.0
"""Reads a bindings file, which assigns component ports to model ports.

The file is checked alone here.  :mod:`epg.generator.resolve.wires` compares it with the model and the components.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from types import MappingProxyType

from epg.generator.check.motors import Motor, motors_of
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.items import text_of
from epg.generator.documents.schema import load_schema, validate
from epg.generator.documents.text_file import NO_DRAFTS, Drafts
from epg.generator.documents.yaml_file import load_yaml
from epg.generator.quantity import QuantityError, parse_ratio
from epg.generator.source import Span, YamlNode

UNCONNECTED = "unconnected"


@dataclass(frozen=True)
class Conversion:
    """``value * scale + offset``, then limited to ``limits``.  Attributes that are not stated are None.

    ``unit`` is the unit on the model's side.  ``span`` is the position of the first attribute that is stated.
    """

    scale: Fraction | None = None
    offset: float | None = None
    limits: tuple[float, float] | None = None
    unit: str | None = None
    span: Span | None = None


@dataclass(frozen=True)
class Follows:
    """The model input that a setpoint follows: enabling begins at its measured value."""

    port: str
    span: Span


@dataclass(frozen=True)
class Binding:
    """One end of a wire with its conversion: ``component.port``, or ``component`` (then ``port`` is None)."""

    component: str
    port: str | None
    conversion: Conversion
    span: Span
    follows: Follows | None = None


@dataclass(frozen=True)
class ParameterSetting:
    """What a bindings file states about a parameter of the model.

    ``value`` is None if the exported value stays.  A limit that is not stated is infinite.  ``span`` is the position of
    the parameter's name.
    """

    value: float | None
    minimum: float
    maximum: float
    description: str
    span: Span


@dataclass(frozen=True)
class Bindings:
    """A bindings file.  ``inputs`` and ``outputs`` map model ports to the position of the name, and the bindings.

    ``motors`` are those of a plant.
    """

    path: Path
    model: str
    model_span: Span
    inputs: Mapping[str, tuple[Span, Binding]]
    outputs: Mapping[str, tuple[Span, tuple[Binding, ...]]]  # empty tuple: unconnected on purpose
    parameters: Mapping[str, ParameterSetting]
    motors: Mapping[str, Motor]
    root: YamlNode


def load_bindings(
    path: Path,
    diagnostics: Diagnostics,
    wanted_by: Span | None = None,
    drafts: Drafts = NO_DRAFTS,
    model_name: str | None = None,
) -> Bindings | None:
    """The bindings in ``path`` of the model with this name, if it is known; None after reporting mistakes."""
    node = load_yaml(path, diagnostics, wanted_by, drafts)
    if node is None:
        return None
    if not node.is_mapping:
        span = Span(str(path), 1, 1, 2)
        diagnostics.error(
            "wrong-type", span, "bindings must be a map (key: value)", hint="'epg bind' writes such a file"
        )
        return None
    if "model" not in node and ("components" in node or "extends" in node):
        span = node.key_span("components" if "components" in node else "extends")
        message = "this is a target configuration, not bindings"
        hint = "name this file by TCF or --tcf, and the bindings by BINDINGS or --bindings"
        diagnostics.error("bindings-are-tcf", span, message, hint=hint)
        return None
    known = {"model": model_name} if model_name else {}
    if not validate(node, load_schema("bindings"), diagnostics, known=known):
        return None
    model = node["model"]
    before = diagnostics.error_count
    bindings = Bindings(
        path=path,
        model=str(model.value),
        model_span=model.span,
        inputs=MappingProxyType(dict(_inputs(node, diagnostics))),
        outputs=MappingProxyType(dict(_outputs(node, diagnostics))),
        parameters=MappingProxyType(dict(_parameters(node, diagnostics))),
        motors=motors_of(node, diagnostics),
        root=node,
    )
    return bindings if diagnostics.error_count == before else None


def conversion_of(node: YamlNode, diagnostics: Diagnostics) -> Conversion:
    """The conversion that the keys ``scale``, ``offset``, ``limits`` and ``unit`` of a map state; reports mistakes."""
    scale, offset, limits, unit = (node.get(key) for key in ("scale", "offset", "limits", "unit"))
    factor = _scale(scale, diagnostics) if scale is not None else None
    for number in (offset, *(limits.elements() if limits else ())):
        if number is not None and isinstance(number.value, float) and not math.isfinite(number.value):
            diagnostics.error("wrong-value", number.span, "this number must be finite")
    return Conversion(
        scale=factor,
        offset=_float(offset) if offset is not None else None,
        limits=_limits(limits, diagnostics) if limits is not None else None,
        unit=str(unit.value) if unit is not None else None,
        span=next((part.span for part in (scale, offset, limits, unit) if part is not None), None),
    )


def _scale(node: YamlNode, diagnostics: Diagnostics) -> Fraction | None:
    """The factor of a conversion.  Reports a wrong ratio: then it is None; and 0."""
    try:
        factor = parse_ratio(node.value)
    except QuantityError as problem:
        diagnostics.error("wrong-value", node.span, str(problem), hint=problem.hint)
        return None
    if factor == 0:
        diagnostics.error("wrong-value", node.span, "a scale of 0 makes every value the same")
    return factor


def _limits(node: YamlNode, diagnostics: Diagnostics) -> tuple[float, float]:
    """The limits of a conversion.  Reports that they are not a range."""
    low, high = (_float(element) for element in node.elements())
    if low >= high:
        message = f"limits [{low:g}, {high:g}] are not a range"
        diagnostics.error("wrong-value", node.span, message, hint="write [lowest, highest]")
    return low, high


def _inputs(node: YamlNode, diagnostics: Diagnostics) -> list[tuple[str, tuple[Span, Binding]]]:
    section = node.get("inputs")
    if section is None:
        return []
    return [(name, (section.key_span(name), _binding(value, "from", diagnostics))) for name, value in section.items()]


def _outputs(node: YamlNode, diagnostics: Diagnostics) -> list[tuple[str, tuple[Span, tuple[Binding, ...]]]]:
    section = node.get("outputs")
    if section is None:
        return []
    result = []
    for name, value in section.items():
        ends = value.elements() if value.is_sequence else (value,)
        wires = tuple(_binding(end, "to", diagnostics) for end in ends if end.value != UNCONNECTED)
        result.append((name, (section.key_span(name), wires)))
    return result


def _binding(node: YamlNode, key: str, diagnostics: Diagnostics) -> Binding:
    reference = node[key] if node.is_mapping else node
    component, _, port = str(reference.value).partition(".")
    conversion = conversion_of(node, diagnostics) if node.is_mapping else Conversion()
    stated = node.get("follows") if node.is_mapping else None
    follows = Follows(str(stated.value), stated.span) if stated is not None else None
    return Binding(component, port or None, conversion, reference.span, follows)


def _parameters(node: YamlNode, diagnostics: Diagnostics) -> list[tuple[str, ParameterSetting]]:
    section = node.get("parameters")
    if section is None:
        return []
    return [(name, _setting(section.key_span(name), value, diagnostics)) for name, value in section.items()]


def _setting(span: Span, node: YamlNode, diagnostics: Diagnostics) -> ParameterSetting:
    """The setting of one parameter: a number, or a map.  Reports numbers that do not fit together."""
    if not node.is_mapping:
        return ParameterSetting(_finite(node, diagnostics), -math.inf, math.inf, "", span)
    value, minimum, maximum = (
        _finite(found, diagnostics) if (found := node.get(key)) is not None else None
        for key in ("value", "minimum", "maximum")
    )
    low = -math.inf if minimum is None else minimum
    high = math.inf if maximum is None else maximum
    if low > high:
        message = f"the minimum {low:g} is greater than the maximum {high:g}"
        diagnostics.error("wrong-value", node["minimum"].span, message)
    elif value is not None and not low <= value <= high:
        message = f"the value {value:g} is outside of its limits"
        range_ = f"of at least {low:g}" if high == math.inf else f"of at most {high:g}" if low == -math.inf else ""
        hint = f"write a value {range_ or f'from {low:g} to {high:g}'}, or other limits"
        diagnostics.error("out-of-range", node["value"].span, message, hint=hint)
    return ParameterSetting(value, low, high, text_of(node, "description"), span)


def _finite(node: YamlNode, diagnostics: Diagnostics) -> float:
    value = _float(node)
    if not math.isfinite(value):
        diagnostics.error("wrong-value", node.span, "this number must be finite")
        return 0.0
    return value


def _float(node: YamlNode) -> float:
    value = node.value
    assert isinstance(value, (int, float))
    try:
        return float(value)
    except OverflowError:
        return math.inf
