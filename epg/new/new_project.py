# SPDX-License-Identifier: Apache-2.0
"""``epg new``: makes a complete project for a model and a target, with the contents of all its files.

>>> # project = new_project(ProjectRequest("jiwy", Path("jiwy"), "rpi_pico_freertos_jiwy", Path("export")), diagnostics)
>>> # project.files["jiwy.tcf"], project.open
"""

from __future__ import annotations

import json
import os
import re
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import epg
from epg.edit.bindings_text import new_bindings
from epg.generator.catalog.catalog import Catalog, Computer, load_catalog, target_hint
from epg.generator.catalog.middleware import Middleware
from epg.generator.check.communication import CONSOLE
from epg.generator.check.configuration import Component, Configuration
from epg.generator.check.editor_schemas import USER_FILES, editor_schema
from epg.generator.check.middleware import first_middleware, needs_component, offered, unoffered_hint
from epg.generator.check.names import identifier_problem, project_folder_problem
from epg.generator.check.target_names import check_name, check_sdk_headers
from epg.generator.data import data_folder, targets_roots
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.tcf import load_tcf_chain
from epg.generator.documents.text_file import is_file
from epg.generator.emit.folder import present_files, write_folder
from epg.generator.emit.project_files import ProjectPlan, StandIn, project_files, project_folder, project_names
from epg.generator.importers import Model, load_model
from epg.generator.project import Request, load_application, load_configuration
from epg.generator.resolve.first_fit import first_fit
from epg.generator.resolve.matching import Match, match_ports
from epg.generator.source import Span
from epg.generator.tools.tools import load_tools
from epg.new.new_simulation import model_axes, plant_files, robot_axes, robot_folder

MODEL = "model"
"""The folder in the project that takes a copy of a model from outside of the project."""
IMPORT = "epg_import.cmake"
_EDITOR_SETTINGS = ".vscode/settings.json"
"""The file of the project that tells an editor which schema belongs to which files."""

_SHOWN = 3
"""The number of files that a message lists."""

UNBOUND = frozenset(("unbound-input", "unbound-output", "needs-bound"))
"""The ids of diagnostics about ports without a component."""


@dataclass(frozen=True)
class ProjectRequest:
    """The arguments of ``epg new``.

    If ``name`` is None, the project has the name of ``folder``.  If ``middleware`` is None, EPG chooses one.
    """

    name: str | None
    folder: Path
    target: str
    model: Path
    middleware: str | None = None
    user_roots: Sequence[Path] = ()

    @property
    def roots(self) -> tuple[Path, ...]:
        return targets_roots(self.user_roots)


@dataclass(frozen=True)
class NewProject:
    """A project that is not written yet.

    ``files`` maps names below the project's folder to contents.  ``open`` lists the ports that could not be bound.
    """

    plan: ProjectPlan
    files: Mapping[str, bytes]
    open: tuple[str, ...]
    model_copied: bool


@dataclass(frozen=True)
class _Base:
    """The start of a project: a target, and the predefined configuration ``extends`` if the user named one.

    ``middleware`` is the name to write into the project's ``.tcf``, and ``written`` is this middleware.  If the
    middleware of the predefined configuration stays, ``middleware`` is empty and ``written`` is None.
    """

    target: Computer
    templates: Path
    extends: str
    configuration: Configuration | None
    middleware: str
    written: Middleware | None

    @property
    def components(self) -> Mapping[str, Component]:
        """The components of the predefined configuration."""
        return {} if self.configuration is None else self.configuration.components

    @property
    def used(self) -> Middleware | None:
        """The middleware that the project will have."""
        if self.written is not None or self.configuration is None:
            return self.written
        return self.configuration.communication.middleware

    def has_console(self, catalog: Catalog) -> bool:
        """True if the user can type commands to the firmware."""
        if self.used is not None and self.used.name == CONSOLE:
            return True
        if self.configuration is not None and self.written is None:
            return self.configuration.communication.console is not None
        console = catalog.find_middleware(CONSOLE)
        ways = self.target.platform.middlewares.get(CONSOLE)
        if console is None or ways is None or self.used is None or not self.used.is_node:
            return False
        return not needs_component(console, self.target, ways)


