# SPDX-License-Identifier: Apache-2.0
"""Plans the host programs that a launch file starts.

A host program takes the arguments of ROS 2 (``--ros-args``), so ``launch_ros`` gives it its namespace and other names.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from epg.generator.check.names import topic_problem
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.source import Span
from epg.runs.robot import HOST_SERIAL, Robot


@dataclass(frozen=True)
class Program:
    """A host program that runs ``robot``, whose names have no ``$serial``.

    ``path`` is absolute, or relative to the folder of the launch file.
    """

    robot: Robot
    path: str
    arguments: tuple[str, ...]
    remappings: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class ProgramRequest:
    """The arguments of the command line by the name of the target: paths, and rules ``FROM:=TO``."""

    paths: Mapping[str, Sequence[str]]
    remappings: Mapping[str, Sequence[str]]
    folder: Path = Path()
    """The folder in which the launch file is written."""
    port: int = 8888
    """The UDP port of the agent that the same launch file starts."""


def plan_programs(robots: Sequence[Robot], request: ProgramRequest, diagnostics: Diagnostics) -> list[Program]:
    """The programs in the order of ``robots``.  The names of targets in ``request`` have been checked."""
    programs = []
    for robot in robots:
        remappings = _remappings(robot, request, diagnostics)
        for path in request.paths.get(robot.name, ()):
            span = Span.of_argument(f"{robot.name}={path}", "--program")
            if robot.platform != "host":
                message = f"'{robot.name}' runs on the board '{robot.board}', not as a program on this computer"
                diagnostics.error("not-a-program", span, message, hint="give its board by --board or --device")
            elif not Path(path).is_file():
                hint = "build it first; it is in the build folder, with the name in epg_add_executable()"
                diagnostics.error("file-not-found", span, f"there is no program '{path}'", hint=hint)
            else:
                agent = ("--agent", f"127.0.0.1:{request.port}") if robot.transport == "udp" else ()
                place = _place(path, request.folder)
                programs.append(Program(robot.with_serial(HOST_SERIAL), place, agent, remappings))
    return programs


def _place(path: str, folder: Path) -> str:
    """The path for the launch file in ``folder``, with slashes.  A relative path stays relative."""
    return path if Path(path).is_absolute() else Path(os.path.relpath(path, folder)).as_posix()


def _remappings(robot: Robot, request: ProgramRequest, diagnostics: Diagnostics) -> tuple[tuple[str, str], ...]:
    rules = request.remappings.get(robot.name, ())
    if rules and robot.name not in request.paths:
        span = Span.of_argument(f"{robot.name}={rules[0]}", "--remap")
        hint = f"add --program {robot.name}=<path>; the topics of a board are in its .tcf"
        diagnostics.error("wrong-remap", span, f"'{robot.name}' is not started by the launch file", hint=hint)
        return ()
    pairs = []
    for rule in rules:
        span = Span.of_argument(f"{robot.name}={rule}", "--remap")
        old, assigned, new = rule.partition(":=")
        known = [topic.name for topic in (*robot.subscriptions, *robot.publications)]
        problem = topic_problem(new) if assigned else None
        if not assigned:
            hint = f"write --remap {robot.name}=<topic>:=<new name>"
            diagnostics.error("wrong-remap", span, f"'{rule}' is not a rule", hint=hint)
        elif old not in known:
            hint = did_you_mean(old, known, "topics")
            diagnostics.error("wrong-remap", span, f"'{robot.name}' has no topic '{old}'", hint=hint)
        elif problem is not None:
            hint = "write for example /joystick/pan"
            diagnostics.error("wrong-remap", span, f"'{new}' {problem}", hint=hint)
        else:
            pairs.append((old, new))
    return tuple(pairs)
