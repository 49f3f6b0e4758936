# SPDX-License-Identifier: Apache-2.0
"""Loads all files of a request, with the same messages about them as the command line's."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from pathlib import Path

from epg.connect.files import Watch
from epg.connect.places import Places
from epg.edit.ends import WireEnd, ends_of, references_of
from epg.generator.catalog.catalog import Catalog, Computer, Kind, load_catalog
from epg.generator.catalog.parameter import typed_value
from epg.generator.check.bindings import Conversion
from epg.generator.check.configuration import Component, Configuration, check_components
from epg.generator.check.merge import apply_settings, merge_chain
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostic, Diagnostics
from epg.generator.documents.tcf import TcfFile, find_tcf, load_tcf_chain, settings_node
from epg.generator.documents.text_file import read_text
from epg.generator.documents.yaml_file import parse_yaml
from epg.generator.importers import Model, load_model
from epg.generator.models.folders import searched_folders
from epg.generator.models.neighbours import Neighbours
from epg.generator.project import Parts, Request, hardware_of, load_configuration, load_parts
from epg.generator.resolve.allocation import Assignments, as_written
from epg.generator.resolve.claims import component_claims, tick_claims
from epg.generator.resolve.first_fit import ClaimSignal, complete_claims, signals_of
from epg.generator.resolve.matching import Match, match_ports
from epg.generator.resolve.pin_options import PinOption, pin_options
from epg.generator.resolve.resolve import allocate_claims, allocate_hardware
from epg.generator.source import Span, YamlNode

_MOST_WATCHED = 2000
"""The limit of files and folders watched for a model that cannot be read: a change of any of them may repair it."""
_SETTLED = 2.0
"""Seconds after which a file counts as completely written: a younger file may have changed while it was read."""


@dataclass(frozen=True)
class Loaded:
    """The parts of a request that could be loaded without an error, and the messages about all of it.

    ``root`` is the YAML tree of the bindings, even if they have errors.  ``chain`` is the ``.tcf`` and the files that
    it extends; empty if one of them cannot be read.
    """

    request: Request
    parts: Parts
    diagnostics: tuple[Diagnostic, ...]
    root: YamlNode | None
    chain: Sequence[TcfFile]
    catalog: Catalog

    @cached_property
    def tree(self) -> YamlNode | None:
        """The merged values of the ``.tcf``, even if they have errors; None if a file of the chain cannot be read."""
        if self.parts.configuration is not None:
            return self.parts.configuration.root
        if not self.chain:
            return None
        return apply_settings(merge_chain(self.chain), settings_node(self.request.settings, Diagnostics()))

    @cached_property
    def target(self) -> Computer | None:
        """Board and platform, even if other values of the ``.tcf`` have errors."""
        if self.parts.configuration is not None:
            return self.parts.configuration.target
        name = value_at(self.tree, "target")
        return self.catalog.find_target(str(name.value)) if name is not None else None

    @cached_property
    def components(self) -> Mapping[str, Component]:
        """All components of a known kind.  One with an error has its parameters' defaults, and no ports of lists."""
        if self.parts.configuration is not None:
            return self.parts.configuration.components
        section = value_at(self.tree, "components")
        if self.tree is None or section is None or not section.is_mapping:
            return {}
        described = [(name, node) for name, node in section.items() if node.is_mapping]
        tree = replace(
            self.tree, value={**dict(self.tree.items()), "components": replace(section, value=dict(described))}
        )
        good = check_components(tree, self.target, self.catalog, Diagnostics(), pins_required=False)
        components: dict[str, Component] = {}
        for name, node in described:
            kind = self.catalog.find_kind(str(node["kind"].value)) if "kind" in node else None
            if name in good:
                components[name] = good[name]
            elif kind is not None:
                components[name] = _with_error(name, kind, node, section.key_span(name))
        return components

    @cached_property
    def wired(self) -> Configuration | None:
        """The configuration, also if components have no pins yet; None if other values of the ``.tcf`` have errors."""
        if self.parts.configuration is not None:
            return self.parts.configuration
        return load_configuration(self.request, self.catalog, Diagnostics(), pins_required=False)

    @property
    def wires(self) -> Iterator[tuple[str, str, Sequence[WireEnd]]]:
        """The wired ports in the bindings: section, name and ends of each."""
        for section in ("inputs", "outputs"):
            ports = value_at(self.root, section)
            for name, _ in ports.items() if ports is not None else ():
                assert self.root is not None
                ends = ends_of(self.root, section, name)
                if ends is not None:
                    yield section, name, ends

    @property
    def period(self) -> Fraction | None:
        """The control period in seconds; None if it is not known yet."""
        model = self.parts.model
        stated = self.wired.control.period if self.wired is not None else None
        return stated or (model.step if model is not None else None)

    @cached_property
    def hardware(self) -> Assignments:
        """The assignments of the components' claims; without an application, those that follow from the ``.tcf``."""
        configuration, application = self.parts.configuration, self.parts.application
        if application is not None:
            return hardware_of(application)
        if configuration is None:
            return {}
        return allocate_hardware(configuration, self.period, Diagnostics()) or {}

    @cached_property
    def wiring(self) -> Assignments:
        """The hardware; while errors prevent it, the pins as the ``.tcf`` states them."""
        if self.hardware or self.wired is None:
            return self.hardware
        return as_written(component_claims(self.wired), self.wired.target)

    def pin_options(self, signal: ClaimSignal) -> tuple[PinOption, ...]:
        """The pins of the board for ``signal``; empty if there is no such signal."""
        if self.wired is None:
            return ()
        if signal not in self._pin_options:
            self._pin_options[signal] = pin_options(self.wired, self.period, signal)
        return self._pin_options[signal]

    @cached_property
    def pin_problems(self) -> tuple[tuple[ClaimSignal, str], ...]:
        """The errors of pins and peripherals: the signal that each is about, and the message."""
        configuration = self.wired
        if configuration is None or not configuration.target.has_pins:
            return ()
        diagnostics = Diagnostics()
        ticks = tick_claims(configuration.target, self.period, configuration.control.period_span)
        claims = complete_claims(component_claims(configuration), configuration.target)
        allocate_claims([*claims, *ticks], configuration, self.period, diagnostics)
        result = []
        for problem in diagnostics:
            _, component, *keys = [*self.places.path(problem), "", ""][:5]
            signals = [signal for signal in signals_of(configuration) if signal[0] == component]
            told = [signal for signal in signals if keys[:2] == ["pins", signal[1]]] or signals[:1]
            if problem.severity == "error" and told:
                result.append((told[0], problem.message))
        return tuple(result)

    @cached_property
    def _pin_options(self) -> dict[ClaimSignal, tuple[PinOption, ...]]:
        return {}

    @cached_property
    def matches(self) -> Mapping[str, Match]:
        """The probable component of each model port that is not bound."""
        if self.parts.model is None:
            return {}
        by_system = {port: (port,) for port in self.by_system}  # the component of such a port has the port's name
        return match_ports(self.parts.model, self.components, {**by_system, **references_of(self.root)})

    @cached_property
    def bound(self) -> tuple[str, ...]:
        """The ports that the bindings name."""
        sections = (value_at(self.root, section) for section in ("inputs", "outputs"))
        return tuple(name for section in sections if section is not None for name, _ in section.items())

    @cached_property
    def references(self) -> frozenset[str]:
        """The component ports at which wires end, as the bindings name them, and those that the system connects."""
        system = self.request.system
        ends = (reference for references in references_of(self.root).values() for reference in references)
        return frozenset(ends) | {end.component for end in (system.ends if system is not None else ())}

    @cached_property
    def by_system(self) -> Mapping[str, str]:
        """The topics of the model's ports that the system connects: ports without a component of their own."""
        system, model, configuration = self.request.system, self.parts.model, self.parts.configuration
        if system is None or model is None or configuration is None:
            return {}
        ports = {port.name for port in (*model.inputs, *model.outputs)} - set(self.bound)
        return {end.name: end.topic for end in system.ends if end.name in ports & configuration.made}

    @cached_property
    def plant_references(self) -> frozenset[str]:
        """The component ports to which the simulated robot is bound."""
        path = self.request.plant_bindings
        text = read_text(path, Diagnostics(), None, self.request.drafts) if path is not None else None
        root = parse_yaml(text, str(path), Diagnostics()) if text is not None else None
        return frozenset(reference for references in references_of(root).values() for reference in references)

    @cached_property
    def places(self) -> Places:
        """The ports and components to which the lines of the files belong."""
        return Places(str(self.request.bindings), self.root, self.parts.model, self.chain)

    def files(self) -> Iterator[Path]:
        """All files that must be watched: a change of any of them can change this object."""
        request, parts = self.request, self.parts
        yield request.bindings
        yield from (file.path for file in self.chain)
        yield from (path for file in self.chain for path in file.absent)
        if request.plant_bindings is not None:
            yield request.plant_bindings
        if request.ioc is not None:
            yield request.ioc
        if parts.application is not None:
            yield from parts.application.files
        yield from files_of_model(request.model, parts.model)
        if request.plant is not None:
            yield request.plant