def new_project(request: ProjectRequest, diagnostics: Diagnostics) -> NewProject | None:
    """Makes the project without writing its files.  Returns None after reporting mistakes in the request."""
    name = project_name(request.folder) if request.name is None else request.name
    check_name(name, Span.of_argument(name), diagnostics)
    problem = project_folder_problem(os.path.abspath(request.folder))
    if problem:
        message = f"'{request.folder}' cannot be the folder of a project: {problem}"
        diagnostics.error("invalid-name", Span(str(request.folder)), message, hint="choose another folder")
    catalog = load_catalog(request.roots, diagnostics)
    base = _find_base(request, catalog, diagnostics)
    model = load_model(request.model, diagnostics)
    if base is None or model is None:
        return None
    check_sdk_headers(name, base.target, Span.of_argument(name), diagnostics)
    place, copied = _model_files(request, model, diagnostics)
    if diagnostics.has_errors:
        return None
    if copied:
        model = _copied_model(copied, place)
    project = _make(_plan(name, base, model, place, request, catalog), base, copied, model, request.roots)
    if _EDITOR_SETTINGS not in project.files:
        return project
    schemas = _editor_schemas(catalog, built_in=not request.user_roots)
    return replace(project, files=dict(sorted({**project.files, **schemas}.items())))


def write_project(request: ProjectRequest, diagnostics: Diagnostics) -> NewProject:
    """Writes a new project: either all of its files or none.  Existing files are never replaced.

    Raises :class:`~epg.generator.diagnostics.UserError`; then nothing was written.
    """
    project = diagnostics.checked(new_project(request, diagnostics))
    refuse_present(request.folder, project.files, diagnostics)
    write_folder(request.folder, project.files)
    return project


def refuse_present(folder: Path, files: Iterable[str], diagnostics: Diagnostics) -> None:
    """Stops after reporting those of ``files`` that ``folder`` has already."""
    present = present_files(folder, files)
    if len(present) == 1:
        hint = "no file was written: 'epg new' does not replace files"
        diagnostics.error("file-exists", Span(str(present[0])), "this file exists", hint=hint)
    elif present:
        names = ", ".join(path.relative_to(folder).as_posix() for path in present[:_SHOWN])
        more = f" and {len(present) - _SHOWN} more" if len(present) > _SHOWN else ""
        hint = "no file was written: 'epg new' does not replace files; name a new folder"
        message = f"this folder already has files of the project: {names}{more}"
        diagnostics.error("file-exists", Span(str(folder)), message, hint=hint)
    diagnostics.stop_if_errors()


def check_project(project: NewProject, request: ProjectRequest, diagnostics: Diagnostics) -> None:
    """Adds the diagnostics of ``epg check`` about a project that was written.

    Diagnostics about ports without a component are left out: a new project may have them.  A diagnostic about the
    original of a copied model is removed if the same one is reported for the copy.
    """
    problems = Diagnostics()
    load_application(_application_request(project.plan, request.folder, request), problems)
    repeated = {(problem.id, problem.message) for problem in problems}
    diagnostics.items[:] = [item for item in diagnostics if (item.id, item.message) not in repeated]
    diagnostics.items.extend(problem for problem in problems if not project.open or problem.id not in UNBOUND)


def project_name(folder: Path) -> str:
    """A C identifier made of the name of a folder: ``my robot`` gives ``my_robot``."""
    name = re.sub(r"[^A-Za-z0-9]+", "_", Path(os.path.abspath(folder)).name).strip("_")
    return f"robot_{name}".rstrip("_") if not name or name[0].isdigit() else name


def _find_base(request: ProjectRequest, catalog: Catalog, diagnostics: Diagnostics) -> _Base | None:
    """The target or the predefined configuration that the request names, or None after reporting mistakes."""
    name = request.target
    targets, files = catalog.target_names(), catalog.configuration_names()
    extends = "" if name in targets else f"{name.removesuffix('.tcf')}.tcf"
    configuration = None
    if not extends:
        target = catalog.find_target(name)
    elif extends in files:
        predefined = Request("new", extends, Path(), Path(), user_roots=request.user_roots, beside=request.roots[-1])
        configuration = load_configuration(predefined, catalog, diagnostics, pins_required=False)
        target = configuration.target if configuration is not None else None
    else:
        _report_unknown(request, targets, catalog, [file.removesuffix(".tcf") for file in files], diagnostics)
        return None
    if target is None:
        return None
    templates = project_folder(target.platform.project_names, request.roots)
    if templates is None:
        message = f"'epg new' cannot make a project for the platform '{target.platform.name}'"
        hint = f"it supports {', '.join(project_names(request.roots))}; for others, docs/cmake.md describes the files"
        diagnostics.error("no-project", Span.of_argument(name), message, hint=hint)
        return None
    middleware = _choose_middleware(target, configuration, request.middleware, catalog, diagnostics)
    written = catalog.find_middleware(middleware) if middleware else None
    return _Base(target, templates, extends, configuration, middleware, written)


