# SPDX-License-Identifier: Apache-2.0
"""A target configuration, complete and typed: the merged ``.tcf`` after all checks that do not need a model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from epg.generator.catalog.catalog import Catalog, Computer, Kind
from epg.generator.catalog.clocks import check_stated, with_frequencies
from epg.generator.check.bindings import Conversion, conversion_of
from epg.generator.check.communication import Communication, check_communication, time_of
from epg.generator.check.compose import component_schema, typed_parameters, with_hints
from epg.generator.check.devicetree import check_node
from epg.generator.check.fail_safe import check_fail_safe
from epg.generator.check.merge import apply_settings, merge_chain
from epg.generator.check.messages import message_files, with_messages
from epg.generator.check.names import identifier_problem, normal_namespace
from epg.generator.check.other_code import NO_OTHER_CODE, OtherCode, check_other_code
from epg.generator.check.topics import TopicUse, check_names, check_parts, check_quality
from epg.generator.check.uses import Used, used_components
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note, did_you_mean
from epg.generator.documents.accept import accepts
from epg.generator.documents.items import flag_of, integer_of, map_of
from epg.generator.documents.schema import extended_from, load_schema, validate
from epg.generator.documents.tcf import TcfFile, files_of
from epg.generator.documents.yaml_file import newer_version
from epg.generator.source import Span, YamlNode

if TYPE_CHECKING:
    from epg.generator.documents.ioc_file import Ioc

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
    ``made`` are the names of components that the ``.tcf`` does not have: topics that a system gives to ports of the
    model.
    """

    target: Computer
    node: str
    namespace: str
    control: Control
    communication: Communication
    components: Mapping[str, Component]
    files: tuple[Path, ...]
    absent: tuple[Path, ...]
    root: YamlNode
    others: OtherCode = NO_OTHER_CODE
    made: frozenset[str] = frozenset()

    @property
    def tcf(self) -> str:
        """The ``.tcf`` that the user names: the first of :attr:`files`, as messages write it."""
        return self.root.span.file

    def is_changed_by_tcf(self, node: YamlNode) -> bool:
        """True if a value in :attr:`tcf` replaces ``node``; False if it is an argument, or in the file of a system."""
        return bool(node.origins) or node.span.file == self.tcf

    def is_of_system(self, node: YamlNode) -> bool:
        """True if the file of a system gives ``node``: neither a ``.tcf`` nor an argument has it."""
        return node.span.text is None and not self.is_changed_by_tcf(node)


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
    root = _merged(chain, settings, diagnostics)
    if root is None:
        return None
    target = catalog.target(str(root["target"].value), root["target"].span, diagnostics)
    if target is not None:
        target = _with_clocks(target, root, diagnostics)
    components = check_components(root, target, catalog, diagnostics, pins_required)
    carries = {c.name: c.kind.transport for c in components.values()}
    communication = check_communication(root, target, carries, catalog, diagnostics)
    if communication is not None:
        topics = [c.name for c in components.values() if c.kind.communication]
        check_quality(root["components"], topics, communication.middleware, diagnostics)
    control = _control(root, components, communication, diagnostics)
    namespace = root.get("namespace")
    check_names(root["node"], namespace, _topics(components, control, communication), diagnostics)
    if target is None or communication is None or diagnostics.error_count > errors:
        return None
    configuration = Configuration(
        target=target,
        node=str(root["node"].value),
        namespace=normal_namespace(str(namespace.value)) if namespace else "",
        control=control,
        communication=communication,
        components=components,
        files=(*files_of(chain), *_message_files(components)),
        absent=tuple(path for file in chain for path in file.absent),
        root=root,
    )
    if namespace is not None and not configuration.is_of_system(namespace):
        check_parts(namespace, root["node"], communication.middleware, diagnostics)
    return configuration


def _merged(
    chain: Sequence[TcfFile], settings: Sequence[tuple[tuple[str, ...], YamlNode]], diagnostics: Diagnostics
) -> YamlNode | None:
    """The values of ``chain`` with the settings applied to them, or None after reporting what the schema forbids."""
    errors = diagnostics.error_count
    schema = load_schema("tcf")
    for file in chain:
        newer_version(file.node, "version", diagnostics)
    if diagnostics.error_count > errors:
        return None
    if len(chain) > 1:
        for file in (*chain[1:], chain[0]):
            validate(file.node, schema, diagnostics, partial=True)
    if diagnostics.error_count > errors:
        return None
    root = apply_settings(merge_chain(chain), settings)
    return root if validate(root, schema, diagnostics) else None


def with_other_code(
    configuration: Configuration, ioc: Ioc, diagnostics: Diagnostics, wanted_by: Span | None = None
) -> Configuration:
    """The configuration with the use of the chip that a project file of STM32CubeMX states.  Reports mistakes in it.

    ``wanted_by`` is the position at which the file is named.
    """
    others = check_other_code(ioc, configuration.target, configuration.root["target"].span, diagnostics, wanted_by)
    return replace(configuration, others=others, files=(*configuration.files, ioc.path))


