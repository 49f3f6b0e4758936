# SPDX-License-Identifier: Apache-2.0
"""Starts a project for a model without one, with the functions and messages of ``epg new``."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from epg.connect.body import Refused, text
from epg.connect.projects import Job, find_jobs
from epg.generator.catalog.catalog import Catalog
from epg.generator.check.target_names import proposed_name
from epg.generator.diagnostics import Diagnostics, UserError
from epg.new.new_project import ProjectRequest, project_name, write_project


def proposal(model: Path, catalog: Catalog) -> dict[str, str]:
    """A folder and a name for a new project for ``model``.

    The folder is beside the model's and does not exist yet.  The name is one that every target of ``catalog`` can have.
    """
    around = model.resolve()
    around = around if around.is_dir() else around.parent
    words = [around.name.removesuffix(end) for end in ("_export", "-export") if around.name.endswith(end)]
    name = words[0] if words else f"{around.name}_project"
    folder, number = around.with_name(name), 2
    while os.path.lexists(folder):
        folder, number = around.with_name(f"{name}_{number}"), number + 1
    return {"folder": str(folder), "name": proposed_name(project_name(folder), catalog)}


def create(body: Mapping[str, object], model: Path, user_roots: Sequence[Path]) -> list[Job]:
    """Writes a new project, and returns its targets.

    Raises Refused if nothing could be written, or if the written project has a mistake that must be corrected in an
    editor.
    """
    folder = Path(os.path.expanduser(text(body, "folder").strip()))
    if not folder.is_absolute():
        folder = Path(os.path.abspath(model.resolve().parent / folder))
    middleware = text(body, "middleware", "") or None
    request = ProjectRequest(
        text(body, "name").strip(), folder, text(body, "configuration"), model, middleware, user_roots
    )
    diagnostics = Diagnostics()
    try:
        write_project(request, diagnostics)
    except UserError as problem:
        raise _refusal(problem.diagnostics) from None
    except OSError as error:
        raise Refused(f"cannot write {folder}: {error.strerror or error}", "choose another folder", 409) from None
    problems = Diagnostics()
    jobs = find_jobs(folder, problems)
    if not jobs:
        raise _refusal(problems)
    return jobs


def _refusal(diagnostics: Diagnostics) -> Refused:
    errors = [problem for problem in diagnostics if problem.severity == "error"]
    more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
    where = errors[0].span.file if errors and errors[0].id == "file-exists" else ""
    message = f"{where}: {errors[0].message}{more}" if where else f"{errors[0].message}{more}"
    return Refused(message, errors[0].hint, 409)
