# SPDX-License-Identifier: Apache-2.0
"""Component kinds as data: ``components/<kind>/component.yaml`` in the folders of targets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any
from zlib import crc32

from epg.dataclass import dataclass
from epg.documents.items import flag_of, map_of, text_map_of, text_of, texts_of, values_of
from epg.source import Span, YamlNode

TEMPLATE = "code.c.j2"
"""The template of the code that a kind adds to generated files.  Middlewares can have such a template, too."""


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
    keywords: Mapping[str, Any]  # enum, pattern, minLength, examples, as in JSON Schema
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
    ``words``: words in the names of model ports that belong to such a port (:mod:`epg.resolve.matching`).
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
    remedy: str  # empty if the kind does not state it
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
        ports: list[KindPort] = []
        for port in self.ports:
            boolean = port.boolean_with and all(parameters[key] == text for key, text in port.boolean_with.items())
            ports += [replace(port, type="boolean") if boolean else port] if not port.each else []
        for each in dict.fromkeys(port.each for port in self.ports if port.each):
            stated = parameters[each]  # a list of names, or a message with the names of its numbers
            elements = stated if isinstance(stated, tuple) else getattr(stated, "names", ())
            parts = [port for port in self.ports if port.each == each]
            for element in elements:
                for port in parts:
                    name = element if len(parts) == 1 else f"{element}.{port.name}"
                    ports.append(replace(port, name=name, each="", element=element, part=port.name))
        return replace(self, ports=tuple(ports))

    def shown_port(self, port: KindPort) -> str:
        """The name of a kind's port in messages: ``position``, or ``<joints>.position`` if each joint has this port."""
        if not port.each:
            return port.name
        alone = sum(other.each == port.each for other in self.ports) == 1
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
    relations = node.get("relations")
    listed = relations.elements() if relations else ()
    alternatives = {
        key: tuple(texts_of(relation, key) for relation in listed if key in relation)
        for key in ("exactly_one", "at_least_one", "at_most_one")
    }
    bound = (relation["needs_bound"] for relation in listed if "needs_bound" in relation)
    with_others = (relation["only_with"] for relation in listed if "only_with" in relation)
    return Kind(
        name=text_of(node, "kind"),
        group=text_of(node, "group"),
        summary=text_of(node, "summary"),
        communication=text_of(node, "communication") or None,
        transport=flag_of(node, "transport"),
        pins=texts_of(node, "pins"),
        parameters=make_parameters(node.get("parameters")),
        uses=tuple(_use(name, child) for name, child in map_of(node, "uses").items()),
        **alternatives,
        only_with=tuple((text_of(rule, "key"), text_of(rule, "needs")) for rule in with_others),
        needs_bound=tuple(NeedsBound(**values_of(rule, NeedsBound)) for rule in bound),
        ports=tuple(_port(name, child) for name, child in map_of(node, "ports").items()),
        claims=tuple(_claim(name, child, node) for name, child in map_of(node, "claims").items()),
        faults=tuple(_fault(name, child, node) for name, child in map_of(node, "faults").items()),
        safe_states=tuple(
            text_map_of(state) for state in (node["safe_states"].elements() if "safe_states" in node else ())
        ),
        headers=texts_of(node, "driver", "headers"),
        sources=texts_of(node, "driver", "sources"),
        node=node,
        folder=folder,
        span=node["kind"].span,
    )


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


def _port(name: str, node: YamlNode) -> KindPort:
    return KindPort(**values_of(node, KindPort) | {"name": name, "part": name})


def _use(name: str, node: YamlNode) -> KindUse:
    examples = tuple(element.plain() for element in node["examples"].elements()) if "examples" in node else ()
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
