# SPDX-License-Identifier: Apache-2.0
"""Plans the agents for a set of targets: one for each board, and one for all targets that use UDP.

A board on USB is identified by its serial number, because ``/dev/ttyACM0`` is the board that was plugged in first::

    /dev/serial/by-id/usb-Raspberry_Pi_Pico_E6614103E72B8C2F-if00
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import field

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.source import Span
from epg.runs.robot import HOST_SERIAL, Robot, RobotUsb, report_damaged

DEFAULT_BAUD_RATE = 115200
"""The default baud rate of a tty.  A board on USB accepts any rate."""

_COM_PORT = re.compile(r"(?:\\\\[.]\\)?(COM([1-9][0-9]{0,2}))", re.IGNORECASE | re.ASCII)
_NOT_ON_WINDOWS = (
    "run the agent in WSL2, to which usbipd gives the board, or on another computer, and name its tty there"
)
_BY_ID = "/dev/serial/by-id/usb-{name}_{serial}-if00"
"""The name that udev gives to the first port of a board.

It has the manufacturer, the product and the serial number of the USB descriptors, and the number of the interface, 0.
"""


@dataclass(frozen=True)
class Agent:
    """One process of an agent.

    ``program`` is the ROS 2 package of the agent, and its program.  ``device`` is the tty that it opens, or None for
    UDP.  ``serial`` is the serial number of a board on USB, else None.  ``serves`` are the targets that it connects.
    """

    name: str
    program: str
    arguments: tuple[str, ...]
    device: str | None
    serial: str | None
    serves: tuple[Robot, ...]


@dataclass(frozen=True)
class AgentSetup:
    """Facts that are not in a description: serial numbers of boards, and ttys, by name of the target; the UDP port.

    ``programs`` are the host programs of targets, which the launch file starts.
    """

    boards: Mapping[str, Sequence[str]]
    devices: Mapping[str, Sequence[str]]
    port: int = 8888
    programs: Mapping[str, Sequence[str]] = field(default_factory=dict)


def check_target_names(
    robots: Sequence[Robot], options: Mapping[str, Mapping[str, Sequence[str]]], diagnostics: Diagnostics
) -> None:
    """Reports names of targets in ``options`` that have no description.  ``options`` is by option, then by name."""
    names = {robot.name for robot in robots}
    for option, given in options.items():
        for name in given:
            if name not in names:
                span = Span.of_argument(f"{name}={given[name][0]}", option)
                hint = did_you_mean(name, names, "targets")
                diagnostics.error("unknown-target-name", span, f"there is no target '{name}'", hint=hint)


def plan_agents(robots: Sequence[Robot], setup: AgentSetup, diagnostics: Diagnostics) -> list[Agent]:
    """The agents that ``robots`` need, in the order of the robots.  The agent for UDP is the last one."""
    _refuse_equal_names(robots, diagnostics)
    agents: list[Agent] = []
    by_udp: dict[str, list[Robot]] = {}
    for robot in robots:
        if robot.agent and robot.name not in setup.devices and robot.transport == "udp":
            by_udp.setdefault(robot.agent, []).append(robot)
        else:
            agents += _agents_at_ttys(robot, setup, diagnostics)
    port = str(setup.port)
    for program, served in by_udp.items():
        agents.append(Agent(f"agent_udp_{port}", program, ("udp4", "-p", port), None, None, tuple(served)))
    _refuse_one_device_twice(agents, diagnostics)
    _warn_of_equal_nodes(robots, agents, setup, diagnostics)
    if not agents and not setup.programs and not diagnostics.has_errors:
        diagnostics.error("nothing-to-launch", Span("command line"), "none of these targets needs an agent")
    return agents


def _agents_at_ttys(robot: Robot, setup: AgentSetup, diagnostics: Diagnostics) -> list[Agent]:
    """The agents of a robot at ttys of this computer; none, after a message, if it needs no agent or has no tty."""
    if robot.agent is None:
        problem = "'communication.agent' is missing, as in files of an older EPG"
        report_damaged(Span(str(robot.file)), problem, diagnostics)
    elif not robot.agent:
        if robot.name not in setup.programs:
            _warn_of_no_agent(robot, diagnostics)
    elif robot.name in setup.devices:
        return [_on_device(robot, robot.agent, device, diagnostics) for device in setup.devices[robot.name]]
    elif robot.transport == "usb" and robot.usb is not None:
        return _on_usb(robot, robot.agent, robot.usb, setup.boards.get(robot.name, ()), diagnostics)
    else:
        _report_no_device(robot, diagnostics)
    return []


def _refuse_equal_names(robots: Sequence[Robot], diagnostics: Diagnostics) -> None:
    for name, count in Counter(robot.name for robot in robots).items():
        if count > 1:
            files = ", ".join(str(robot.file) for robot in robots if robot.name == name)
            diagnostics.error("duplicate-target-name", Span(files), f"{count} targets have the name '{name}'")
    diagnostics.stop_if_errors()


def _report_no_device(robot: Robot, diagnostics: Diagnostics) -> None:
    message = f"'{robot.name}' uses the transport '{robot.transport}': the tty of this computer is not known"
    hint = f"name it, for example --device {robot.name}=/dev/ttyAMA0:921600"
    if robot.transport == "usb":
        hint = f"configure its project again if an older EPG did so; otherwise {hint}"
    diagnostics.error("device-missing", Span(str(robot.file)), message, hint=hint)


def _warn_of_no_agent(robot: Robot, diagnostics: Diagnostics) -> None:
    hint = f"add --program {robot.name}=<path>: the launch file then starts its program"
    hint = hint if robot.platform == "host" else ""
    message = f"'{robot.name}' needs no agent: its middleware '{robot.middleware}' does not use one"
    diagnostics.warning("no-agent-needed", Span(str(robot.file)), message, hint=hint)


def _on_usb(robot: Robot, program: str, usb: RobotUsb, serials: Sequence[str], diagnostics: Diagnostics) -> list[Agent]:
    """The agents for the boards with these serial numbers, which all run the target ``robot``."""
    if not serials:
        message = f"'{robot.name}' uses USB: the serial number of its board is not known"
        hint = (
            f"'ls /dev/serial/by-id' shows the number while the board is plugged in; add --board {robot.name}=<number>"
        )
        diagnostics.error("board-missing", Span(str(robot.file)), message, hint=hint)
    agents = []
    for serial in serials:
        number = serial.upper() if usb.serial is None else serial
        span = Span.of_argument(f"{robot.name}={serial}", "--board")
        if usb.serial is None and not re.fullmatch(f"[0-9A-F]{{{usb.serial_digits}}}", number):
            message = f"'{serial}' is not the serial number of a board {robot.board}"
            hint = f"the serial number of a board {robot.board} has {usb.serial_digits} hexadecimal digits"
            diagnostics.error("wrong-serial-number", span, message, hint=hint)
            continue
        if usb.serial not in (None, serial):
            message = f"'{serial}' is not the serial number of '{robot.name}'"
            hint = f"'communication.usb' of its .tcf gives it the number '{usb.serial}'"
            diagnostics.error("wrong-serial-number", span, message, hint=hint)
            continue
        device = _BY_ID.format(name=usb.name, serial=number)
        agents.append(
            Agent(
                f"agent_{robot.name}_{number}",
                program,
                _serial_arguments(device, DEFAULT_BAUD_RATE),
                device,
                number,
                (robot.with_serial(number),),
            )
        )
    return agents


def _on_device(robot: Robot, program: str, text: str, diagnostics: Diagnostics) -> Agent:
    """The agent for a tty.  ``text`` is for example "/dev/ttyAMA0", "/dev/ttyAMA0:921600" or "COM3"."""
    device, _, rate = text.partition(":")
    span = Span.of_argument(f"{robot.name}={text}", "--device")
    com = _COM_PORT.fullmatch(device)
    if com is not None:
        device = com[1].upper() if len(com[2]) == 1 else rf"\\.\{com[1].upper()}"  # as CreateFile takes it
        message = f"'{device}' is a port of Windows: agents of ROS 2 open serial ports on Linux only"
        diagnostics.warning("agent-not-on-windows", span, message, hint=_NOT_ON_WINDOWS)
    if (
        not (device.startswith("/dev/") or com)
        or not device.isprintable()
        or not re.fullmatch("([1-9][0-9]{2,6})?", rate)
    ):
        hint = "write for example /dev/ttyAMA0 or /dev/ttyAMA0:921600, or COM3"
        diagnostics.error("wrong-device", span, f"'{text}' is not a tty, with or without a baud rate", hint=hint)
    stem = re.sub("[^0-9A-Za-z]+", "_", device.removeprefix("/dev/")).strip("_")
    arguments = _serial_arguments(device, int(rate or DEFAULT_BAUD_RATE))
    return Agent(f"agent_{robot.name}_{stem}", program, arguments, device, None, (robot,))


def _serial_arguments(device: str, rate: int) -> tuple[str, ...]:
    return ("serial", "-b", str(rate), "--dev", device)


def _refuse_one_device_twice(agents: Sequence[Agent], diagnostics: Diagnostics) -> None:
    users: dict[str, list[Agent]] = {}
    for agent in agents:
        users.setdefault(agent.device or f"UDP port {agent.arguments[-1]}", []).append(agent)
    for device, several in users.items():
        if len(several) > 1:
            names = ", ".join(f"'{robot.name}'" for agent in several for robot in agent.serves)
            diagnostics.error(
                "device-used-twice", Span("command line"), f"{device} is used by more than one agent: {names}"
            )


def _warn_of_equal_nodes(
    robots: Sequence[Robot], agents: Sequence[Agent], setup: AgentSetup, diagnostics: Diagnostics
) -> None:
    """Warns of robots whose nodes have the same name.

    They would receive the same setpoints, and a subscriber could not distinguish their positions.  The boards that
    the agents serve have different serial numbers; the programs that the launch file starts do not.
    """
    boards = [robot for agent in agents for robot in agent.serves if robot.name not in setup.programs]
    started = [robot.with_serial(HOST_SERIAL) for robot in robots for _ in setup.programs.get(robot.name, ())]
    nodes = Counter(robot.full_node for robot in [*boards, *started] if not robot.has_serial_in_names)
    for node, count in nodes.items():
        if count > 1:
            message = f"{count} robots have the same node '{node}' and therefore the same topics"
            hint = "write namespace: robot_$serial in the .tcf, or set a different name on each console"
            if node in {robot.full_node for robot in started}:
                hint = "launch each program in its own namespace: the launch file has an argument for each"
            diagnostics.warning("equal-nodes", Span("command line"), message, hint=hint)
