# SPDX-License-Identifier: Apache-2.0
"""Checks the names of the node, its namespace and its topics, and the quality of service of the topics."""

from __future__ import annotations

from collections.abc import Iterable

from epg.catalog.middleware import POLICIES, Middleware
from epg.check.names import absolute_topic, namespace_problem, node_name_problem, topic_problem
from epg.diagnostics import Diagnostics, Note
from epg.documents.schema import extended_from
from epg.source import Span, YamlNode

Use = tuple[str, str, Span, YamlNode | None]
"""The user of a topic, the topic's name, the position of the name, and its YAML node (None: EPG chose the name)."""


def check_names(node: YamlNode, namespace: YamlNode | None, topics: Iterable[Use], diagnostics: Diagnostics) -> None:
    """Reports names that ROS 2 does not allow, and topics that have two users."""
    _report(node, node_name_problem(str(node.value)), diagnostics)
    if namespace is not None:
        _report(namespace, namespace_problem(str(namespace.value)), diagnostics)
    prefix = str(namespace.value) if namespace else ""
    users: dict[str, tuple[str, Span]] = {}
    for user, topic, span, written in topics:
        problem = topic_problem(topic)
        if problem:
            notes = extended_from(written) if written is not None else []
            diagnostics.error("invalid-name", span, f"'{topic}' {problem}", notes=notes)
            continue
        full = absolute_topic(topic, prefix, str(node.value))
        other = users.setdefault(full, (user, span))
        if other[0] != user or other[1] != span:
            message = f"topic '{topic}' is already used by '{other[0]}'"
            notes = [Note("used here", other[1])]
            hint = "give each its own topic; one component can be bound to several model ports"
            diagnostics.error("duplicate-topic", span, message, hint=hint, notes=notes)


def check_quality(
    section: YamlNode, components: Iterable[str], middleware: Middleware, diagnostics: Diagnostics
) -> None:
    """Reports policies of ``components`` that a ROS 2 middleware does not have.  Other middlewares ignore them all."""
    for component in components if middleware.is_node else ():
        for policy in POLICIES:
            node = section.get(component, policy)
            if node is not None and policy not in middleware.quality and node.value != "volatile":
                message = f"the middleware '{middleware.name}' has no '{policy}'"
                hint = f"remove it, or use a middleware that has it; '{middleware.name}' has " + (
                    ", ".join(middleware.quality) or "none of these policies"
                )
                diagnostics.error("policy-not-offered", node.span, message, hint=hint, notes=extended_from(node))


def _report(node: YamlNode, problem: str | None, diagnostics: Diagnostics) -> None:
    if problem:
        diagnostics.error("invalid-name", node.span, f"'{node.value}' {problem}", notes=extended_from(node))
