# SPDX-License-Identifier: Apache-2.0
"""``epg new``: writes a complete project for a model and a target, or for a system.  It builds without changes."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from epg.cli.arguments import user_roots
from epg.cli.report import to_json
from epg.cli.system import is_system, read_system
from epg.generator.diagnostics import Diagnostics
from epg.system import SYSTEM_FILES

if TYPE_CHECKING:
    from epg.new.new_project import NewProject


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of the project; made if it does not exist")
    what = parser.add_mutually_exclusive_group(required=True)
    target = "a target or a predefined .tcf; 'epg targets' lists both"
    what.add_argument("--target", metavar="NAME", help=target)
    system = f"a system (*{SYSTEM_FILES}): the project simulates it and builds its images"
    what.add_argument("--system", type=Path, metavar="FILE", help=system)
    model = "with --target: folder of the model; if it is outside of DIR, it is copied into DIR/model"
    parser.add_argument("--model", type=Path, metavar="FOLDER", help=model)
    parser.add_argument("--name", help="name of the project, a C identifier; default: made from DIR")
    middleware = "protocol of the topics; default: that of the .tcf, or the console"
    parser.add_argument("--middleware", metavar="NAME", help=middleware)


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    _check_options(options)
    return _new_system(options, diagnostics) if options.system else _new_project(options, diagnostics)


def _check_options(options: argparse.Namespace) -> None:
    """Refuses options that do not fit together, as argparse does."""
    if options.target and options.model is None:
        options.parser.error("the following arguments are required: --model")
    if options.system and not is_system(options.system):
        options.parser.error(f"argument --system: the name of a system ends with {SYSTEM_FILES}")
    for name in ("model", "name", "middleware"):
        if options.system and getattr(options, name) is not None:
            options.parser.error(f"argument --{name}: not allowed with argument --system")


def _new_system(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.new.new_system import write_system_project

    checked = diagnostics.checked(read_system(options.system, user_roots(), diagnostics))
    project = write_system_project(checked, options.folder, diagnostics)
    plan = project.plan
    if options.json:
        data = {"folder": options.folder.as_posix(), "name": plan.name, "targets": list(plan.targets)}
        sys.stdout.write(to_json({**data, "files": list(project.files)}))
        return 0
    print(
        f"wrote {options.folder}: {len(project.files)} files of the system {plan.name}, for {', '.join(plan.targets)}"
    )
    print(f"next:    {options.folder / 'README.md'}")
    return 0


def _new_project(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.new.new_project import ProjectRequest, check_project, write_project

    request = ProjectRequest(
        options.name, options.folder, options.target, options.model, options.middleware, user_roots()
    )
    project = write_project(request, diagnostics)
    check_project(project, request, diagnostics)
    if not options.json:
        _print(options.folder, project)
    elif not diagnostics.has_errors:
        plan = project.plan
        data = {
            "folder": options.folder.as_posix(),
            "name": plan.name,
            "target": plan.target.name,
            "model": plan.model,
            "model_copied": project.model_copied,
            "open": list(project.open),
            "files": list(project.files),
        }
        sys.stdout.write(to_json(data))
    return 0


def _print(folder: Path, project: NewProject) -> None:
    plan = project.plan
    print(f"wrote {folder}: {len(project.files)} files of the project {plan.name}, for {plan.target.name}")
    print(f"model:   {folder / plan.model} ({'a copy' if project.model_copied else 'not copied'})")
    for port in project.open:
        print(f"to bind: {port} (in {folder / plan.name}.bindings.yaml)")
    print(f"next:    {folder / 'README.md'}")
