# SPDX-License-Identifier: Apache-2.0
"""Checks the names of the node, its namespace and its topics, and the quality of service of the topics."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from epg.generator.catalog.middleware import POLICIES, Middleware
from epg.generator.check.names import (
    absolute_topic,
    digit_hint,
    name_hint,
    namespace_problem,
    near_name,
    node_name_problem,
    topic_problem,
)
from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.documents.schema import extended_from
from epg.generator.source import Span, YamlNode

TopicUse = tuple[str, str, Span, YamlNode | None]
"""The user of a topic, the topic's name, the position of the name, and its YAML node (None: EPG chose the name)."""


def check_names(
    node: YamlNode, namespace: YamlNode | None, topics: Iterable[TopicUse], diagnostics: Diagnostics
) -> None:
    """Reports names that ROS 2 does not allow, and topics that have two users."""
    _report(node, node_name_problem, diagnostics)
    if namespace is not None:
        _report(namespace, namespace_problem, diagnostics)
    prefix = str(namespace.value) if namespace else ""
    users: dict[str, tuple[str, Span]] = {}
    topics = tuple(topics)
    taken = [topic for _, topic, _, _ in topics]
    for user, topic, span, written in topics:
        problem = topic_problem(topic)
        if problem:
            notes = extended_from(written) if written is not None else []
            near = near_name(topic, topic_problem)
            hint = name_hint(near, topic) if near not in taken else ""
            hint = hint or digit_hint(topic, topic_problem)
            taken.append(near)
            diagnostics.error("invalid-name", span, f"'{topic}' {problem}", hint=hint, notes=notes)
            continue
        full = absolute_topic(topic, prefix, str(node.value))
        other = users.setdefault(full, (user, span))
        if other[0] != user or other[1] != span:
            message = f"topic '{topic}' is already used by '{other[0]}'"
            notes = [Note("used here", other[1])]
            hint = "give each its own topic; one component can be bound to several model ports"
            diagnostics.error("duplicate-topic", span, message, hint=hint, notes=notes)


def check_parts(namespace: YamlNode, node: YamlNode, middleware: Middleware, diagnostics: Diagnostics) -> None:
    """Warns of a namespace that has more parts than ``ros2 node`` shows correctly."""
    parts = str(namespace.value).strip("/").split("/")
    if middleware.namespace_parts is None or len(parts) <= middleware.namespace_parts:
        return
    first, rest = "/".join(parts[: middleware.namespace_parts]), "/".join(parts[middleware.namespace_parts :])
    message = (
        f"agents take '/{first}' for the namespace and '{rest}/{node.value}' for the node, "
        "and 'ros2 node info' does not find it"
    )
    hint = f"topics, services and parameters work; a namespace such as '{'_'.join(parts)}' has all commands"
    diagnostics.warning("namespace-parts", namespace.span, message, hint=hint, notes=extended_from(namespace))


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


def _report(node: YamlNode, problem_of: Callable[[str], str | None], diagnostics: Diagnostics) -> None:
    name = str(node.value)
    problem = problem_of(name)
    if problem:
        hint = name_hint(near_name(name, problem_of), name) or digit_hint(name, problem_of)
        diagnostics.error("invalid-name", node.span, f"'{name}' {problem}", hint=hint, notes=extended_from(node))
