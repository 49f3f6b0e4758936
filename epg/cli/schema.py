# SPDX-License-Identifier: Apache-2.0
"""``epg schema``: writes the complete JSON Schemas of EPG's files, for editors."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from epg.cli.arguments import user_roots
from epg.cli.report import to_json
from epg.diagnostics import Diagnostics


def add_arguments(parser: argparse.ArgumentParser) -> None:
    from epg.check.editor import TARGET_FILES, USER_FILES

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
    from epg.catalog.catalog import load_catalog
    from epg.check.editor import TARGET_FILES, USER_FILES, editor_schema
    from epg.data import targets_roots
    from epg.emit.writer import write_outputs

    known = (*USER_FILES, *TARGET_FILES)
    names = options.names or (known if options.folder else ("tcf",))
    unknown = [name for name in names if name not in known]
    if unknown or (len(names) > 1 and not options.folder):
        problem = f"there is no kind of file '{unknown[0]}'" if unknown else "--folder is needed for several schemas"
        sys.stderr.write(f"epg schema: {problem}; names: {', '.join(known)}\n")
        return 2
    own = user_roots()
    catalog = load_catalog(targets_roots(own), diagnostics)
    schemas = {name: to_json(editor_schema(name, catalog, built_in=not own)) for name in names}
    diagnostics.stop_if_errors()
    if not options.folder and not options.output:
        sys.stdout.write(schemas[names[0]])
        return 0
    folder = options.folder or options.output.parent
    files = {f"{name}.schema.json" if options.folder else options.output.name: text for name, text in schemas.items()}
    written = write_outputs(folder, files)
    if options.json:
        sys.stdout.write(to_json({"files": sorted(files), "written": written}))
    return 0
