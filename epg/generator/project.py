# SPDX-License-Identifier: Apache-2.0
"""Makes an application from the names of files: loads, checks and resolves.  For the command line and tests.

>>> # request = Request("jiwy", tcf="host_jiwy.tcf", model=Path("model"), bindings=Path("jiwy.bindings.yaml"))
>>> # application = load_application(request, diagnostics)
>>> # files = epg.generator.emit.outputs.application_outputs(application, request.roots, names)
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import field, replace
from pathlib import Path
from typing import Any

from epg.generator.catalog.catalog import Catalog, load_catalog
from epg.generator.check.bindings import Bindings, load_bindings
from epg.generator.check.configuration import Configuration, check_configuration, with_other_code
from epg.generator.check.merge import apply_settings, merge_chain
from epg.generator.check.model import check_model_names
from epg.generator.check.simulated import simulated_part
from epg.generator.check.target_names import check_driver_headers, check_name, check_paths, check_sdk_headers
from epg.generator.check.topic_ends import TopicEnd, bind_ends, components_made, tcf_of_ends
from epg.generator.data import targets_roots
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.cmake_call import caller_span, setting_span
from epg.generator.documents.tcf import TcfFile, load_tcf_chain, settings_node
from epg.generator.documents.text_file import NO_DRAFTS, Drafts
from epg.generator.importers import load_model
from epg.generator.models.model import Model
from epg.generator.resolve.allocation import Assignments
from epg.generator.resolve.application import Application
from epg.generator.resolve.claims import TICK
from epg.generator.resolve.resolve import PlantFiles, allocate_hardware, resolve
from epg.generator.resolve.unwired import report_unwired
from epg.generator.source import Span, YamlNode

Settings = list[tuple[tuple[str, ...], YamlNode]]
"""Values that replace those of a ``.tcf``: keys, and the value."""

ModelReader = Callable[[Path, Diagnostics], "Model | None"]


_PATHS = ("model", "bindings", "plant", "plant_bindings", "ioc", "beside")


@dataclass(frozen=True)
class SystemPart:
    """The part of a target in the ``file`` of a system.

    ``parts`` of a ``.tcf`` replace its values, and ``ends`` are the ends of the target's connections.  A target is
    ``simulated`` with its system, or built for its board, which ignores the plant.
    """

    file: Path
    parts: Sequence[YamlNode]
    ends: Sequence[TopicEnd]
    simulated: bool = False


@dataclass(frozen=True)
class Request:
    """The files and settings of one target.  ``settings`` are texts ``key.key=value``, each with its position.

    ``tcf`` is a path relative to ``beside``, or the name of a file in the folders of targets.  ``caller`` is the
    position of the CMake call that makes the target.  ``ioc`` is the project file of STM32CubeMX of the same program.
    ``drafts`` are texts of an editor that replace files.  ``system`` is what the file of a system adds.
    """

    name: str
    tcf: str
    model: Path
    bindings: Path
    plant: Path | None = None
    plant_bindings: Path | None = None
    ioc: Path | None = None
    settings: Sequence[tuple[str, Span]] = ()
    user_roots: Sequence[Path] = ()
    caller: Span | None = None
    beside: Path = field(default_factory=Path)
    drafts: Drafts = field(default_factory=dict)
    system: SystemPart | None = None

    @property
    def roots(self) -> tuple[Path, ...]:
        return targets_roots(self.user_roots)


def request_of_options(
    name: str, options: Mapping[str, Any], settings: Iterable[str], user_roots: Sequence[Path]
) -> Request:
    """The request of ``epg generate`` with ``options``: their values by their names, None if an option is not given."""
    given = {key: Path(value) for key, value in options.items() if key in _PATHS and value is not None}
    named = [f"{key}={options[key]}" for key in ("node", "namespace") if options.get(key) is not None]
    caller = options.get("caller")
    return Request(
        name=name,
        tcf=options.get("tcf") or "",
        model=given.get("model", Path()),
        bindings=given.get("bindings", Path()),
        plant=given.get("plant"),
        plant_bindings=given.get("plant_bindings"),
        ioc=given.get("ioc"),
        settings=[(text, setting_span(caller, name, text)) for text in (*settings, *named)],
        user_roots=user_roots,
        caller=caller_span(caller, name) if caller else None,
        beside=given.get("beside", Path()),
    )


@dataclass(frozen=True)
class Parts:
    """The contents of the files of a request.  A part is None if its file has mistakes.

    ``application`` is also None if the parts do not fit together.
    """

    configuration: Configuration | None
    model: Model | None
    bindings: Bindings | None
    application: Application | None = None


def load_configuration(
    request: Request, catalog: Catalog, diagnostics: Diagnostics, *, pins_required: bool = True
) -> Configuration | None:
    """The checked configuration of ``request.tcf`` with the settings, or None after reporting mistakes.

    Without ``pins_required``, components may have no pins: :func:`epg.generator.resolve.first_fit.first_fit` proposes
    some.
    """
    chain = load_tcf_chain(
        request.tcf,
        request.roots,
        diagnostics,
        beside=request.beside,
        wanted_by=request.caller,
        drafts=request.drafts,
    )
    settings = settings_node(request.settings, diagnostics)
    if not chain:
        return None
    of_system, made = _of_system(request.system, chain, catalog, diagnostics)
    settings = [*of_system, *settings]
    configuration = _checked(chain, settings, catalog, diagnostics, pins_required)
    if configuration is not None and made:
        configuration = replace(configuration, made=made)
    if request.ioc is None:
        return configuration
    from epg.generator.documents.ioc_file import read_ioc  # few targets have such a file

    ioc = read_ioc(request.ioc, diagnostics, request.caller, request.drafts)
    if configuration is None or ioc is None:
        return None
    return with_other_code(configuration, ioc, diagnostics, request.caller)


def _checked(
    chain: Sequence[TcfFile], settings: Settings, catalog: Catalog, diagnostics: Diagnostics, pins_required: bool
) -> Configuration | None:
    """The checked configuration.  If only pins are missing in it, free ones are proposed for all components."""
    problems = Diagnostics()
    configuration = check_configuration(chain, settings, catalog, problems, pins_required=pins_required)
    if configuration is None and pins_required:
        others = Diagnostics()
        unwired = check_configuration(chain, settings, catalog, others, pins_required=False)
        if unwired is not None:
            report_unwired(unwired, others)
            problems = others
    diagnostics.add_all(problems)
    return configuration


def _of_system(
    system: SystemPart | None, chain: Sequence[TcfFile], catalog: Catalog, diagnostics: Diagnostics
) -> tuple[Settings, frozenset[str]]:
    """The values that a system changes in the ``.tcf`` of one of its targets, and the names of components it adds."""
    if system is None:
        return [], frozenset()
    result: Settings = [((), part) for part in system.parts]
    root = merge_chain(chain)
    components = apply_settings(root, result).get("components")
    connected = tcf_of_ends(components, system.ends, catalog, diagnostics)
    result += [] if connected is None else [((), connected)]
    if system.simulated:
        result.append(((), simulated_part(apply_settings(root, result), catalog)))
    return result, components_made(components, system.ends)


def load_application(request: Request, diagnostics: Diagnostics) -> Application | None:
    """The application of ``request``, or None after reporting the mistakes in all of its files."""
    return load_parts(request, diagnostics).application


def _hardware_of_board(request: Request, model: Model, catalog: Catalog) -> Assignments | None:
    """The assignments on its board of a target that is simulated with its system; None for other targets."""
    if request.system is None or not request.system.simulated:
        return None
    real = replace(request, system=replace(request.system, simulated=False))
    configuration = load_configuration(real, catalog, Diagnostics())
    if configuration is None:
        return None
    return allocate_hardware(configuration, configuration.control.period or model.step, Diagnostics())


def load_parts(
    request: Request, diagnostics: Diagnostics, read_model: ModelReader = load_model, catalog: Catalog | None = None
) -> Parts:
    """The application of ``request`` and the parts that it is made of.  Reports the mistakes in all files.

    A caller with several requests has one ``catalog`` for all of them.
    """
    span = request.caller or Span("command line")
    check_name(request.name, span, diagnostics)
    catalog = catalog or load_catalog(request.roots, diagnostics)
    configuration = load_configuration(request, catalog, diagnostics)
    if configuration is not None:
        check_sdk_headers(request.name, configuration.target, span, diagnostics)
    model, bindings = _load_model(request, request.model, request.bindings, diagnostics, read_model, request.drafts)
    parts = Parts(configuration, model, bindings)
    plant: PlantFiles | None = None
    simulates = configuration is None or configuration.target.platform.simulates_plant
    wanted = simulates or request.system is None  # the plant of a system is for its simulation
    if wanted and request.plant is not None and request.plant_bindings is not None:
        plant_model, plant_bindings = _load_model(
            request, request.plant, request.plant_bindings, diagnostics, read_model
        )
        if plant_model is None or plant_bindings is None:
            return parts
        plant = PlantFiles(plant_model, plant_bindings)
    return replace(parts, application=_application(request, parts, plant, catalog, diagnostics))


def _load_model(
    request: Request,
    folder: Path,
    bindings: Path,
    diagnostics: Diagnostics,
    read_model: ModelReader,
    drafts: Drafts = NO_DRAFTS,
) -> tuple[Model | None, Bindings | None]:
    """A model and its bindings; None for each one with mistakes."""
    model = read_model(folder, diagnostics)
    name = model.name if model is not None else None
    return model, load_bindings(bindings, diagnostics, request.caller, drafts, name)


def _application(
    request: Request, parts: Parts, plant: PlantFiles | None, catalog: Catalog, diagnostics: Diagnostics
) -> Application | None:
    """The application of the loaded files; None if one of them has mistakes, or if they do not fit together."""
    configuration, model, bindings = parts.configuration, parts.model, parts.bindings
    if configuration is None or model is None or bindings is None:
        return None
    if request.system is not None:
        errors = diagnostics.error_count
        bindings = bind_ends(bindings, model, configuration, request.system.ends, diagnostics)
        if diagnostics.error_count > errors:
            return None
    check_model_names(model, f"{request.name}_model", diagnostics)
    if plant is not None:
        check_model_names(plant.model, f"{request.name}_plant", diagnostics)
    board = _hardware_of_board(request, model, catalog)
    application = resolve(request.name, configuration, model, bindings, plant, diagnostics, board)
    if application is None:
        return None
    own = () if request.system is None else (request.system.file,)
    check_driver_headers(request.name, configuration, diagnostics)
    check_paths((*application.files, *own, *request.user_roots), diagnostics)
    files = tuple(sorted({*application.files, *own, *catalog.files}))
    return None if diagnostics.has_errors else replace(application, files=files)


def hardware_of(application: Application) -> Assignments:
    """The hardware of all components and of the control loop."""
    found = {(c.name, claim): assignment for c in application.components for claim, assignment in c.claims.items()}
    return found | ({TICK: application.tick} if application.tick else {})


def load_hardware(request: Request, catalog: Catalog, diagnostics: Diagnostics) -> Assignments | None:
    """The hardware of the components and the control loop, from the ``.tcf`` alone, without model and bindings.

    Without a model the control period may be unknown.  Then the timer of the control loop has no settings.
    Returns None after reporting mistakes.
    """
    configuration = load_configuration(request, catalog, diagnostics)
    if configuration is None:
        return None
    return allocate_hardware(configuration, configuration.control.period, diagnostics)
