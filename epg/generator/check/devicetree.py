# SPDX-License-Identifier: Apache-2.0
"""Checks components that name a devicetree node: ``encoder: {kind: quadrature_encoder, node: qdec0, ...}``."""

from __future__ import annotations

from epg.generator.catalog.hardware import Computer
from epg.generator.catalog.kind import Kind
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.schema import extended_from
from epg.generator.source import YamlNode


def check_node(
    kind: Kind, component: YamlNode, node: YamlNode, target: Computer | None, diagnostics: Diagnostics
) -> None:
    """Reports a ``node`` of a component that cannot have one.

    On platforms that read a devicetree, a node replaces the pins and the peripheral of one claim.  Targets without pins
    ignore the key, as they ignore ``pins``.
    """
    notes = extended_from(node)
    instead = "write 'pins' instead ('node: null' if an extended file has set it)"
    span = component.key_span("node")
    if not kind.claims:
        return  # The schema of such a kind has no key ``node``, so the key is reported there.
    if len(kind.claims) > 1:
        message = f"'node' names one peripheral, and a {kind.name} claims {len(kind.claims)}"
        diagnostics.error("node-not-possible", span, message, hint=instead, notes=notes)
    elif target is not None and target.has_pins and not target.platform.has_nodes:
        message = f"'node' names a devicetree node, and {target.name} has no devicetree"
        diagnostics.error("node-not-possible", span, message, hint=instead, notes=notes)
    elif "pins" in component:
        message = "a component must set either 'pins' or 'node', not both"
        hint = "remove one of the two ('pins: null' if an extended file has set it)"
        diagnostics.error("exactly-one", span, message, hint=hint, notes=notes)
