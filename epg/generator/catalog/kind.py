# SPDX-License-Identifier: Apache-2.0
"""Component kinds as data: ``components/<kind>/component.yaml`` in the folders of targets."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypeVar
from zlib import crc32

from epg.generator.dataclass import dataclass
from epg.generator.documents.items import elements_of, flag_of, map_of, text_map_of, text_of, texts_of, values_of
from epg.generator.source import Span, YamlNode

TEMPLATE = "code.c.j2"
"""The template of the code that a kind adds to generated files.  Middlewares can have such a template, too."""


Part = TypeVar("Part")

_BOUNDS = ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum")


@dataclass(frozen=True)
class KindParameter:
    """A parameter of a kind.  If ``type`` is "quantity", ``dimension`` is its dimension, such as "time"; else empty.

    ``default`` and ``bounds`` are kept as they are written, with units: ``20 kHz``.
    """

    name: str
    type: str  # "number", "integer", "boolean", "string", "ratio", "quantity", "names", "message", "fields" or "object"
    dimension: str
    description: str
    required: bool
    default: YamlNode | None
    bounds: Mapping[str, YamlNode]
    keywords: Mapping[str, Any]  # enum, pattern, minLength, examples, as in JSON Schema; x-below-zero, a hint
    aliases: Mapping[str, str]  # another way to write a value of enum -> that value
    properties: tuple[KindParameter, ...]
    span: Span


@dataclass(frozen=True)
class KindPort:
    """A port of a component.  A "source" gives values to the model, a "sink" takes values of the model.

    ``default``: a binding that names only the component means this port.
    ``actuator``: the port is made safe while the target is disabled.
    ``drive``: the value drives a motor.  The macro ``applied`` of the kind's template gives the present duty.
    ``boolean_with``: the port is boolean if the component's parameters have these values; else it has ``type``.
    ``integer_with``: the port gives whole numbers if the parameters have these values, so integer inputs can take it.
    ``words``: words in the names of model ports that belong to such a port (:mod:`epg.generator.resolve.matching`).
    ``quantities``: words that count like ``words`` if no other word of the name does: a setpoint is a position, too.
    ``stop_words``: words in the names of components that probably stop the robot.
    ``each``: the parameter with a list of names, or with a message; a component has one such port for each name, or for
    each number of the message.  A component's own kind (:meth:`Kind.of_component`) has a port for each ``element``
    instead, and ``part`` is the name of the port in the original kind.
    """

    name: str
    direction: str
    type: str  # "real" or "boolean"
    unit: str
    default: bool
    actuator: bool
    drive: bool
    description: str
    each: str = ""
    element: str = ""
    part: str = ""
    boolean_with: Mapping[str, str] = field(default_factory=dict)
    integer_with: Mapping[str, str] = field(default_factory=dict)
    words: tuple[str, ...] = ()
    quantities: tuple[str, ...] = ()
    stop_words: tuple[str, ...] = ()

    def of_component(self, parameters: Mapping[str, object]) -> KindPort:
        """The port of a component with these ``parameters``, which can decide its type."""
        conditions = self.boolean_with.items()
        boolean = conditions and all(parameters[key] == text for key, text in conditions)
        return replace(self, type="boolean") if boolean else self

    def of_element(self, element: str, alone: bool) -> KindPort:
        """The port for one element of :attr:`each`, which has other ports unless it is ``alone``."""
        name = element if alone else f"{element}.{self.name}"
        return replace(self, name=name, each="", element=element, part=self.name)


@dataclass(frozen=True)
class KindUse:
    """A reference of a component to a port of another component, or to a component that is a ``topic``.

    ``direction``, ``unit`` and ``drive`` restrict the possible ports; an empty text, or False, allows any port.
    """

    name: str
    direction: str
    unit: str
    drive: bool
    topic: bool
    required: bool
    description: str
    examples: tuple[object, ...]


@dataclass(frozen=True)
class NeedsBound:
    """A rule: the parameter ``key`` is allowed only if a model drives ``port`` of the component that ``use`` names."""

    key: str
    use: str
    port: str


@dataclass(frozen=True)
class KindAxis:
    """The axis that a component guards: the component that its use ``sensor`` names measures it.

    The axis stays nearer to the parameter ``zero`` of this sensor than ``travel``, a part of a parameter of the guard.
    """

    sensor: str
    travel: str
    zero: str


@dataclass(frozen=True)
class KindClaim:
    """A claim of each component of a kind.

    ``signals`` maps signals of the resource class to names of pins, ``attributes`` maps attributes to parameters, or
    to parts of parameters: ``span.angle``.  If
    ``output``, the pins are outputs that have a safe level.
    """

    name: str
    resource_class: str
    output: bool
    signals: Mapping[str, str]
    attributes: Mapping[str, str]
    span: Span


@dataclass(frozen=True)
class KindFault:
    """A fault that disables the target.  ``number`` is its ``epg_fault_t`` in C."""

    name: str
    number: int
    description: str
    remedy: str
    span: Span


@dataclass(frozen=True)
class Kind:
    """A kind of component.  ``headers`` and ``sources`` are files in ``folder``."""

    name: str
    group: str  # "motion", "input", "output", "communication", "safety", or empty
    summary: str
    communication: str | None  # "subscribe", "publish", "echo" or None
    transport: bool  # True if ``communication: {transport: ...}`` can name components of this kind
    pins: tuple[str, ...]
    parameters: tuple[KindParameter, ...]
    uses: tuple[KindUse, ...]
    exactly_one: tuple[tuple[str, ...], ...]
    at_least_one: tuple[tuple[str, ...], ...]
    at_most_one: tuple[tuple[str, ...], ...]
    only_with: tuple[tuple[str, str], ...]  # (key, the key that it needs)
    needs_bound: tuple[NeedsBound, ...]
    axis: KindAxis | None  # None: it guards no axis
    ports: tuple[KindPort, ...]
    claims: tuple[KindClaim, ...]
    faults: tuple[KindFault, ...]
    safe_states: tuple[Mapping[str, str], ...]  # claim -> "low" or "high"; safe for any level of the other claims
    headers: tuple[str, ...]
    sources: tuple[str, ...]
    node: YamlNode
    folder: Path
    span: Span

    def main_port(self, direction: str) -> KindPort | None:
        """The port that a binding means if it names the component only: the default port, or the only port."""
        found = [port for port in self.ports if port.direction == direction and (port.default or len(self.ports) == 1)]
        return found[0] if found else None

    def reference(self, component: str, port: KindPort) -> str:
        """The text for a port of ``component`` in bindings.  The component's name alone means its main port."""
        return component if port == self.main_port(port.direction) else f"{component}.{port.name}"

    def of_component(self, parameters: Mapping[str, object]) -> Kind:
        """The kind with the ports of a component that has these ``parameters``.

        A port with ``each`` becomes one port for each name of the list.  If the kind has one such port, the name of the
        element is the name of the port: ``pan``.  If it has several, the names are such as ``pan.position``.
        """
        if not any(port.each or port.boolean_with for port in self.ports):
            return self
        ports = [port.of_component(parameters) for port in self._ports_with("")]
        for each in dict.fromkeys(port.each for port in self.ports if port.each):
            stated = parameters[each]  # a list of names, or a message with the names of its numbers
            elements = stated if isinstance(stated, tuple) else getattr(stated, "names", ())
            parts = self._ports_with(each)
            ports += [port.of_element(element, len(parts) == 1) for element in elements for port in parts]
        return replace(self, ports=tuple(ports))

    def _ports_with(self, each: str) -> list[KindPort]:
        """The ports that a component has for ``each`` element of a parameter; for "", those that it has once."""
        return [port for port in self.ports if port.each == each]

    def shown_port(self, port: KindPort) -> str:
        """The name of a kind's port in messages: ``position``, or ``<joints>.position`` if each joint has this port."""
        if not port.each:
            return port.name
        alone = len(self._ports_with(port.each)) == 1
        return f"<{port.each}>" if alone else f"<{port.each}>.{port.name}"

    @property
    def topic_ports(self) -> tuple[KindPort, ...]:
        """The ports whose values travel as a topic."""
        direction = {"subscribe": "source", "publish": "sink"}.get(self.communication or "")
        return tuple(port for port in self.ports if port.direction == direction)

    @property
    def topic_parameters(self) -> tuple[str, ...]:
        """The parameters that name topics."""
        return {"subscribe": ("topic",), "publish": ("topic",), "echo": ("from", "to")}.get(
            self.communication or "", ()
        )

    @property
    def files(self) -> tuple[Path, ...]:
        """The files that describe and implement the kind, and the files of its shared parameters."""
        names = ("component.yaml", TEMPLATE, *self.headers, *self.sources)
        shared = (Path(parameter.span.file) for parameter in self.parameters)
        return tuple(dict.fromkeys([*(self.folder / name for name in names), *shared]))