def _with_clocks(target: Computer, root: YamlNode, diagnostics: Diagnostics) -> Computer:
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
    root: YamlNode, target: Computer | None, catalog: Catalog, diagnostics: Diagnostics, pins_required: bool
) -> dict[str, Component]:
    """The components without mistakes, by name.  Reports the mistakes of the others."""
    section = root["components"]
    result: dict[str, Component] = {}
    folded: dict[str, str] = {}
    for name, node in section.items():
        span = section.key_span(name)
        _check_name(section, name, folded.setdefault(name.casefold(), name), diagnostics)
        kind = _kind(name, node, span, catalog, diagnostics)
        if kind is None:
            continue
        named = node.get("node")
        if named is not None:
            check_node(kind, node, named, target, diagnostics)
        with_pins = pins_required and target is not None and target.has_pins and named is None
        if not _is_of_kind(node, kind, with_pins, catalog, diagnostics):
            continue
        parameters = with_messages(kind, typed_parameters(kind, node, diagnostics), node, catalog.roots, diagnostics)
        if parameters is None:
            continue
        kind = kind.of_component(parameters)
        result[name] = Component(name, kind, parameters, {}, conversion_of(node, diagnostics), node, span)
    _fault_numbers({component.kind.name: component.kind for component in result.values()}, diagnostics)
    kinds = {name: result[name].kind if name in result else None for name, _ in section.items()}
    return {
        name: replace(component, uses=used_components(component.kind, component.node, kinds, diagnostics))
        for name, component in result.items()
    }


def _check_name(section: YamlNode, name: str, other: str, diagnostics: Diagnostics) -> None:
    """Reports a name that a component must not have, also because ``other`` is equal but for upper and lower case."""
    span = section.key_span(name)
    problem = identifier_problem(name)
    if problem:
        diagnostics.error("invalid-name", span, f"'{name}' {problem}", notes=extended_from(section[name]))
    if other != name:
        first = Note("the other one", section.key_span(other))
        message = f"'{name}' and '{other}' differ only in upper and lower case"
        diagnostics.error("invalid-name", span, message, notes=[first])


def _kind(name: str, node: YamlNode, span: Span, catalog: Catalog, diagnostics: Diagnostics) -> Kind | None:
    """The kind of a component; None after reporting that it is missing or not known."""
    stated = node.get("kind")
    if stated is None:
        hint = did_you_mean("", catalog.kind_names(), "kinds")
        diagnostics.error("missing-key", span, f"'kind' is missing in 'components.{name}'", hint=hint)
        return None
    return catalog.kind(str(stated.value), stated.span, diagnostics)


def _is_of_kind(node: YamlNode, kind: Kind, with_pins: bool, catalog: Catalog, diagnostics: Diagnostics) -> bool:
    """True if a component has the keys and pins of ``kind``.  Reports the others; a hint can name another kind."""
    schema = component_schema(kind, with_pins=with_pins)
    if accepts(node.plain(), schema):
        return True
    others = (catalog.find_kind(name) for name in catalog.kind_names())
    return validate(node, with_hints(schema, kind, node, (other for other in others if other)), diagnostics)


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
    period = node.get("period")
    seconds = time_of(period, diagnostics)
    if period is not None and seconds is not None and seconds <= 0:
        diagnostics.error("out-of-range", period.span, "the control period must be more than 0")
    fail_safe = node.get("fail_safe")
    limit = integer_of(node, "overrun_limit")
    if fail_safe is not None:
        check_fail_safe(fail_safe, root["components"], components, diagnostics)
    return Control(
        period=seconds,
        period_span=_place(node, "period"),
        output_delay=time_of(node.get("output_delay"), diagnostics),
        output_delay_span=_place(node, "output_delay"),
        enable_at_start=flag_of(node, "enable_at_start"),
        overrun_limit=10 if limit is None else limit,
        enable_topic=_enable_topic(node.get("enable_topic"), communication),
        enable_topic_span=_place(node, "enable_topic"),
        fail_safe=str(fail_safe.value) if fail_safe else None,
    )


def _place(node: YamlNode, key: str) -> Span:
    """The position of the value of ``key``, or of the map if the key is missing."""
    return (node.get(key) or node).span


def _enable_topic(stated: YamlNode | None, communication: Communication | None) -> str | None:
    """The topic that enables the target: the stated one, or the usual one of ROS 2 nodes."""
    if stated is not None:
        return None if stated.value is False else str(stated.value)
    return ENABLE_TOPIC if communication is not None and communication.middleware.is_node else None


def _topics(
    components: Mapping[str, Component], control: Control, communication: Communication | None
) -> list[TopicUse]:
    """All topics with their users."""
    topics: list[TopicUse] = [
        (c.name, str(c.node[key].value), c.node[key].span, c.node[key])
        for c in components.values()
        for key in c.kind.topic_parameters
    ]
    if control.enable_topic is not None:
        topics.append(("control.enable_topic", control.enable_topic, control.enable_topic_span, None))
    if communication is not None and communication.diagnostics:
        topics.append(("communication.diagnostics", DIAGNOSTICS_TOPIC, communication.span, None))
    return topics
