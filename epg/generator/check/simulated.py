# SPDX-License-Identifier: Apache-2.0
"""A target as a part of the simulation of its system: the same ``.tcf`` on the platform ``simulated``."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from epg.generator.catalog.catalog import Catalog, Kind
from epg.generator.source import Span, YamlNode

PLATFORM, MIDDLEWARE = "simulated", "files"

_KEPT = ("period", "keep_cycles")
"""What a simulation keeps of ``communication``: the times of messages, but nothing of their way."""


def simulated_part(root: YamlNode, catalog: Catalog) -> YamlNode:
    """The part of a ``.tcf`` that makes the target ``root`` a part of a simulation.

    Pins are ignored on this platform.  Components that carry the bytes of a middleware are removed.
    """
    span = root.span
    communication = root.get("communication")
    changed = {
        key: YamlNode(None, span) for key, _ in (communication.items() if communication else ()) if key not in _KEPT
    }
    changed["middleware"] = YamlNode(MIDDLEWARE, span)
    part = {"target": YamlNode(PLATFORM, span), "communication": _map(changed, span)}
    components = root.get("components")
    carriers = {
        name: YamlNode(None, span)
        for name, node in (components.items() if components else ())
        if (kind := _kind(node, catalog)) is not None and kind.transport
    }
    if carriers:
        part["components"] = _map(carriers, span)
    return _map(part, span)


def _kind(component: YamlNode, catalog: Catalog) -> Kind | None:
    stated = component.get("kind")
    return None if stated is None else catalog.find_kind(str(stated.value))


def _map(values: Mapping[str, YamlNode], span: Span) -> YamlNode:
    return YamlNode(MappingProxyType(dict(values)), span, MappingProxyType(dict.fromkeys(values, span)))