def make_kind(node: YamlNode, folder: Path) -> Kind:
    """The kind that a checked ``component.yaml`` describes."""
    return Kind(
        name=text_of(node, "kind"),
        group=text_of(node, "group"),
        summary=text_of(node, "summary"),
        communication=text_of(node, "communication") or None,
        transport=flag_of(node, "transport"),
        pins=texts_of(node, "pins"),
        parameters=make_parameters(node.get("parameters")),
        uses=_made(_use, node, "uses"),
        exactly_one=_alternatives(node, "exactly_one"),
        at_least_one=_alternatives(node, "at_least_one"),
        at_most_one=_alternatives(node, "at_most_one"),
        only_with=tuple((text_of(rule, "key"), text_of(rule, "needs")) for rule in _rules(node, "only_with")),
        needs_bound=tuple(NeedsBound(**values_of(rule, NeedsBound)) for rule in _rules(node, "needs_bound")),
        axis=KindAxis(**values_of(node["axis"], KindAxis)) if "axis" in node else None,
        ports=_made(_port, node, "ports"),
        claims=_made(_claim, node, "claims"),
        faults=_made(_fault, node, "faults"),
        safe_states=tuple(text_map_of(state) for state in elements_of(node, "safe_states")),
        headers=texts_of(node, "driver", "headers"),
        sources=texts_of(node, "driver", "sources"),
        node=node,
        folder=folder,
        span=node["kind"].span,
    )


