# SPDX-License-Identifier: Apache-2.0
"""Ends of connections: ports of a target that a system connects with ports of other targets.

An end names a topic component of the ``.tcf``, or a port of the model that has no binding.  Such a port gets a topic
component with its own name.  The topics of all ends come from the system's file.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from epg.generator.catalog.catalog import Catalog
from epg.generator.check.bindings import Binding, Bindings, Conversion
from epg.generator.check.configuration import Configuration
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note, did_you_mean
from epg.generator.models.model import Model
from epg.generator.source import Scalar, Span, YamlNode

SENDER, RECEIVER = "ros_publisher", "ros_subscriber"
"""The kinds of the topic components of model ports."""


@dataclass(frozen=True)
class TopicEnd:
    """One end of a connection, or of several with the same sender.

    ``name`` is ``component``, ``component.port`` or a port of the model.  ``parameters`` are those of the topic
    component that the connection states.  ``span`` is the position of the name.
    """

    name: str
    topic: str
    receives: bool
    parameters: Mapping[str, YamlNode]
    span: Span

    @property
    def component(self) -> str:
        return self.name.partition(".")[0]

    @property
    def port(self) -> str:
        """The port of the component, or an empty text."""
        return self.name.partition(".")[2]


def components_made(components: YamlNode | None, ends: Iterable[TopicEnd]) -> frozenset[str]:
    """The names of the topic components that the ``.tcf`` with these ``components`` lacks."""
    return frozenset(end.component for end in ends if components is None or end.component not in components)


def tcf_of_ends(
    components: YamlNode | None, ends: Sequence[TopicEnd], catalog: Catalog, diagnostics: Diagnostics
) -> YamlNode | None:
    """The part of a ``.tcf`` that gives the ends their topics; None without ends.

    ``components`` are those of the ``.tcf``.  Reports ends that are components of another kind.
    """
    made = components_made(components, ends)
    section: dict[str, YamlNode] = {}
    keys: dict[str, Span] = {}
    for end in ends:
        values = {**end.parameters, "topic": _text(end.topic, end.span)}
        if components is None or end.component in made:
            values["kind"] = _text(RECEIVER if end.receives else SENDER, end.span)
        elif not _is_topic(end, components, catalog, diagnostics):
            continue
        section[end.component] = _map(values, dict.fromkeys(values, end.span), end.span)
        keys[end.component] = end.span
    if not section:
        return None
    span = next(iter(keys.values()))
    return _map({"components": _map(section, keys, span)}, {"components": span}, span)


def bind_ends(
    bindings: Bindings, model: Model, configuration: Configuration, ends: Iterable[TopicEnd], diagnostics: Diagnostics
) -> Bindings:
    """``bindings`` with those of the model ports that :func:`tcf_of_ends` has given a topic component.

    Reports ends that are neither a component nor a port, and ports that are bound already.
    """
    inputs, outputs = dict(bindings.inputs), dict(bindings.outputs)
    for end in ends:
        if end.component not in configuration.made or not _is_port(end, model, bindings, configuration, diagnostics):
            continue
        bound = _bound(end, bindings)
        if bound:
            message = f"'{end.name}' is bound to '{bound[0].component}' already"
            hint = _bound_hint(end, bound[0].component, configuration)
            notes = [Note("bound here", bound[0].span)]
            diagnostics.error("bound-twice", end.span, message, hint=hint, notes=notes)
            continue
        binding = Binding(end.name, None, Conversion(), end.span)
        if end.receives:
            inputs[end.name] = (end.span, binding)
        else:
            outputs[end.name] = (end.span, (binding,))
    return replace(bindings, inputs=MappingProxyType(inputs), outputs=MappingProxyType(outputs))


def _is_topic(end: TopicEnd, components: YamlNode, catalog: Catalog, diagnostics: Diagnostics) -> bool:
    """True if the component of an end has a topic in the direction of the end; else False after reporting it.

    Also True if its kind has mistakes, which are reported elsewhere.
    """
    kind = _kind_of(components, end.component, catalog)
    if kind is None or kind[1] == _direction(end):
        return True
    verb = "does not receive a topic" if end.receives else "does not send a topic"
    message = f"'{end.component}' ({kind[0]}) {verb}"
    others = [
        name
        for name, _ in components.items()
        if (found := _kind_of(components, name, catalog)) is not None and found[1] == _direction(end)
    ]
    hint = did_you_mean(end.component, others) or "connect a port of the model"
    diagnostics.error("wrong-direction", end.span, message, hint=hint)
    return False


def _kind_of(components: YamlNode, name: str, catalog: Catalog) -> tuple[str, str | None] | None:
    """The name of the kind of a component, and the direction of its topic; None if there is no such kind."""
    stated = components.get(name, "kind")
    kind = catalog.find_kind(str(stated.value)) if stated is not None else None
    return None if kind is None else (kind.name, kind.communication)


def _direction(end: TopicEnd) -> str:
    return "subscribe" if end.receives else "publish"


def _is_port(
    end: TopicEnd, model: Model, bindings: Bindings, configuration: Configuration, diagnostics: Diagnostics
) -> bool:
    ports = model.inputs if end.receives else model.outputs
    bound = bindings.inputs if end.receives else bindings.outputs
    if end.name in [port.name for port in ports]:
        return True
    what = "an input" if end.receives else "an output"
    message = f"'{end.name}' is neither a topic component nor {what} of {model.name}"
    topics = [
        c.name
        for c in configuration.components.values()
        if c.kind.communication == _direction(end) and c.name not in configuration.made
    ]
    hint = did_you_mean(end.name, {*topics, *(port.name for port in ports if port.name not in bound)})
    diagnostics.error("unknown-port", end.span, message, hint=hint)
    return False


def _bound(end: TopicEnd, bindings: Bindings) -> tuple[Binding, ...]:
    """The bindings of a model port in the user's file."""
    if not end.receives:
        return bindings.outputs[end.name][1] if end.name in bindings.outputs else ()
    return (bindings.inputs[end.name][1],) if end.name in bindings.inputs else ()


def _bound_hint(end: TopicEnd, component: str, configuration: Configuration) -> str:
    found = configuration.components.get(component)
    if found is not None and found.kind.communication == _direction(end):
        return f"connect '{component}', or remove this binding"
    return "remove this binding, or connect another port"


def _text(value: Scalar, span: Span) -> YamlNode:
    return YamlNode(value, span)


def _map(values: Mapping[str, YamlNode], keys: Mapping[str, Span], span: Span) -> YamlNode:
    return YamlNode(MappingProxyType(dict(values)), span, MappingProxyType(dict(keys)))
