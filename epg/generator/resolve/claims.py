# SPDX-License-Identifier: Apache-2.0
"""The claims of a target: the peripherals and pins that its components and its control loop need, in one list."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import field, replace
from fractions import Fraction
from types import MappingProxyType

from epg.generator.catalog.hardware import Computer
from epg.generator.catalog.kind import KindClaim
from epg.generator.check.configuration import Component, Configuration
from epg.generator.dataclass import dataclass
from epg.generator.source import Span, YamlNode

ClaimKey = tuple[str, str]
"""The name of the component, and the name of the claim in its kind."""

TICK: ClaimKey = ("", "tick")
"""The claim of the control loop's timer, which belongs to no component."""


@dataclass(frozen=True)
class Claim:
    """One use of a resource class: of a peripheral with its pins, or of pins only.

    ``signals`` maps the signals of the class to pins as they are written.  If EPG numbers the signals, it has only the
    names that users have given to them.
    ``attributes`` are in base units (Hz, s), and ``written`` has the place of each.  ``component`` is empty for the
    control loop.
    """

    component: str
    name: str
    resource_class: str
    signals: Mapping[str, YamlNode]
    attributes: Mapping[str, object]
    written: Mapping[str, YamlNode]
    span: Span
    stated_in: Span = field(default_factory=lambda: Span(""))
    """The position of the claim in the file of its kind or platform, for mistakes in that file."""
    node: str = ""
    """The devicetree node that replaces pins and a peripheral; empty if the component does not name one."""

    @property
    def key(self) -> ClaimKey:
        return self.component, self.name

    def place(self, attribute: str) -> YamlNode:
        """The place of an attribute, for messages: that of the component if it has no value."""
        return self.written.get(attribute) or YamlNode(None, self.span)

    @property
    def user(self) -> str:
        """The user of the claim in messages: the component in quotes, or "the control loop"."""
        return f"'{self.component}'" if self.component else "the control loop"


def component_claims(configuration: Configuration) -> tuple[Claim, ...]:
    """The claims of all components, in the order of the ``.tcf``."""
    target = configuration.target
    with_pins = target.has_pins or target.soc.free_names
    return tuple(_claims(configuration.components.values(), with_pins, target.platform.has_nodes))


def tick_claims(target: Computer, period: Fraction | None, span: Span) -> tuple[Claim, ...]:
    """The claim of the control loop; empty if the platform times the loop without a peripheral.

    ``period`` is in seconds.  If it is None, because it is not known yet, the peripheral is claimed nevertheless.
    """
    if target.tick is None:
        return ()
    attributes = {} if period is None else {"period": period}
    where = target.platform.node["tick"].span
    return (Claim(*TICK, target.tick, MappingProxyType({}), MappingProxyType(attributes), {}, span, where),)


def _claims(components: Iterable[Component], with_pins: bool, with_nodes: bool) -> Iterable[Claim]:
    for component in components:
        for claim in component.kind.claims:
            node = component.node.get("node") if with_nodes else None
            pins = component.node.get("pins") if with_pins and node is None else None
            signals = {signal: pins[pin] for signal, pin in claim.signals.items() if pin in pins} if pins else {}
            attributes = _attributes(component, claim)
            yield Claim(
                component=component.name,
                name=claim.name,
                resource_class=claim.resource_class,
                signals=MappingProxyType(signals),
                attributes=MappingProxyType({name: value for name, (value, _) in attributes.items()}),
                written=MappingProxyType({name: where for name, (_, where) in attributes.items()}),
                span=component.span,
                stated_in=claim.span,
                node=str(node.value) if node is not None else "",
            )


def _attributes(component: Component, claim: KindClaim) -> dict[str, tuple[object, YamlNode]]:
    """The attributes that have a value, each with its place.  That of a default is the component's name."""
    result: dict[str, tuple[object, YamlNode]] = {}
    for attribute, parameter in claim.attributes.items():
        name, _, part = parameter.partition(".")
        value = component.parameters.get(name)
        if part:
            value = value.get(part) if isinstance(value, Mapping) else None
        if value is not None:
            result[attribute] = value, component.node.get(name) or replace(component.node, span=component.span)
    return result
