# SPDX-License-Identifier: Apache-2.0
"""Checks ``fail_safe``, the input that disables a target while it is off.

The input must be a boolean one, and it should be off if its wire breaks.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from epg.generator.catalog.kind import Kind
from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.documents.schema import extended_from
from epg.generator.source import YamlNode

if TYPE_CHECKING:
    from epg.generator.check.configuration import Component


def check_fail_safe(
    node: YamlNode, section: YamlNode, components: Mapping[str, Component], diagnostics: Diagnostics
) -> None:
    """Reports a ``node`` that does not name a component with a boolean source, or that names a topic.

    ``components`` are the components of ``section`` that have no mistakes.
    """
    name = str(node.value)
    able = [name for name, component in components.items() if can_disable(component.kind)]
    if name in able:
        _check_open_wire(name, components[name], diagnostics)
    elif name in components:
        message = f"'{name}' is a {components[name].kind.name}, which cannot be on or off"
        diagnostics.error("wrong-port-type", node.span, message, hint="name a digital_input")
    elif name not in section:  # Else the component has mistakes, which are reported already.
        hint = str(did_you_mean(name, able, "digital inputs"))  # never an edit: another input may be a limit switch
        diagnostics.error("unknown-component", node.span, f"there is no component '{name}'", hint=hint)


def can_disable(kind: Kind) -> bool:
    """True if a component of ``kind`` can be the fail-safe input.  A topic is not an electrical input."""
    return not kind.communication and any(port.direction == "source" and port.type == "boolean" for port in kind.ports)


def _check_open_wire(name: str, component: Component, diagnostics: Diagnostics) -> None:
    """Warns if the input is on, or can be on, while its pin is not connected."""
    pull, invert = component.parameters.get("pull"), bool(component.parameters.get("invert", False))
    if "pins" not in component.node or pull is None or pull == ("up" if invert else "down"):
        return  # Without pins, EPG does not know the wire: the host has none, a devicetree node has its own pull.
    written = component.node.get("pull")
    span = component.node.key_span("kind") if written is None else written.span
    if pull == "none":
        message = f"if its wire breaks, '{name}' can be on or off: the target may stay enabled"
    else:
        message = f"if its wire breaks, '{name}' is on ('pull: {pull}'): the target stays enabled"
    hint = "connect the pin to ground by a normally-closed contact, and write 'pull: up, invert: true'; see "
    hint += "docs/emergency-stop.md"
    notes = extended_from(written) if written is not None else ()
    diagnostics.warning("open-fail-safe", span, message, hint=hint, notes=notes)
