# SPDX-License-Identifier: Apache-2.0
"""Diagnostics as SARIF 2.1.0.  GitHub, GitLab, Azure DevOps and editors show them beside the lines of the source.

Section numbers in this file are those of https://docs.oasis-open.org/sarif/sarif/v2.1.0/sarif-v2.1.0.html.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any
from urllib.parse import quote

import epg
from epg.cli.messages import PAGE, find_entry
from epg.cli.report import edits_of, to_json
from epg.generator.diagnostics import Diagnostic, Edit
from epg.generator.source import Span

SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
HOME_PAGE = "https://epg.dev"
"""The address of the published documentation.  The ``$id`` of each schema also begins with it."""

COMMAND_LINE = "command line"


def to_sarif(diagnostics: Iterable[Diagnostic], folder: Path) -> str:
    """A SARIF log with one run.  Paths of files below ``folder`` are relative to it; other paths are absolute."""
    ordered = sorted(diagnostics, key=lambda d: (d.span.file, d.span.line, d.span.column, d.id, d.message))
    rules = {id: index for index, id in enumerate(sorted({diagnostic.id for diagnostic in ordered}))}
    run = {
        "tool": {
            "driver": {
                "name": "EPG",
                "semanticVersion": epg.__version__,
                "informationUri": HOME_PAGE,
                "rules": [_rule(id) for id in rules],
            }
        },
        "columnKind": "unicodeCodePoints",
        "results": [
            {**_result(diagnostic, rules[diagnostic.id], folder), **_fixes(edits, folder)}
            for diagnostic, edits in zip(ordered, edits_of(ordered))
        ],
    }
    return to_json({"$schema": SCHEMA, "version": "2.1.0", "runs": [run]})


def _rule(id: str) -> dict[str, Any]:
    entry = find_entry(id)
    if entry is None:
        return {"id": id}
    return {
        "id": id,
        "shortDescription": {"text": entry.summary},
        "fullDescription": {"text": entry.text},
        "help": {"text": entry.text, "markdown": entry.text},
        "helpUri": f"{HOME_PAGE}/docs/{PAGE}#{entry.anchor}",
    }


def _result(diagnostic: Diagnostic, rule: int, folder: Path) -> dict[str, Any]:
    text = diagnostic.message + (f"\nhint: {diagnostic.hint}" if diagnostic.hint else "")
    result: dict[str, Any] = {
        "ruleId": diagnostic.id,
        "ruleIndex": rule,
        "level": diagnostic.severity,
        "message": {"text": text},
        "locations": [_location(diagnostic.span, folder)],
    }
    if diagnostic.notes:
        result["relatedLocations"] = [
            {"id": number, "message": {"text": note.message}, **_location(note.span, folder)}
            for number, note in enumerate(diagnostic.notes)
        ]
    return result


def _fixes(edits: Iterable[Edit], folder: Path) -> dict[str, Any]:
    """The proposed edits of files (3.55), of which one is to be chosen.

    An edit of the command line changes no file, so the log does not have it.
    """
    fixes = [_fix(edit, folder) for edit in edits if edit.span.file != COMMAND_LINE]
    return {"fixes": fixes} if fixes else {}


def _fix(edit: Edit, folder: Path) -> dict[str, Any]:
    line, column = edit.end
    region = {"startLine": edit.span.line, "startColumn": edit.span.column, "endColumn": column}
    if line > edit.span.line:
        region["endLine"] = line
    change = {
        "artifactLocation": {"uri": _uri(edit.span.file, folder)},
        "replacements": [{"deletedRegion": region, "insertedContent": {"text": edit.new}}],
    }
    return {"description": {"text": edit.sentence}, "artifactChanges": [change]}


def _location(span: Span, folder: Path) -> dict[str, Any]:
    if span.file == COMMAND_LINE:  # not a file, therefore a logical location (3.33)
        return {"logicalLocations": [{"fullyQualifiedName": span.text or COMMAND_LINE, "kind": "parameter"}]}
    physical: dict[str, Any] = {"artifactLocation": {"uri": _uri(span.file, folder)}}
    if span.line:
        physical["region"] = _region(span)
    return {"physicalLocation": physical}


def _region(span: Span) -> dict[str, int]:
    """The region of a span.  ``endColumn`` is one past the last character (3.30.8), as ``Span.end`` is."""
    region = {"startLine": span.line}
    if span.column:
        region |= {"startColumn": span.column, "endColumn": max(span.end, span.column + 1)}
    return region


def _uri(file: str, folder: Path) -> str:
    """A relative reference with ``/`` between names (3.4.3), or a URI ``file://`` for a file outside ``folder``."""
    path = Path(file)
    if path.is_absolute():
        try:
            path = path.relative_to(folder)
        except ValueError:
            return path.as_uri()
    return quote(path.as_posix())
