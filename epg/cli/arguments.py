# SPDX-License-Identifier: Apache-2.0
"""Arguments that several subcommands share."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING

from epg.documents.cmake_call import caller_span, setting_span

if TYPE_CHECKING:
    from epg.project import Request


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
        "--set",
        action="append",
        default=[],
        dest="settings",
        metavar="KEY.KEY=VALUE",
        help="replace a value of the .tcf",
    )
    parser.add_argument("--node", help="name of the ROS 2 node; default: as in the .tcf")
    parser.add_argument("--namespace", help="namespace of the ROS 2 node; default: as in the .tcf")
    parser.add_argument("--caller", metavar="CMAKELISTS", help=argparse.SUPPRESS)
    parser.add_argument("--beside", type=Path, default=Path(), help=argparse.SUPPRESS)


def user_roots() -> list[Path]:
    """The folders of ``EPG_TARGETS_PATH``."""
    return [Path(folder) for folder in os.environ.get("EPG_TARGETS_PATH", "").split(os.pathsep) if folder]


def request_of(arguments: argparse.Namespace, name: str) -> Request:
    """The request from the arguments of :func:`add_target_arguments`."""
    from epg.project import Request

    settings = list(arguments.settings)
    if arguments.node is not None:
        settings.append(f"node={arguments.node}")
    if arguments.namespace is not None:
        settings.append(f"namespace={arguments.namespace}")
    caller = caller_span(arguments.caller, name) if arguments.caller else None
    return Request(
        name=name,
        tcf=arguments.tcf or "",
        model=arguments.model or Path(),
        bindings=arguments.bindings or Path(),
        plant=arguments.plant,
        plant_bindings=arguments.plant_bindings,
        settings=[(text, setting_span(arguments.caller, name, text)) for text in settings],
        user_roots=user_roots(),
        caller=caller,
        beside=arguments.beside,
    )