def _report_unknown(
    request: ProjectRequest, targets: Sequence[str], catalog: Catalog, files: Sequence[str], diagnostics: Diagnostics
) -> None:
    """Reports a name that is neither a target nor one of the predefined ``files``: it can be a file of the user."""
    name = request.target
    message = f"there is no target '{name}'"
    own = next((path for path in (Path(name), Path(f"{name}.tcf")) if is_file(path)), None)
    if own is None:
        hint = target_hint(name, catalog, files)
    else:
        chain = load_tcf_chain(own.name, request.roots, Diagnostics(), beside=own.parent)
        named = next((str(file.node["target"].value) for file in chain if "target" in file.node), "")
        message = f"'{name}' is a file, but 'epg new' takes the name of a target and writes a new .tcf for it"
        hint = f"write '--target {named}', the target of this file" if named in targets else "'epg targets' lists them"
    diagnostics.error("unknown-target", Span.of_argument(name), message, hint=hint)


def _choose_middleware(
    target: Computer,
    configuration: Configuration | None,
    wanted: str | None,
    catalog: Catalog,
    diagnostics: Diagnostics,
) -> str:
    """The name of the middleware to write into the project's ``.tcf``; "" to keep the one of ``configuration``.

    The middleware ``wanted`` by the user comes first.  The one of ``configuration`` stays if it can be built.
    Otherwise it is the first middleware of the platform that can be built, or "none".
    """
    possible = offered(target, catalog)
    if wanted is not None:
        if wanted not in possible:
            hint = unoffered_hint(wanted, possible, catalog)
            message = f"{target.name} has no middleware '{wanted}'"
            diagnostics.error("unknown-middleware", Span.of_argument(wanted), message, hint=hint)
        return wanted
    if configuration is not None and configuration.communication.middleware.builds:
        return ""
    return first_middleware(target, catalog)


def _model_files(request: ProjectRequest, model: Model, diagnostics: Diagnostics) -> tuple[str, dict[str, bytes]]:
    """The place of the model relative to the project, and the files to copy there.

    There are no files to copy if the model is inside of the project already.
    """
    place, root = Path(os.path.realpath(request.model)), Path(os.path.realpath(request.folder))
    if place == root or root in place.parents:
        return place.relative_to(root).as_posix(), {}
    around = place if place.is_dir() else place.parent
    copied = {}
    for file in model.files:
        path = Path(os.path.realpath(file))
        if around in path.parents:
            copied[f"{MODEL}/{path.relative_to(around).as_posix()}"] = path.read_bytes()
        else:
            message = f"the model needs this file, but it is not in the model's folder '{around.name}'"
            hint = f"put the whole model into '{request.folder}' and name it there: then no file is copied"
            diagnostics.error("model-outside", Span(str(file)), message, hint=hint)
    return (MODEL if place.is_dir() else f"{MODEL}/{place.name}"), copied


def _plan(name: str, base: _Base, model: Model, place: str, request: ProjectRequest, catalog: Catalog) -> ProjectPlan:
    transports = offered(base.target, catalog).get(base.middleware, ())
    components = list(base.components.values())
    tools = load_tools(request.roots, Diagnostics())
    return ProjectPlan(
        name=name,
        target=base.target,
        extends=base.extends,
        middleware=base.middleware,
        transport=transports[0] if transports else "null",
        console=base.has_console(catalog),
        agent="" if base.used is None else base.used.agent,
        model=place,
        model_name=model.name,
        stand_ins=(),
        subscriptions=[str(c.parameters["topic"]) for c in components if c.kind.communication == "subscribe"],
        actuators=[c.name for c in components if any(port.drive for port in c.kind.ports)],
        carriers=[c.name for c in components if c.kind.transport],
        pins=_free_pins(base.configuration),
        versions={"epg": epg.__version__, **{tool.name: tool.tested for tool in tools.values() if tool.tested}},
    )