def value_at(tree: YamlNode | None, *path: str) -> YamlNode | None:
    """The value at ``path`` of a file; None if it has none, or if the file cannot be read."""
    return tree.get(*path) if tree is not None else None


def tcf_path(request: Request) -> Path | None:
    """The file that ``request.tcf`` names; None if it is not found."""
    return find_tcf(request.tcf, request.beside, request.roots)


class Models:
    """A cache of models by path.  A model is read again only if one of its files has changed: large ones take long."""

    def __init__(self) -> None:
        self._known: dict[Path, tuple[Watch, Model | None, Diagnostics]] = {}

    def read(self, path: Path, diagnostics: Diagnostics) -> Model | None:
        """The model as :func:`epg.generator.importers.load_model` reads it.  Each call adds the same messages to
        ``diagnostics``."""
        known = self._known.pop(path, None)
        if known is None or known[0].changed():
            problems = Diagnostics()
            model = load_model(path, problems)
            known = Watch(files_of_model(path, model)), model, problems
        watch, model, problems = known
        if watch.newest() < time.time() - _SETTLED:
            self._known[path] = known
        diagnostics.add_all(problems)
        return model


def load(request: Request, models: Models, catalog: Catalog | None = None) -> Loaded:
    """Reads all files of ``request``.  The draft of a file is read instead of the file."""
    diagnostics = Diagnostics()
    catalog = catalog or load_catalog(request.roots, diagnostics)
    parts = load_parts(request, diagnostics, models.read, catalog)
    if parts.bindings is not None:
        root: YamlNode | None = parts.bindings.root
    else:
        text = read_text(request.bindings, Diagnostics(), None, request.drafts)
        root = parse_yaml(text, str(request.bindings), Diagnostics()) if text is not None else None
    chain = load_tcf_chain(
        request.tcf,
        request.roots,
        Diagnostics(),
        beside=request.beside,
        drafts=request.drafts,
        wanted_by=request.caller,
    )
    root = root if root is not None and root.is_mapping else None
    return Loaded(request, parts, tuple(diagnostics), root, chain, catalog)


def _with_error(name: str, kind: Kind, node: YamlNode, span: Span) -> Component:
    """A component with mistakes, so that it is shown beside its messages."""
    defaults = {parameter.name: typed_value(parameter, None, Diagnostics()) for parameter in kind.parameters}
    ports = tuple(port for port in kind.ports if not port.each)
    return Component(name, replace(kind, ports=ports), defaults, {}, Conversion(), node, span)


def files_of_model(path: Path, model: Model | None) -> Iterator[Path]:
    """The files and folders on which the model at ``path`` depends; ``model`` is None if it cannot be read."""
    yield path
    if model is not None:
        yield from model.files
        yield from model.considered
        yield from (model.directory, *model.searched)
        return
    if path.exists():  # the user may add a missing file in a folder beside it
        near = Neighbours(path if path.is_dir() else path.parent, cpp=True)
        yield from (*near.folders, *near.watched)
    count = 0
    for folder in searched_folders(path) if path.is_dir() else ():
        try:
            entries = sorted(folder.iterdir())
        except OSError:
            continue
        for entry in (folder, *entries):
            count += 1
            if count > _MOST_WATCHED:
                return
            yield entry
