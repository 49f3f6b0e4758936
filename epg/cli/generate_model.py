# SPDX-License-Identifier: Apache-2.0
"""``epg generate-model``: writes the library of one model into a build folder.  CMake calls it while it configures."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from epg.cli.output import add_output_arguments, update_folder, write_warnings
from epg.generator.diagnostics import Diagnostics
from epg.generator.source import Span


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", help="name of the library: prefix of its C symbols")
    parser.add_argument("--model", required=True, type=Path, metavar="FOLDER", help="folder of the model")
    parser.add_argument("--instances", type=int, default=1, metavar="N", help="instances of a C++ model")
    add_output_arguments(parser)
    parser.add_argument("--caller", help=argparse.SUPPRESS)


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.generator.check.model import check_instances, check_model_names
    from epg.generator.check.target_names import check_library_name, check_paths
    from epg.generator.emit.cmake import PathNames
    from epg.generator.emit.outputs import model_outputs
    from epg.generator.importers import load_model

    caller = Span(options.caller or "command line")
    check_library_name(options.name, caller, diagnostics)
    model = load_model(options.model, diagnostics)
    if model is not None:
        check_instances(model, options.instances, caller, diagnostics)
        check_model_names(model, options.name, diagnostics)
        check_paths(model.files, diagnostics)
    model = diagnostics.checked(model)
    files = model_outputs(model, options.name, options.instances, PathNames(options.source_dir))
    update_folder(options.output, files, sys.stdout if options.json else None)
    write_warnings(options.warnings, diagnostics)
    return 0
