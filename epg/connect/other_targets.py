# SPDX-License-Identifier: Apache-2.0
"""The other targets of a project that read a file of the open target, and the errors that a change makes in them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from epg.connect.projects import Job
from epg.generator.diagnostics import Diagnostic, Diagnostics
from epg.generator.documents.tcf import files_of, load_tcf_chain
from epg.generator.documents.text_file import NO_DRAFTS, Drafts
from epg.generator.project import Request, load_parts


def readers(path: Path, jobs: Sequence[Job]) -> list[Job]:
    """The ``jobs`` that read the file ``path``."""
    wanted = path.resolve()
    return [job for job in jobs if any(file.resolve() == wanted for file in _files(job.request))]


def _files(request: Request) -> Iterator[Path]:
    yield request.bindings
    chain = load_tcf_chain(request.tcf, request.roots, Diagnostics(), beside=request.beside)
    yield from files_of(chain)


def new_errors(texts: Mapping[Path, str], jobs: Sequence[Job]) -> dict[str, list[Diagnostic]]:
    """The errors that each of ``jobs`` gets if files have ``texts``, by the target's name; without those it has now."""
    errors_by_target = {}
    for job in jobs:
        drafts = {file: text for file in _files(job.request) for path, text in texts.items() if _same(file, path)}
        if drafts:
            now = {(each.id, each.message) for each in _errors(job.request, NO_DRAFTS)}
            errors = [each for each in _errors(job.request, drafts) if (each.id, each.message) not in now]
            errors_by_target[job.request.name] = errors
    return {name: errors for name, errors in errors_by_target.items() if errors}


def _same(file: Path, path: Path) -> bool:
    return file.resolve() == path.resolve()


def _errors(request: Request, drafts: Drafts) -> list[Diagnostic]:
    diagnostics = Diagnostics()
    load_parts(replace(request, drafts=drafts), diagnostics)
    return [each for each in diagnostics if each.severity == "error"]
