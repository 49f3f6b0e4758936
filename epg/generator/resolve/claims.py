# SPDX-License-Identifier: Apache-2.0
"""The claims of a target: the peripherals and pins that its components and its control loop need, in one list."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import field
from fractions import Fraction
from types import MappingProxyType

from epg.generator.catalog.hardware import Target
from epg.generator.catalog.kind import KindClaim
from epg.generator.check.configuration import Component, Configuration
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Note
from epg.generator.source import Span

ClaimKey = tuple[str, str]
"""The name of the component, and the name of the claim in its kind."""

TICK: ClaimKey = ("", "tick")
"""The claim of the control loop's timer, which belongs to no component."""


@dataclass(frozen=True)
class Stated:
    """A value with its position, and the positions of each ``extends`` that leads to its file."""

    value: object
    span: Span
    origins: tuple[Span, ...] = ()

    @property
    def notes(self) -> list[Note]:
        return [Note("extended here", span) for span in self.origins]


@dataclass(frozen=True)
class Claim:
    """One use of a resource class: of a peripheral with its pins, or of pins only.

    ``signals`` maps the signals of the class to pins as they are written.  If EPG numbers the signals, it has only the
    names that users have given to them.
    ``attributes`` are in base units (Hz, s).  ``component`` is empty for the control loop.
    """

    component: str
    name: str
    resource_class: str
    signals: Mapping[str, Stated]
    attributes: Mapping[str, Stated]
    span: Span
    stated_in: Span = field(default_factory=lambda: Span(""))
    """The position of the claim in the file of its kind or platform, for mistakes in that file."""
    node: str = ""
    """The devicetree node that replaces pins and a peripheral; empty if the component does not name one."""

    @property
    def key(self) -> ClaimKey:
        return self.component, self.name

    @property
    def user(self) -> str:
        """The user of the claim in messages: the component in quotes, or "the control loop"."""
        return f"'{self.component}'" if self.component else "the control loop"


def component_claims(configuration: Configuration) -> tuple[Claim, ...]:
    """The claims of all components, in the order of the ``.tcf``."""
    target = configuration.target
    with_pins = target.has_pins or target.soc.free_names
    return tuple(_claims(configuration.components.values(), with_pins, target.platform.has_nodes))


def tick_claims(target: Target, period: Fraction | None, span: Span) -> tuple[Claim, ...]:
    """The claim of the control loop; empty if the platform times the loop without a peripheral.

    ``period`` is in seconds.  If it is None, because it is not known yet, the peripheral is claimed nevertheless.
    """
    if target.tick is None:
        return ()
    attributes = {} if period is None else {"period": Stated(period, span)}
    where = target.platform.node["tick"].span
    return (Claim(*TICK, target.tick, MappingProxyType({}), MappingProxyType(attributes), span, where),)


def _claims(components: Iterable[Component], with_pins: bool, with_nodes: bool) -> Iterable[Claim]:
    for component in components:
        for claim in component.kind.claims:
            node = component.node.get("node") if with_nodes else None
            written = with_pins and node is None
            pins = _pins(component) if written else {}
            signals = {signal: pins[pin] for signal, pin in claim.signals.items() if pin in pins}
            yield Claim(
                component=component.name,
                name=claim.name,
                resource_class=claim.resource_class,
                signals=MappingProxyType(signals),
                attributes=MappingProxyType(_attributes(component, claim)),
                span=component.span,
                stated_in=claim.span,
                node=str(node.value) if node is not None else "",
            )


def _pins(component: Component) -> dict[str, Stated]:
    """The pins of a component that the ``.tcf`` states; all of its kind's, unless their names are free."""
    pins = component.node.get("pins")
    return {name: Stated(node.value, node.span, node.origins) for name, node in pins.items()} if pins else {}


def _attributes(component: Component, claim: KindClaim) -> dict[str, Stated]:
    """The attributes that have a value.  The position of a default is that of the component's name."""
    result: dict[str, Stated] = {}
    for attribute, parameter in claim.attributes.items():
        name, _, part = parameter.partition(".")
        value, node = component.parameters.get(name), component.node.get(name)
        if part:
            value = value.get(part) if isinstance(value, Mapping) else None
        if value is not None:
            origins = node.origins if node else component.node.origins
            result[attribute] = Stated(value, node.span if node else component.span, origins)
    return result