def _free_pins(configuration: Configuration | None) -> Mapping[str, Mapping[str, str]]:
    """Pins for the components without pins, by component and signal; empty if there are no free pins for all."""
    found = (configuration and first_fit(configuration, configuration.control.period)) or {}
    pins: dict[str, dict[str, str]] = {}
    for (component, signal), pin in found.items():
        pins.setdefault(component, {})[signal] = pin
    return pins


def _make(
    plan: ProjectPlan, base: _Base, copied: Mapping[str, bytes], model: Model, roots: Sequence[Path]
) -> NewProject:
    """Makes the texts of the project; ``model`` is the model as it will be in the project."""
    model_copied = bool(copied)
    if base.configuration is None:
        plan, matches = _with_stand_ins(plan, model)
    else:
        matches = match_ports(model, base.components)
        robot = robot_folder(plan.extends, roots)
        if robot is not None:
            used = {match.reference.partition(".")[0] for match in matches.values() if match.reference}
            plan = replace(plan, plant=True, axes=robot_axes(robot, base.components, used))
            simulation = "simulation/" if (base.templates / "simulation").is_dir() else ""
            copied = {**copied, **{simulation + name: data for name, data in plant_files(robot).items()}}
    texts = project_files(plan, base.templates, roots)
    texts[IMPORT] = (data_folder("cmake") / IMPORT).read_text(encoding="utf-8")
    texts[f"{plan.name}.bindings.yaml"] = new_bindings(model, matches)
    files = {**copied, **{name: text.encode() for name, text in texts.items()}}
    left = tuple(name for name, match in matches.items() if match.reference is None)
    return NewProject(plan, dict(sorted(files.items())), left, model_copied)


def _with_stand_ins(plan: ProjectPlan, model: Model) -> tuple[ProjectPlan, Mapping[str, Match]]:
    """The plan with a component that stands in for the robot at each port, and the matches of the ports with them."""
    stand_ins = _stand_ins(model)
    topics = {port: stand_in.name for port, stand_in in stand_ins.items() if stand_in.kind == "ros_subscriber"}
    axes = model_axes(model, topics)
    plan = replace(plan, stand_ins=list(stand_ins.values()), subscriptions=list(topics.values()), axes=axes)
    ports = (*model.inputs, *model.outputs)
    return plan, {port.name: Match(port, stand_ins[port.name].name, ()) for port in ports}


def _editor_schemas(catalog: Catalog, built_in: bool) -> dict[str, bytes]:
    """The schemas that the editor's settings name, with the kinds and boards of the catalog."""
    schemas = {name: json.dumps(editor_schema(name, catalog, built_in=built_in)) for name in USER_FILES}
    return {f".vscode/schemas/{name}.schema.json": f"{text}\n".encode() for name, text in schemas.items()}


def _copied_model(files: Mapping[str, bytes], place: str) -> Model:
    """Loads a model from its copied files.  The copy may have another name: a C model can be named after its folder."""
    with tempfile.TemporaryDirectory(prefix="epg-new-") as temporary:
        write_folder(Path(temporary) / "project", files)
        model = load_model(Path(temporary) / "project" / place, Diagnostics())
    assert model is not None, "it was loaded from its own place before"
    return model


def _component_name(port: str) -> str:
    """The name of the component for a port: the port's own name, if a component may have it."""
    return port if identifier_problem(port) is None else f"port_{port}"


def _stand_ins(model: Model) -> dict[str, StandIn]:
    """For each port of the model, by its name, a component that makes the port a topic."""
    kinds = {"input": "ros_subscriber", "output": "ros_publisher"}
    types = {"real": "", "integer": "int32", "boolean": "bool"}
    return {
        port.name: StandIn(_component_name(port.identifier), kinds[port.direction], types[port.type])
        for port in (*model.inputs, *model.outputs)
    }


def _application_request(plan: ProjectPlan, folder: Path, request: ProjectRequest) -> Request:
    """The request that CMake will make for the project in ``folder``."""
    inside = folder / plan.model
    return Request(
        plan.name,
        str(folder / f"{plan.name}.tcf"),
        inside if inside.exists() else request.model,
        folder / f"{plan.name}.bindings.yaml",
        user_roots=request.user_roots,
    )
