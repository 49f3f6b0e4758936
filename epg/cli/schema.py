# SPDX-License-Identifier: Apache-2.0
"""``epg schema``: writes the complete JSON Schemas of EPG's files, for editors."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from epg.cli.arguments import user_roots
from epg.cli.report import to_json
from epg.generator.diagnostics import Diagnostics


def add_arguments(parser: argparse.ArgumentParser) -> None:
    from epg.generator.check.editor_schemas import TARGET_FILES, USER_FILES

    names = (*USER_FILES, *TARGET_FILES)
    parser.add_argument(
        "names",
        nargs="*",
        metavar="NAME",
        help=f"kinds of files: {', '.join(names)}; default: tcf, or all with --folder",
    )
    place = parser.add_mutually_exclusive_group()
    place.add_argument("-o", "--output", type=Path, metavar="FILE", help="file to write; default: standard output")
    place.add_argument(
        "--folder", type=Path, metavar="FOLDER", help="folder to write, with <name>.schema.json for each kind"
    )


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.generator.check.editor_schemas import TARGET_FILES, USER_FILES
    from epg.generator.emit.writer import write_outputs

    known = (*USER_FILES, *TARGET_FILES)
    names = options.names or (known if options.folder else ("tcf",))
    problem = _problem(names, known, options.folder)
    if problem:
        sys.stderr.write(f"epg schema: {problem}; names: {', '.join(known)}\n")
        return 2
    schemas = _schemas(names, user_roots(), diagnostics)
    if not options.folder and not options.output:
        sys.stdout.write(schemas[names[0]])
        return 0
    files = _files(schemas) if options.folder else {options.output.name: schemas[names[0]]}
    written = write_outputs(options.folder or options.output.parent, files)
    if options.json:
        sys.stdout.write(to_json({"files": sorted(files), "written": written}))
    return 0


def write_editor_schemas(folder: Path) -> None:
    """Writes the schemas of the files that users write, with EPG's own kinds and boards: for a wheel, or a checkout."""
    from epg.generator.check.editor_schemas import USER_FILES
    from epg.generator.emit.writer import write_outputs

    write_outputs(folder, _files(_schemas(USER_FILES, (), Diagnostics())))


def _schemas(names: Sequence[str], own: Sequence[Path], diagnostics: Diagnostics) -> dict[str, str]:
    """The texts of the schemas, with the kinds and boards of the user's ``own`` folders, too."""
    from epg.generator.catalog.catalog import load_catalog
    from epg.generator.check.editor_schemas import editor_schema
    from epg.generator.data import targets_roots

    catalog = load_catalog(targets_roots(own), diagnostics)
    schemas = {name: to_json(editor_schema(name, catalog, built_in=not own)) for name in names}
    diagnostics.stop_if_errors()
    return schemas


def _files(schemas: Mapping[str, str]) -> dict[str, str]:
    return {f"{name}.schema.json": text for name, text in schemas.items()}


def _problem(names: Sequence[str], known: Sequence[str], folder: Path | None) -> str:
    """The reason why these schemas cannot be written; empty if they can be."""
    for name in names:
        if name not in known:
            return f"there is no kind of file '{name}'"
    return "--folder is needed for several schemas" if len(names) > 1 and folder is None else ""
