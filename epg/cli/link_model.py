# SPDX-License-Identifier: Apache-2.0
"""``epg link-model``: compiles and links the code of a model alone.  CMake calls it once, while it configures.

A file has the arguments, because they can be longer than a command line: a key, a tab and a value in each line.  The
key ``model`` is the last one: everything after it is the path of the model, because an FMU decides a part of this path,
and no part of it may count as another argument, such as an option of the compiler.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from epg.generator.diagnostics import Diagnostics
from epg.generator.source import Span


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", help="name of the model's library")
    parser.add_argument("--inputs", required=True, type=Path, metavar="FILE", help="file with the other arguments")
    parser.add_argument("--summary", required=True, type=Path, metavar="FILE", help="file for the memory of the model")


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.generator.emit.model.link_check import LinkInputs, check_link

    values: dict[str, list[str]] = {}
    text, _, model = options.inputs.read_text(encoding="utf-8").partition("\nmodel\t")
    for line in text.split("\n"):
        key, _, value = line.partition("\t")
        if value:
            values.setdefault(key, []).append(value)
    sizes = {key: int(values[key][0]) for key in ("ram", "flash") if key in values}
    inputs = LinkInputs(
        name=options.name,
        compiler=values["compiler"][0],
        archiver=values["archiver"][0],
        sections="sections" in values,
        flags=tuple(values.get("flag", ())),
        sources=tuple(Path(source) for source in values["source"]),
        include_dirs=tuple(Path(folder) for folder in values["include"]),
        forced_header=Path(values["forced"][0]),
        folder=options.inputs.parent,
        ram=sizes.get("ram"),
        flash=sizes.get("flash"),
        span=Span(model.rstrip("\n")),
    )
    memory = check_link(inputs, diagnostics)
    options.summary.write_text(str(memory or ""), encoding="utf-8")
    return 0
