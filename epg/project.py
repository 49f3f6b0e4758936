# SPDX-License-Identifier: Apache-2.0
"""From file names to an application: load, check and resolve, for callers such as the command line and tests.

>>> # request = Request("jiwy", tcf="host_jiwy.tcf", model=Path("model"), bindings=Path("jiwy.bindings.yaml"))
>>> # application = load_application(request, diagnostics)
>>> # files = epg.emit.outputs.application_outputs(application, request.roots, names)
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from epg.catalog.catalog import Catalog, Target, load_catalog
from epg.check.bindings import Bindings, load_bindings
from epg.check.configuration import Configuration, check_configuration
from epg.check.names import (
    STANDARD_HEADERS,
    STANDARD_TYPES,
    SYSTEM_LIBRARIES,
    cmake_path_problem,
    identifier_problem,
)
from epg.data import targets_roots
from epg.diagnostics import Diagnostics
from epg.documents.tcf import load_tcf_chain, settings_node
from epg.documents.text_file import Drafts
from epg.models import load_model
from epg.models.details import FmuExport
from epg.models.model import Model
from epg.resolve.allocation import Assignment
from epg.resolve.application import Application
from epg.resolve.claims import TICK, ClaimKey
from epg.resolve.resolve import STATIC_NAMES, PlantFiles, allocate_hardware, resolve
from epg.source import Span

Hardware = Mapping[ClaimKey, Assignment]
"""What each claim of a component, or of the control loop, got."""


ModelReader = Callable[[Path, Diagnostics], "Model | None"]


@dataclass(frozen=True)
class Request:
    """One target as it is asked for.  ``settings`` are ``key.key=value`` with the place they are written."""

    name: str
    tcf: str
    model: Path
    bindings: Path
    plant: Path | None = None
    plant_bindings: Path | None = None
    settings: Sequence[tuple[str, Span]] = ()
    user_roots: Sequence[Path] = ()
    caller: Span | None = None
    beside: Path = field(default_factory=Path)
    drafts: Drafts = field(default_factory=dict)

    @property
    def roots(self) -> tuple[Path, ...]:
        return targets_roots(self.user_roots)


@dataclass(frozen=True)
class Parts:
    """What the files of a request hold: each is None where there are mistakes.

    ``application`` is also None where the others do not fit together.
    """

    configuration: Configuration | None
    model: Model | None
    bindings: Bindings | None
    application: Application | None = None


def load_configuration(request: Request, catalog: Catalog, diagnostics: Diagnostics) -> Configuration | None:
    """The checked configuration of ``request.tcf`` with its settings."""
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
    return check_configuration(chain, settings, catalog, diagnostics)


def load_application(request: Request, diagnostics: Diagnostics) -> Application | None:
    """The application of ``request``, or None after reporting every problem of all its files."""
    return load_parts(request, diagnostics).application


def load_parts(request: Request, diagnostics: Diagnostics, read_model: ModelReader = load_model) -> Parts:
    """The application of ``request`` with what it is made of, after reporting every problem of all its files."""
    check_name(request.name, request.caller or Span("command line"), diagnostics)
    catalog = load_catalog(request.roots, diagnostics)
    configuration = load_configuration(request, catalog, diagnostics)
    if configuration is not None:
        span = request.caller or Span("command line")
        check_sdk_headers(request.name, configuration.target, span, diagnostics)
    model = read_model(request.model, diagnostics)
    bindings = load_bindings(request.bindings, diagnostics, request.caller, request.drafts)
    parts = Parts(configuration, model, bindings)
    plant_model: Model | None = None
    plant_bindings: Bindings | None = None
    if request.plant is not None and request.plant_bindings is not None:
        plant_model = read_model(request.plant, diagnostics)
        plant_bindings = load_bindings(request.plant_bindings, diagnostics, request.caller)
        if plant_model is None or plant_bindings is None:
            return parts
    if configuration is None or model is None or bindings is None:
        return parts
    plant = PlantFiles(plant_model, plant_bindings) if plant_model and plant_bindings else None
    check_model_names(model, f"{request.name}_model", diagnostics)
    if plant is not None:
        check_model_names(plant.model, f"{request.name}_plant", diagnostics)
    application = resolve(request.name, configuration, model, bindings, plant, diagnostics)
    if application is not None:
        check_driver_headers(application, diagnostics)
        check_paths((*application.files, *request.user_roots), diagnostics)
    return parts if diagnostics.has_errors else replace(parts, application=application)


def hardware_of(application: Application) -> Hardware:
    """The hardware of all components and of the control loop."""
    found = {(c.name, claim): assignment for c in application.components for claim, assignment in c.claims.items()}
    return found | ({TICK: application.tick} if application.tick else {})


def check_name(name: str, span: Span, diagnostics: Diagnostics) -> None:
    """A target's name becomes the prefix of C symbols, the name of a header and a CMake target."""
    problem = identifier_problem(name)
    if problem is None and name in STANDARD_HEADERS:
        problem = f"would make a header '{name}.h', which hides the C library's: choose another name"
    elif problem is None and name in SYSTEM_LIBRARIES:
        problem = (
            "is the name of a system library: CMake would link this target wherever that is meant; choose another name"
        )
    elif problem is None and {f"{name}_inputs", f"{name}_outputs"} & STATIC_NAMES:
        problem = f"would make a symbol '{name}_outputs', which generated code has inside: choose another name"
    if problem:
        diagnostics.error("invalid-name", span, f"target '{name}' {problem}")


