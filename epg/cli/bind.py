# SPDX-License-Identifier: Apache-2.0
"""``epg bind``: writes bindings for ports whose names match, and updates bindings after a new export of the model."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from pathlib import Path

from epg.cli.arguments import user_roots
from epg.cli.report import to_json
from epg.generator.diagnostics import Diagnostics
from epg.generator.source import Span


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("model", type=Path, metavar="MODEL", help="folder of the model")
    parser.add_argument("tcf", metavar="TCF", help="target configuration: a file, or the name of a predefined .tcf")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="bindings to write; default: standard output")
    parser.add_argument("--update", action="store_true", help="update FILE: add new ports, comment removed ones out")


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.edit.bindings_text import new_bindings, updated_bindings
    from epg.edit.ends import references_of
    from epg.edit.yaml_edit import CannotEdit
    from epg.generator.catalog.catalog import load_catalog
    from epg.generator.documents.text_file import read_text
    from epg.generator.documents.yaml_file import parse_yaml
    from epg.generator.importers import load_model
    from epg.generator.project import Request, load_configuration
    from epg.generator.resolve.matching import match_ports

    request = Request("bind", options.tcf, options.model, Path(), user_roots=user_roots())
    catalog = load_catalog(request.roots, diagnostics)
    configuration = load_configuration(request, catalog, diagnostics)
    model = load_model(options.model, diagnostics)
    diagnostics.stop_if_errors()
    assert configuration is not None and model is not None
    if options.update:
        if options.output is None:
            sys.stderr.write("epg bind: --update needs the file to update: add -o FILE\n")
            return 2
        text = diagnostics.checked(read_text(options.output, diagnostics))
        bound = references_of(parse_yaml(text, str(options.output), Diagnostics()))
        matches = match_ports(model, configuration.components, bound)
        try:
            change = diagnostics.checked(updated_bindings(text, str(options.output), model, matches, diagnostics))
        except CannotEdit as problem:
            sys.stderr.write(f"epg bind: {options.output} was not changed: {problem}\n")
            sys.stderr.write("  write one 'port: component' on each line\n")
            return 1
        if change.text != text:
            options.output.write_text(change.text, encoding="utf-8", newline="")
        if options.json:
            sys.stdout.write(
                to_json({"added": list(change.added), "removed": list(change.removed), "open": list(change.open)})
            )
        else:
            _print_changes(change.added, change.removed, change.open)
        return 0
    matches = match_ports(model, configuration.components)
    text = new_bindings(model, matches)
    if options.output is None:
        sys.stdout.write(text)
        return 0
    if options.output.exists():
        span = Span(str(options.output))
        diagnostics.error("file-exists", span, "this file exists", hint="use --update to keep it and add new ports")
        return 1
    options.output.write_text(text, encoding="utf-8")
    open_ports = [port for port, match in matches.items() if match.reference is None]
    if options.json:
        sys.stdout.write(to_json({"written": str(options.output), "open": open_ports}))
    else:
        print(f"wrote {options.output}: {len(matches) - len(open_ports)} ports bound by name")
        _print_changes((), (), open_ports)
    return 0


def _print_changes(added: Iterable[str], removed: Iterable[str], left: Iterable[str]) -> None:
    added, removed, left = list(added), list(removed), list(left)
    for name in added:
        print(f"added:   {name}")
    for name in removed:
        print(f"removed: {name}")
    for name in left:
        print(f"to bind: {name}")
    if not (added or removed or left):
        print("all ports of the model are bound")
