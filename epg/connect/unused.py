# SPDX-License-Identifier: Apache-2.0
"""Finds the parts of a robot that no port of the model uses: a controller of one axis has no use for a second motor."""

from __future__ import annotations

from collections.abc import Collection

from epg.check.configuration import Component, Configuration


def unused_parts(
    configuration: Configuration, bound: Collection[str], simulated: Collection[str] = ()
) -> list[list[str]]:
    """The components without use, and the parameters of others that need an output which is not ``bound``.

    ``bound`` are the references of all wires.  Each part is a list of keys below ``components``.  A component is used
    if a wire ends at it, if the target communicates or fails safely through it, or if a used component names it.  A
    guard is used as long as its motor is.  Components of the ``simulated`` robot stay, too: it has a port for each.
    """
    components = configuration.components
    communication = configuration.communication
    named = {configuration.control.fail_safe, communication.transport, communication.console_transport}
    ends = {reference.partition(".")[0] for reference in (*bound, *simulated)}
    used = {name for name in components if name in named or name in ends}
    more = True
    while more:
        more = False
        for component in components.values():
            if component.name not in used and _follows(component, used):
                used.add(component.name)
                more = True
            if component.name in used:
                others = {each.component for each in component.uses.values()} - used
                used |= others
                more = more or bool(others)
    left_out = [[name] for name, component in components.items() if name not in used and _can_be_unused(component)]
    return left_out + [
        [component.name, rule.key]
        for component in components.values()
        if component.name in used
        for rule in component.kind.needs_bound
        if rule.key in component.node
        and rule.use in component.uses
        and f"{component.uses[rule.use].component}.{rule.port}" not in bound
    ]


def _follows(component: Component, used: Collection[str]) -> bool:
    """True for a component without ports, such as a guard, if the first component that it names is used."""
    if component.kind.ports or not component.uses:
        return False
    drives = [each.name for each in component.kind.uses if each.drive]
    names = [use.component for name, use in component.uses.items() if not drives or name in drives]
    return any(name in used for name in names)


def _can_be_unused(component: Component) -> bool:
    return bool(component.kind.ports or component.kind.transport or component.uses)
