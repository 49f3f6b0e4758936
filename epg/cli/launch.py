# SPDX-License-Identifier: Apache-2.0
"""``epg launch``: writes a ROS 2 launch file, and systemd units, for agents of targets and for host programs."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from epg.cli.arguments import user_roots
from epg.cli.ros_target import write_files
from epg.cli.system import is_system, read_system
from epg.generator.diagnostics import Diagnostics
from epg.generator.source import Span

if TYPE_CHECKING:
    from epg.ros.agents import Agent
    from epg.runs.robot import Robot


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "targets",
        nargs="+",
        type=Path,
        metavar="TARGET",
        help="a build folder, a <name>.json of a generated target, or a system (*.system.yaml)",
    )
    parser.add_argument(
        "--board",
        action="append",
        default=[],
        metavar="NAME=SERIAL",
        help="serial number of the board that runs target NAME; repeat the option for each board",
    )
    parser.add_argument(
        "--device",
        action="append",
        default=[],
        metavar="NAME=DEVICE[:BAUD]",
        help="tty of target NAME, if it is not connected by USB; repeat the option for each target",
    )
    parser.add_argument(
        "--program",
        action="append",
        default=[],
        metavar="NAME=PATH",
        help="host program of target NAME, which the launch file starts; repeat the option for each program",
    )
    parser.add_argument(
        "--remap",
        action="append",
        default=[],
        metavar="NAME=FROM:=TO",
        help="another name for a topic of the host program of target NAME; repeat the option for each topic",
    )
    parser.add_argument("--port", type=_port, default=8888, help="UDP port of the agent; default: 8888")
    parser.add_argument(
        "--output", type=Path, default=Path(), metavar="FOLDER", help="folder to write; default: the current folder"
    )
    parser.add_argument("--force", action="store_true", help="overwrite existing files")
    units = parser.add_argument_group("services")
    units.add_argument("--systemd", action="store_true", help="also write systemd units, into FOLDER/systemd")
    units.add_argument("--user", type=_user, default="ubuntu", help="user that runs the agents; default: ubuntu")
    units.add_argument("--distribution", type=_distribution, default="jazzy", help="ROS 2 distribution; default: jazzy")
    units.add_argument(
        "--workspace",
        type=_workspace,
        metavar="FOLDER",
        help="folder in which the agent was built; default: /home/<user>/microros_ws",
    )
    units.add_argument("--domain", type=_domain, default=0, help="ROS_DOMAIN_ID; default: 0")


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.cli.report import to_json
    from epg.ros.agents import AgentSetup, check_target_names, plan_agents
    from epg.ros.launch_file import FILE_NAME, launch_file
    from epg.ros.programs import ProgramRequest, plan_programs
    from epg.ros.systemd_units import Installation, unit_files
    from epg.runs.robot import load_robots
    from epg.system.robots import boards_of, robots_of

    robots: list[Robot] = []
    boards: dict[str, list[str]] = {}
    for path in options.targets:
        system = read_system(path, user_roots(), diagnostics)
        if system is not None:
            robots += robots_of(system)
            boards |= boards_of(system)
        elif not is_system(path):
            robots += load_robots([path], diagnostics)
    given = {
        option: _assignments(option, texts, diagnostics)
        for option, texts in (
            ("--board", options.board),
            ("--device", options.device),
            ("--program", options.program),
            ("--remap", options.remap),
        )
    }
    diagnostics.stop_if_errors()
    given["--board"] = boards | given["--board"]
    check_target_names(robots, given, diagnostics)
    paths = given["--program"]
    wiring = AgentSetup(given["--board"], given["--device"], options.port, paths)
    agents = plan_agents(robots, wiring, diagnostics)
    request = ProgramRequest(paths, given["--remap"], options.output, options.port)
    programs = plan_programs(robots, request, diagnostics)
    diagnostics.stop_if_errors()
    files = {FILE_NAME: launch_file(agents, programs)}
    if options.systemd and not agents:
        hint = "remove --systemd: services are for agents, not for host programs"
        diagnostics.error("nothing-to-launch", Span("command line"), "none of these targets needs an agent", hint=hint)
        diagnostics.stop_if_errors()
    if options.systemd:
        _refuse_ports_of_windows(agents, diagnostics)
        workspace = options.workspace or f"/home/{options.user}/microros_ws"
        installation = Installation(options.user, options.distribution, workspace, options.domain)
        files |= {f"systemd/{name}": text for name, text in unit_files(agents, installation).items()}
    write_files(options.output, files, options.force, diagnostics)
    if options.json:
        data = [
            {
                "name": agent.name,
                "arguments": list(agent.arguments),
                "device": agent.device,
                "nodes": [robot.full_node for robot in agent.serves],
            }
            for agent in agents
        ]
        started = [{"node": program.robot.full_node, "path": program.path} for program in programs]
        sys.stdout.write(to_json({"agents": data, "programs": started, "files": list(files)}))
    else:
        print("wrote " + ", ".join(str(options.output / name) for name in files))
    return 0


def _refuse_ports_of_windows(agents: Sequence[Agent], diagnostics: Diagnostics) -> None:
    for agent in agents:
        if agent.device is not None and not agent.device.startswith("/dev/"):
            span = Span.of_argument(agent.device, "--device")
            message = f"'{agent.device}' is a port of Windows, which does not have systemd"
            diagnostics.error("wrong-device", span, message, hint="remove --systemd, or name a path in /dev")
    diagnostics.stop_if_errors()


def _assignments(option: str, texts: list[str], diagnostics: Diagnostics) -> dict[str, list[str]]:
    """The values of each name in arguments ``NAME=VALUE``, in the order in which they are given."""
    result: dict[str, list[str]] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not (name and equals and value):
            hint = f"write {option} <name of the target>=<value>"
            diagnostics.error(
                "not-an-assignment", Span.of_argument(text, option), f"'{text}' does not name a target", hint=hint
            )
            continue
        result.setdefault(name, []).append(value)
    return result


def _port(text: str) -> int:
    return _between(text, 1, 65535)


def _domain(text: str) -> int:
    return _between(text, 0, 232)


def _user(text: str) -> str:
    return _matching(text, r"[A-Za-z_][A-Za-z0-9_.-]*", "the name of a user")


def _distribution(text: str) -> str:
    return _matching(text, r"[a-z][a-z0-9_]*", "a ROS 2 distribution, such as jazzy")


def _workspace(text: str) -> str:
    if not text.isprintable():
        raise argparse.ArgumentTypeError("the name of a folder must be one line of text")
    return _matching(text, "/[^`]*", "an absolute path")


def _matching(text: str, pattern: str, what: str) -> str:
    if not re.fullmatch(pattern, text):
        raise argparse.ArgumentTypeError(f"'{text}' is not {what}")
    return text


def _between(text: str, low: int, high: int) -> int:
    number = int(text)
    if not low <= number <= high:
        raise argparse.ArgumentTypeError(f"must be from {low} to {high}, not {text}")
    return number
