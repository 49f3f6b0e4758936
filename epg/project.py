"""From file names to an application: load, check and resolve, for callers such as the command line and tests.

>>> # request = Request("jiwy", tcf="host_jiwy.tcf", model=Path("model"), bindings=Path("jiwy.bindings.yaml"))
>>> # application = load_application(request, diagnostics)
>>> # files = epg.emit.outputs.application_outputs(application, request.roots, names)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from epg.check.bindings import Bindings, load_bindings
from epg.check.catalog import check_catalog
from epg.check.configuration import Configuration, check_configuration
from epg.check.names import identifier_problem
from epg.data import targets_roots
from epg.diagnostics import Diagnostics
from epg.load.catalog import Catalog, load_catalog
from epg.load.models import load_model
from epg.load.models.model import Model
from epg.load.tcf import load_tcf_chain, settings_node
from epg.resolve.application import Application
from epg.resolve.resolve import PlantFiles, allocate_hardware, resolve
from epg.source import Span


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

    @property
    def roots(self) -> tuple[Path, ...]:
        return targets_roots(self.user_roots)


def load_configuration(request: Request, catalog: Catalog, diagnostics: Diagnostics) -> Configuration | None:
    """The checked configuration of ``request.tcf`` with its settings."""
    chain = load_tcf_chain(request.tcf, request.roots, diagnostics, beside=request.beside, wanted_by=request.caller)
    settings = settings_node(request.settings, diagnostics)
    if not chain:
        return None
    return check_configuration(chain, settings, catalog, diagnostics)


def make_catalog(request_roots: Sequence[Path], diagnostics: Diagnostics) -> Catalog:
    """Boards, platforms and kinds below the given roots, checked."""
    catalog = load_catalog(request_roots, diagnostics)
    check_catalog(catalog, diagnostics)
    return catalog


def load_application(request: Request, diagnostics: Diagnostics) -> Application | None:
    """The application of ``request``, or None after reporting every problem of all its files."""
    check_name(request.name, request.caller or Span("command line"), diagnostics)
    catalog = make_catalog(request.roots, diagnostics)
    configuration = load_configuration(request, catalog, diagnostics)
    model = load_model(request.model, diagnostics)
    bindings = load_bindings(request.bindings, diagnostics, request.caller)
    plant_model: Model | None = None
    plant_bindings: Bindings | None = None
    if request.plant is not None and request.plant_bindings is not None:
        plant_model = load_model(request.plant, diagnostics)
        plant_bindings = load_bindings(request.plant_bindings, diagnostics, request.caller)
        if plant_model is None or plant_bindings is None:
            return None
    if configuration is None or model is None or bindings is None:
        return None
    plant = PlantFiles(plant_model, plant_bindings) if plant_model and plant_bindings else None
    application = resolve(request.name, configuration, model, bindings, plant, diagnostics)
    return None if diagnostics.has_errors else application


def check_name(name: str, span: Span, diagnostics: Diagnostics) -> None:
    """A target's name becomes the prefix of C symbols and a CMake target."""
    problem = identifier_problem(name)
    if problem:
        diagnostics.error("invalid-name", span, f"target '{name}' {problem}")


def check_target(request: Request, catalog: Catalog, diagnostics: Diagnostics) -> Configuration | None:
    """Checks a ``.tcf`` by itself, hardware included; without a model the control period may be unknown."""
    configuration = load_configuration(request, catalog, diagnostics)
    if configuration is not None:
        allocate_hardware(configuration, configuration.control.period, diagnostics)
    return configuration


def check_instances(model: Model, instances: int, span: Span, diagnostics: Diagnostics) -> None:
    """Several instances need a model that keeps no state in globals."""
    if instances < 1 or instances > 255:
        diagnostics.error("out-of-range", span, f"{instances} instances: must be from 1 to 255")
    elif instances > 1 and not model.instantiable:
        diagnostics.error(
            "single-instance",
            model.span,
            f"{model.name} ({model.origin}) keeps its state in global variables: there can be one instance",
            hint="call epg_add_model once for each, with different names, or export it as a C++ class",
        )
