# SPDX-License-Identifier: Apache-2.0
"""A target configuration, complete and typed: the merged ``.tcf`` after all checks that do not need a model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from epg.catalog.catalog import Catalog, Kind, Target
from epg.catalog.clocks import check_stated, with_frequencies
from epg.check.bindings import Conversion, conversion_of
from epg.check.communication import Communication, check_communication, time_of
from epg.check.compose import component_schema, typed_parameters
from epg.check.devicetree import check_node
from epg.check.fail_safe import check_fail_safe
from epg.check.merge import apply_settings, merge_chain
from epg.check.messages import message_files, with_messages
from epg.check.names import identifier_problem, normal_namespace
from epg.check.other_code import NO_OTHER_CODE, OtherCode, check_other_code
from epg.check.topics import Use, check_names, check_quality
from epg.check.uses import Used, used_components
from epg.dataclass import dataclass
from epg.diagnostics import Diagnostics, Note, did_you_mean
from epg.documents.items import map_of
from epg.documents.schema import extended_from, load_schema, validate
from epg.documents.tcf import TcfFile
from epg.documents.yaml_file import newer_version
from epg.source import Span, YamlNode

if TYPE_CHECKING:
    from epg.documents.ioc_file import Ioc

ENABLE_TOPIC, DIAGNOSTICS_TOPIC = "~/enable", "/diagnostics"
"""The topics that every target with a ROS 2 middleware has, in addition to those of its components."""


@dataclass(frozen=True)
class Control:
    """The control loop; times are in seconds.

    If ``period`` is None, it is the step of the model.  If ``output_delay`` is None, outputs are written as soon as
    they are computed.
    """

    period: Fraction | None
    period_span: Span
    output_delay: Fraction | None
    output_delay_span: Span
    enable_at_start: bool
    overrun_limit: int
    enable_topic: str | None  # None: no topic enables the target
    enable_topic_span: Span
    fail_safe: str | None


@dataclass(frozen=True)
class Component:
    """A component with typed parameters (numbers in SI units), the components that it uses, and its conversion."""

    name: str
    kind: Kind
    parameters: Mapping[str, object]
    uses: Mapping[str, Used]
    conversion: Conversion
    node: YamlNode
    span: Span  # position of its name


@dataclass(frozen=True)
class Configuration:
    """The contents of a ``.tcf`` and of the files that it extends.

    ``files`` are the files that were read.  ``absent`` are the files that do not exist but would be read if they did.
    ``root`` is the merged tree with positions.  ``others`` is the use of the chip by other code of the program.
    """

    target: Target
    node: str
    namespace: str
    control: Control
    communication: Communication
    components: Mapping[str, Component]
    files: tuple[Path, ...]
    absent: tuple[Path, ...]
    root: YamlNode
    others: OtherCode = NO_OTHER_CODE


def check_configuration(
    chain: Sequence[TcfFile],
    settings: Sequence[tuple[tuple[str, ...], YamlNode]],
    catalog: Catalog,
    diagnostics: Diagnostics,
    *,
    pins_required: bool = True,
) -> Configuration | None:
    """The configuration of ``chain`` with the settings applied to it, or None after reporting mistakes.

    Without ``pins_required``, components may have no pins: EPG proposes some.
    """
    errors = diagnostics.error_count
    schema = load_schema("tcf")
    for file in chain:
        newer_version(file.node, "version", diagnostics)
    if diagnostics.error_count > errors:
        return None
    for file in chain[1:]:
        validate(file.node, schema, diagnostics, partial=True)
    if len(chain) > 1:
        validate(chain[0].node, schema, diagnostics, partial=True)
    if diagnostics.error_count > errors:
        return None
    root = apply_settings(merge_chain(chain), settings)
    if not validate(root, schema, diagnostics):
        return None
    target_node = root["target"]
    target = catalog.target(str(target_node.value), target_node.span, diagnostics)
    if target is not None:
        target = _with_clocks(target, root, diagnostics)
    components = check_components(root, target, catalog, diagnostics, pins_required)
    communication = check_communication(
        root, target, {c.name: c.kind.transport for c in components.values()}, catalog, diagnostics
    )
    if communication is not None:
        topics = [c.name for c in components.values() if c.kind.communication]
        check_quality(root["components"], topics, communication.middleware, diagnostics)
    control = _control(root, components, communication, diagnostics)
    check_names(root["node"], root.get("namespace"), _topics(components, control, communication), diagnostics)
    if target is None or communication is None or diagnostics.error_count > errors:
        return None
    namespace = root.get("namespace")
    return Configuration(
        target=target,
        node=str(root["node"].value),
        namespace=normal_namespace(str(namespace.value)) if namespace else "",
        control=control,
        communication=communication,
        components=components,
        files=(*(file.path for file in chain), *_message_files(components)),
        absent=tuple(path for file in chain for path in file.absent),
        root=root,
    )


def with_other_code(configuration: Configuration, ioc: Ioc, diagnostics: Diagnostics) -> Configuration:
    """The configuration with the use of the chip that a project file of STM32CubeMX states.  Reports mistakes in it."""
    others = check_other_code(ioc, configuration.target, configuration.root["target"].span, diagnostics)
    return replace(configuration, others=others, files=(*configuration.files, ioc.path))


def _with_clocks(target: Target, root: YamlNode, diagnostics: Diagnostics) -> Target:
    """The target with the frequencies of clocks in the ``.tcf``.  Reports the mistakes in them.

    A target that simulates the robot ignores clocks that it does not have, as it ignores pins: the ``.tcf`` can be for
    a board.
    """
    node = root.get("clocks")
    stated = map_of(root, "clocks")
    if node is not None and target.platform.simulates_plant:
        stated = {name: value for name, value in stated.items() if name in target.clocks}
        node = replace(node, value=MappingProxyType(stated))
    if not check_stated(node, target.clocks, target.soc.title, diagnostics):
        return target
    return replace(target, clocks=with_frequencies(target.soc.clocks, {**target.board_clocks, **stated}))


def check_components(
    root: YamlNode, target: Target | None, catalog: Catalog, diagnostics: Diagnostics, pins_required: bool
) -> dict[str, Component]:
    """The components without mistakes, by name.  Reports the mistakes of the others."""
    section = root["components"]
    result: dict[str, Component] = {}
    folded: dict[str, str] = {}
    for name, node in section.items():
        span = section.key_span(name)
        problem = identifier_problem(name)
        if problem:
            diagnostics.error("invalid-name", span, f"'{name}' {problem}", notes=extended_from(node))
        other = folded.setdefault(name.casefold(), name)
        if other != name:
            first = Note("the other one", section.key_span(other))
            diagnostics.error(
                "invalid-name", span, f"'{name}' and '{other}' differ only in upper and lower case", notes=[first]
            )
        kind_node = node.get("kind")
        if kind_node is None:
            hint = did_you_mean("", catalog.kind_names(), "kinds")
            diagnostics.error("missing-key", span, f"'kind' is missing in 'components.{name}'", hint=hint)
            continue
        kind = catalog.kind(str(kind_node.value), kind_node.span, diagnostics)
        if kind is None:
            continue
        named = node.get("node")
        if named is not None:
            check_node(kind, node, named, target, diagnostics)
        with_pins = pins_required and target is not None and target.has_pins and named is None
        if not validate(node, component_schema(kind, with_pins=with_pins), diagnostics):
            continue
        parameters = typed_parameters(kind, node, diagnostics)
        with_message = with_messages(kind, parameters, node, catalog.roots, diagnostics)
        if with_message is None:
            continue
        parameters = with_message
        kind = kind.of_component(parameters)
        result[name] = Component(name, kind, parameters, {}, conversion_of(node, diagnostics), node, span)
    _fault_numbers({component.kind.name: component.kind for component in result.values()}, diagnostics)
    kinds = {name: result[name].kind if name in result else None for name, _ in section.items()}
    return {
        name: replace(component, uses=used_components(component.kind, component.node, kinds, diagnostics))
        for name, component in result.items()
    }


def _message_files(components: Mapping[str, Component]) -> tuple[Path, ...]:
    """The files of the definitions of messages."""
    return tuple(dict.fromkeys(file for c in components.values() for file in message_files(c.parameters)))


def _fault_numbers(kinds: Mapping[str, Kind], diagnostics: Diagnostics) -> None:
    """Reports two faults of a target with the same number."""
    seen: dict[int, tuple[str, Span]] = {}
    for kind in kinds.values():
        for fault in kind.faults:
            other, first = seen.setdefault(fault.number, (f"'{fault.name}' of kind '{kind.name}'", fault.span))
            if first != fault.span:
                message = f"fault '{fault.name}' of kind '{kind.name}' gets the same number as {other}: {fault.number}"
                notes = [Note("the other one", first)]
                hint = "choose another name, without 'number'"
                diagnostics.error("invalid-name", fault.span, message, hint=hint, notes=notes)


def _control(
    root: YamlNode, components: Mapping[str, Component], communication: Communication | None, diagnostics: Diagnostics
) -> Control:
    """The control loop.  The section ``control`` and its keys are optional.  By default, a target starts disabled."""
    node = root.get("control") or YamlNode(MappingProxyType({}), root.span)
    period, at_start = node.get("period"), node.get("enable_at_start")
    seconds = time_of(period, diagnostics)
    if period is not None and seconds is not None and seconds <= 0:
        diagnostics.error("out-of-range", period.span, "the control period must be more than 0")
    topic, fail_safe, delay = node.get("enable_topic"), node.get("fail_safe"), node.get("output_delay")
    limit = node.get("overrun_limit")
    default_topic = ENABLE_TOPIC if communication is not None and communication.middleware.is_node else None
    if fail_safe is not None:
        check_fail_safe(fail_safe, root["components"], components, diagnostics)
    return Control(
        period=seconds,
        period_span=period.span if period else node.span,
        output_delay=time_of(delay, diagnostics),
        output_delay_span=delay.span if delay else node.span,
        enable_at_start=at_start is not None and at_start.value is True,
        overrun_limit=limit.value if limit is not None and isinstance(limit.value, int) else 10,
        enable_topic=(str(topic.value) if topic.value is not False else None) if topic else default_topic,
        enable_topic_span=topic.span if topic else node.span,
        fail_safe=str(fail_safe.value) if fail_safe else None,
    )


def _topics(components: Mapping[str, Component], control: Control, communication: Communication | None) -> list[Use]:
    """All topics with their users."""
    topics: list[Use] = [
        (c.name, str(c.node[key].value), c.node[key].span, c.node[key])
        for c in components.values()
        for key in c.kind.topic_parameters
    ]
    if control.enable_topic is not None:
        topics.append(("control.enable_topic", control.enable_topic, control.enable_topic_span, None))
    if communication is not None and communication.diagnostics:
        topics.append(("communication.diagnostics", DIAGNOSTICS_TOPIC, communication.span, None))
    return topics