def _made(make: Callable[[str, YamlNode, YamlNode], Part], kind: YamlNode, key: str) -> tuple[Part, ...]:
    """The parts of a kind that its map ``key`` describes: ``make`` gets the name and the description of each."""
    return tuple(make(name, child, kind) for name, child in map_of(kind, key).items())


def _rules(kind: YamlNode, key: str) -> list[YamlNode]:
    """The relations of a kind that are rules of the form ``key``."""
    return [relation[key] for relation in elements_of(kind, "relations") if key in relation]


def _alternatives(kind: YamlNode, key: str) -> tuple[tuple[str, ...], ...]:
    return tuple(tuple(str(name.value) for name in rule.elements()) for rule in _rules(kind, key))


def make_parameters(section: YamlNode | None) -> tuple[KindParameter, ...]:
    """The parameters that a checked map describes; empty if ``section`` is None."""
    return (
        ()
        if section is None
        else tuple(make_parameter(name, node, section.key_span(name)) for name, node in section.items())
    )


def make_parameter(name: str, node: YamlNode, span: Span) -> KindParameter:
    """The parameter that a checked part of a ``component.yaml`` describes."""
    keywords = {key: node[key].plain() for key in ("enum", "pattern", "minLength", "examples") if key in node}
    if "below_zero" in node:
        keywords["x-below-zero"] = text_of(node, "below_zero")
    return KindParameter(
        name=name,
        type="quantity" if "quantity" in node else text_of(node, "type"),
        dimension=text_of(node, "quantity"),
        description=text_of(node, "description"),
        required=flag_of(node, "required"),
        default=node.get("default"),
        bounds=MappingProxyType({key: node[key] for key in _BOUNDS if key in node}),
        keywords=MappingProxyType(keywords),
        aliases=text_map_of(node, "aliases"),
        properties=make_parameters(node.get("properties")),
        span=span,
    )


def _port(name: str, node: YamlNode, kind: YamlNode) -> KindPort:
    return KindPort(**values_of(node, KindPort) | {"name": name, "part": name})


def _use(name: str, node: YamlNode, kind: YamlNode) -> KindUse:
    examples = tuple(element.plain() for element in elements_of(node, "examples"))
    return KindUse(**values_of(node, KindUse) | {"name": name, "examples": examples})


def _claim(name: str, node: YamlNode, kind: YamlNode) -> KindClaim:
    return KindClaim(
        name,
        text_of(node, "class"),
        flag_of(node, "output"),
        text_map_of(node, "signals"),
        text_map_of(node, "attributes"),
        kind["claims"].key_span(name),
    )


def _fault(name: str, node: YamlNode, kind: YamlNode) -> KindFault:
    """A fault.  A number that is not stated depends on the names of kind and fault only, so that it never changes."""
    number = (
        node["number"].value if "number" in node else 0x100 + crc32(f"{kind['kind'].value}.{name}".encode()) % 0xFF00
    )
    assert isinstance(number, int)
    return KindFault(name, number, text_of(node, "description"), text_of(node, "remedy"), kind["faults"].key_span(name))
