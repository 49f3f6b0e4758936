# SPDX-License-Identifier: Apache-2.0
"""References of components to other components: a guard names its motor and its encoder, a probe names its topic."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from epg.generator.catalog.kind import Kind, KindPort, KindUse
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.documents.schema import extended_from
from epg.generator.source import YamlNode


@dataclass(frozen=True)
class Used:
    """A component that another one names, and its port.  ``port`` is None if the component is a topic."""

    component: str
    port: KindPort | None


def used_components(
    kind: Kind, node: YamlNode, kinds: Mapping[str, Kind | None], diagnostics: Diagnostics
) -> Mapping[str, Used]:
    """The components that a component of ``kind`` uses, by the names of :class:`KindUse` in its kind.

    A reference is ``component.port``, or the name of a component, which means its main port.  ``kinds`` maps all
    components to their kinds, and a component with mistakes to None.
    """
    result: dict[str, Used] = {}
    for use in kind.uses:
        if use.name in node:
            found = _used(use, node[use.name], kind, kinds, diagnostics)
            if found is not None:
                result[use.name] = found
    return MappingProxyType(result)


def possible_references(use: KindUse, kinds: Mapping[str, Kind | None]) -> list[str]:
    """The references to components of ``kinds`` that ``use`` allows, in the short form if there is one."""
    return [reference for name, kind in kinds.items() if kind for reference in _references(use, name, kind)]


def _used(
    use: KindUse, node: YamlNode, kind: Kind, kinds: Mapping[str, Kind | None], diagnostics: Diagnostics
) -> Used | None:
    """The component and port that a reference names; None after reporting that ``use`` does not allow it."""
    text = str(node.value)
    possible = possible_references(use, kinds)
    name, _, port_name = text.partition(".")
    notes = extended_from(node)
    if name not in kinds:
        hint = did_you_mean(text, possible, "possible")
        diagnostics.error("unknown-component", node.span, f"there is no component '{name}'", hint=hint, notes=notes)
        return None
    other = kinds[name]
    if other is None:
        return None
    port = _port(use, other, port_name)
    if port_name and port_name not in [p.name for p in other.ports]:
        hint = did_you_mean(port_name, [p.name for p in other.ports], f"ports of a {other.name}")
        message = f"a {other.name} has no port '{port_name}'"
        diagnostics.error("unknown-port", node.span, message, hint=hint, notes=notes)
        return None
    if (not other.topic_ports or port_name) if use.topic else port is None:
        what = f"a port of a {other.name}" if port_name else f"a {other.name}"
        message = f"'{text}' is {what}, which cannot be the '{use.name}' of a {kind.name} ({use.description})"
        hint = did_you_mean(text, possible, "possible")
        diagnostics.error("wrong-component", node.span, message, hint=hint, notes=notes)
        return None
    return Used(name, port)


def _references(use: KindUse, name: str, kind: Kind) -> list[str]:
    """The possible references to a component of ``kind``, in the short form if there is one."""
    if use.topic:
        return [name] if kind.topic_ports else []
    main = _port(use, kind, "")
    return [name if port is main else f"{name}.{port.name}" for port in kind.ports if _fits(use, port)]


def _port(use: KindUse, kind: Kind, name: str) -> KindPort | None:
    """The port ``name``, or the main port if ``name`` is empty; None if ``use`` does not allow it."""
    fitting = [port for port in kind.ports if _fits(use, port)]
    if name:
        return next((port for port in fitting if port.name == name), None)
    main = [port for port in fitting if port.default]
    return (main or fitting)[0] if len(main or fitting) == 1 else None


def _fits(use: KindUse, port: KindPort) -> bool:
    return (
        not use.topic
        and use.direction in ("", port.direction)
        and use.unit in ("", port.unit)
        and (port.drive or not use.drive)
    )
