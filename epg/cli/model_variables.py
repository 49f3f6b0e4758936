# SPDX-License-Identifier: Apache-2.0
"""``epg model-variables``: prepares the object files of a model for its restart.  CMake's build calls it."""

from __future__ import annotations

import argparse
from pathlib import Path

from epg.generator.diagnostics import Diagnostics


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", help="name of the model's library")
    parser.add_argument("objects", nargs="+", type=Path, metavar="OBJECT", help="object file of the model's own code")
    parser.add_argument("--instances", type=int, default=1, metavar="N", help="instances of the model")
    parser.add_argument("--output", required=True, type=Path, metavar="FOLDER", help="folder of the written files")


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.generator.emit.licence import with_licence
    from epg.generator.emit.model.variables import model_variables

    copies, table = model_variables(options.name, options.instances, options.objects, diagnostics)
    options.output.mkdir(parents=True, exist_ok=True)
    for index, (path, copy) in enumerate(zip(options.objects, copies, strict=True)):
        (options.output / f"{options.name}_{index}{path.suffix}").write_bytes(copy)
    for file, text in with_licence({f"{options.name}_export_variables.c": table}).items():
        (options.output / file).write_text(text, encoding="utf-8")
    return 0
