# SPDX-License-Identifier: Apache-2.0
"""Finds the parts of a robot that no port of the model uses: a controller of one axis has no use for a second motor."""

from __future__ import annotations

from collections.abc import Collection

from epg.generator.check.configuration import Component, Configuration
from epg.generator.resolve.unused import can_stop, used_components


def unused_parts(
    configuration: Configuration, bound: Collection[str], simulated: Collection[str] = ()
) -> list[list[str]]:
    """The components without use, and the parameters of others that need an output which is not ``bound``.

    ``bound`` are the references of all wires.  Each part is a list of keys below ``components``.  Components of the
    ``simulated`` robot stay: it has a port for each.  So does an input that can be the emergency stop.
    """
    components = configuration.components
    used = used_components(configuration, {reference.partition(".")[0] for reference in (*bound, *simulated)})
    left_out = [
        [name]
        for name, component in components.items()
        if name not in used and _can_be_unused(component) and not can_stop(component, components)
    ]
    return left_out + [
        [component.name, rule.key]
        for component in components.values()
        if component.name in used
        for rule in component.kind.needs_bound
        if rule.key in component.node
        and rule.use in component.uses
        and f"{component.uses[rule.use].component}.{rule.port}" not in bound
    ]


def _can_be_unused(component: Component) -> bool:
    return bool(component.kind.ports or component.kind.transport or component.uses)
