# SPDX-License-Identifier: Apache-2.0
"""For commands that work with targets on a ROS 2 network: the target with its names there, and files to write."""

from __future__ import annotations

import argparse
import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from epg.cli.arguments import user_roots
from epg.cli.system import read_system
from epg.generator.diagnostics import Diagnostics
from epg.generator.source import Span

if TYPE_CHECKING:
    from epg.runs.robot import Robot


TARGET = "<name>.json of a target, or its build folder"


def add_robot_arguments(parser: argparse.ArgumentParser, help: str = TARGET) -> None:
    parser.add_argument("target", type=Path, metavar="TARGET", help=help)
    parser.add_argument("--board", metavar="SERIAL", help="serial number of the board, if names contain $serial")
    parser.add_argument("--namespace", help="namespace of the node, if it was changed on the console")
    parser.add_argument("--node", help="name of the node, if it was changed on the console")


def robot_of(options: argparse.Namespace, diagnostics: Diagnostics) -> Robot | None:
    """The target of the command, with the node and namespace that it has on the network.

    None, after an error, if there are several targets.
    """
    from epg.runs.robot import load_robots

    robots = load_robots([options.target], diagnostics)
    diagnostics.stop_if_errors()
    if len(robots) != 1:
        hint = "name one of them: " + ", ".join(str(robot.file) for robot in robots)
        diagnostics.error("several-targets", Span(str(options.target)), f"there are {len(robots)} targets", hint=hint)
        return None
    robot = robots[0]
    if options.board:
        pico = re.fullmatch("[0-9A-Fa-f]{16}", options.board)  # a Pico has capital letters in its serial number
        robot = robot.with_serial(options.board.upper() if pico else options.board)
    if options.namespace is not None:
        robot = replace(robot, namespace=f"/{options.namespace.strip('/')}" if options.namespace.strip("/") else "")
    if options.node:
        robot = replace(robot, node=options.node)
    _check_serial(robot, "add --board <serial number>", diagnostics)
    return robot


def robots_of_system(options: argparse.Namespace, diagnostics: Diagnostics) -> list[Robot]:
    """The targets of the system of the command, with the serial numbers of their boards in their names."""
    from epg.system.robots import boards_of, robots_of

    checked = read_system(options.target, user_roots(), diagnostics)
    for option in ("board", "namespace", "node"):
        value = getattr(options, option)
        if value is not None:
            place = Span.of_argument(value, f"--{option}")
            hint = "write it into the file of the system"
            diagnostics.error("several-targets", place, f"--{option} is for one target, not for a system", hint=hint)
    diagnostics.stop_if_errors()
    assert checked is not None
    boards = boards_of(checked)
    robots = [
        robot.with_serial(boards[robot.name][0]) if robot.name in boards else robot for robot in robots_of(checked)
    ]
    for robot in robots:
        _check_serial(robot, f"add the 'serial' of '{robot.name}' to this file", diagnostics)
    return robots


def _check_serial(robot: Robot, hint: str, diagnostics: Diagnostics) -> None:
    if robot.has_serial_in_names:
        message = f"the name of the node, '{robot.full_node}', contains the serial number of its board"
        diagnostics.error("board-unknown", Span(str(robot.file)), message, hint=hint)


def write_files(folder: Path, files: Mapping[str, str], force: bool, diagnostics: Diagnostics) -> None:
    """Writes all files.  Without ``force``, writes none and reports an error if an existing file would change."""
    for name, text in files.items():
        path = folder / name
        if not force and path.exists() and (not path.is_file() or path.read_bytes() != text.encode("utf-8")):
            diagnostics.error("file-exists", Span(str(path)), "this file exists", hint="--force overwrites it")
    diagnostics.stop_if_errors()
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text.encode("utf-8"))