def check_library_name(name: str, span: Span, diagnostics: Diagnostics) -> None:
    """The name of a model's library also becomes a type ``<name>_t``."""
    check_name(name, span, diagnostics)
    if f"{name}_t" in STANDARD_TYPES:
        message = f"target '{name}' would make a type '{name}_t', which is one of the C library's"
        diagnostics.error("invalid-name", span, message, hint=f"choose another name, such as {name}_model")


def check_model_names(model: Model, library: str, diagnostics: Diagnostics) -> None:
    """No port is called like a macro in the header of the model's ``library`` or of the target it belongs to."""
    macros = {f"{library}_{word}".upper() for word in ("step_size", "instances", "parameters")}
    macros |= {f"{library.rpartition('_')[0]}_{word}".upper() for word in ("epg_version", "hash")}
    for port in (*model.inputs, *model.outputs):
        if port.identifier in macros:
            message = f"{port.direction} '{port.name}' is called like a macro of the generated header"
            diagnostics.error("invalid-name", port.span, message, hint="rename the port or the target")


def check_sdk_headers(name: str, target: Target, span: Span, diagnostics: Diagnostics) -> None:
    """No generated header hides one of the SDK's."""
    for header in sorted(_generated_headers(name).intersection(target.platform.headers)):
        message = f"target '{name}' makes a header '{header}', which would hide one that {target.name} needs"
        diagnostics.error("invalid-name", span, message, hint=f"choose another name, such as {name}_robot")


def _generated_headers(name: str) -> set[str]:
    ends = ("", "_version", "_model", "_model_export", "_model_names", "_plant", "_plant_export")
    return {f"{name}{end}.h" for end in ends}


def check_driver_headers(application: Application, diagnostics: Diagnostics) -> None:
    """No generated header is called like one of a driver that it is compiled with."""
    name = application.name
    generated = _generated_headers(name)
    for component in application.components:
        for header in sorted(generated.intersection(component.kind.headers)):
            message = f"component '{component.name}' needs a header '{header}', and target '{name}' makes one"
            diagnostics.error("invalid-name", component.span, message, hint="choose another name for the target")
    communication = application.communication
    for middleware in communication.middlewares:
        for header in sorted(generated.intersection(middleware.headers)):
            message = f"middleware '{middleware.name}' needs a header '{header}', and target '{name}' makes one"
            diagnostics.error("invalid-name", communication.span, message, hint="choose another name for the target")


def check_paths(paths: Iterable[Path], diagnostics: Diagnostics) -> None:
    """Paths that CMake is told can be named there, and in the files that it writes for Ninja and Make."""
    for path in sorted(paths):
        text = str(path.absolute())
        problem = cmake_path_problem(text)
        if problem:
            message = f"'{text}' cannot be named in CMake: {problem}"
            diagnostics.error("invalid-name", Span(str(path)), message, hint="rename the file or its folder")
            return


def check_target(request: Request, catalog: Catalog, diagnostics: Diagnostics) -> Hardware | None:
    """Checks a ``.tcf`` by itself; the hardware of its components and of the control loop.

    Without a model the control period may be unknown, and the loop's timer then has no settings.
    """
    configuration = load_configuration(request, catalog, diagnostics)
    if configuration is None:
        return None
    return allocate_hardware(configuration, configuration.control.period, diagnostics)


def check_instances(model: Model, instances: int, span: Span, diagnostics: Diagnostics) -> None:
    """Several instances need a model that keeps no state in globals."""
    if instances < 1 or instances > 255:
        diagnostics.error("out-of-range", span, f"{instances} instances: must be from 1 to 255")
    elif instances > 1 and not model.instantiable:
        is_fmu = isinstance(model.details, FmuExport)
        why = "can be instantiated once only" if is_fmu else "keeps its state in global variables"
        other = ": each has its own copy of its code" if is_fmu else ", or export it as a C++ class"
        diagnostics.error(
            "single-instance",
            model.span,
            f"{model.name} ({model.origin}) {why}: there can be one instance",
            hint="call epg_add_model once for each, with different names" + other,
        )
