# SPDX-License-Identifier: Apache-2.0
"""Arguments that several subcommands share."""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from epg.generator.source import Span

if TYPE_CHECKING:
    from epg.generator.diagnostics import Diagnostics
    from epg.generator.project import Request


def add_target_arguments(parser: argparse.ArgumentParser, *, required: bool) -> None:
    """Adds the arguments for the files of a target, and for the values that replace those in the files."""
    parser.add_argument(
        "--tcf",
        required=required,
        metavar="FILE",
        help="target configuration: a file, or the name of a predefined .tcf",
    )
    parser.add_argument("--model", required=required, type=Path, metavar="FOLDER", help="folder of the model")
    parser.add_argument(
        "--bindings", required=required, type=Path, metavar="FILE", help="bindings of the model's ports"
    )
    parser.add_argument("--plant", type=Path, metavar="FOLDER", help="model of the plant, for targets on the host")
    parser.add_argument("--plant-bindings", type=Path, metavar="FILE", help="bindings of the plant's ports")
    parser.add_argument(
        "--ioc", type=Path, metavar="FILE", help="project file of STM32CubeMX of the program: pins and timers in use"
    )
    add_settings(parser)
    parser.add_argument("--node", help="name of the ROS 2 node; default: as in the .tcf")
    parser.add_argument("--namespace", help="namespace of the ROS 2 node; default: as in the .tcf")
    parser.add_argument("--caller", metavar="CMAKELISTS", help=argparse.SUPPRESS)
    parser.add_argument("--beside", type=Path, default=Path(), help=argparse.SUPPRESS)


def add_settings(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        dest="settings",
        metavar="KEY.KEY=VALUE",
        help="replace a value of the .tcf",
    )


def add_time_range(parser: argparse.ArgumentParser, begin: str, until: str) -> None:
    """Adds ``--from`` and ``--until``, whose meanings are ``begin`` and ``until``."""
    parser.add_argument("--from", type=float, default=-math.inf, dest="begin", metavar="SECONDS", help=begin)
    parser.add_argument("--until", type=float, default=math.inf, metavar="SECONDS", help=until)


def user_roots() -> list[Path]:
    """The folders of ``EPG_TARGETS_PATH``."""
    return [Path(folder) for folder in os.environ.get("EPG_TARGETS_PATH", "").split(os.pathsep) if folder]


def refuse_existing(files: Iterable[Path | None], force: bool, diagnostics: Diagnostics) -> None:
    """Reports those of the output files that exist, unless ``force`` overwrites them.  None: the file is not wanted."""
    for file in files:
        if file is not None and file.exists() and not force:
            diagnostics.error("file-exists", Span(str(file)), "this file exists", hint="--force overwrites it")


def request_of(arguments: argparse.Namespace, name: str) -> Request:
    """The request from the arguments of :func:`add_target_arguments`."""
    from epg.generator.project import request_of_options

    return request_of_options(name, vars(arguments), arguments.settings, user_roots())
