# SPDX-License-Identifier: Apache-2.0
"""Writes systemd units for agents, which start when a board is plugged in and stop when it is unplugged.

systemd has a device unit for each tty, and for its name in ``/dev/serial/by-id``.  The unit of an agent is wanted by
the device unit and bound to it.  It therefore starts and stops without a rule for udev.
"""

from __future__ import annotations

import shlex
import string
from collections.abc import Sequence

from epg.generator.dataclass import dataclass
from epg.ros.agents import Agent
from epg.ros.launch_file import describe

RULES = "70-epg-boards.rules"


@dataclass(frozen=True)
class Installation:
    """The computer that runs the units: its user, ROS 2 distribution, workspace of the agent, and ROS domain."""

    user: str
    distribution: str
    workspace: str
    domain: int


def unit_files(agents: Sequence[Agent], installation: Installation) -> dict[str, str]:
    """All files to install, by name: units, rules for udev if boards are on USB, and a README with instructions."""
    files = {unit_name(agent): unit(agent, installation) for agent in agents}
    devices = ((agent.serves[0].usb, agent.serial) for agent in agents)
    boards = [(usb.vendor, serial) for usb, serial in devices if usb is not None and serial is not None]
    if boards:
        files[RULES] = udev_rules(boards)
    files["README.md"] = _readme(agents, installation, bool(boards))
    return files


def unit_name(agent: Agent) -> str:
    """The name of the unit of one agent."""
    return f"epg-{agent.name.replace('_', '-')}.service"


def unit(agent: Agent, installation: Installation) -> str:
    """The text of the unit of one agent."""
    setup = [f"/opt/ros/{installation.distribution}/setup.bash", f"{installation.workspace}/install/local_setup.bash"]
    steps = [f". {shlex.quote(file)}" for file in setup]
    steps.append("exec " + shlex.join(["ros2", "run", agent.program, agent.program, *agent.arguments]))
    after, bound, wanted = "network.target", "", "multi-user.target"
    if agent.device is not None:
        wanted = device_unit(agent.device)
        after = f"{wanted} {after}"
        bound = f"BindsTo={wanted}\n"
    comments = "".join(f"# {line}\n" for line in describe(agent))
    return f"""\
{comments}[Unit]
Description={agent.program} of {", ".join(robot.name for robot in agent.serves)}
{bound}After={after}
StartLimitIntervalSec=0

[Service]
User={installation.user}
SupplementaryGroups=dialout
Environment=ROS_DOMAIN_ID={installation.domain} XRCE_DOMAIN_ID_OVERRIDE={installation.domain}
ExecStart=/bin/bash -c {_quoted(" && ".join(steps))}
Restart=always
RestartSec=1

[Install]
WantedBy={wanted}
"""


def device_unit(path: str) -> str:
    """The name of the unit of a device, equal to the output of ``systemd-escape --path --suffix=device``.

    >>> device_unit("/dev/serial/by-id/usb-Pico_E66-if00")
    'dev-serial-by\\\\x2did-usb\\\\x2dPico_E66\\\\x2dif00.device'
    """
    kept = frozenset((string.ascii_letters + string.digits + ":_.").encode())
    trimmed = "/".join(part for part in path.split("/") if part)
    name = ""
    for position, byte in enumerate(trimmed.encode()):
        if byte == ord("/"):
            name += "-"
        elif byte not in kept or (position == 0 and byte == ord(".")):
            name += f"\\x{byte:02x}"
        else:
            name += chr(byte)
    return f"{name}.device"


def udev_rules(boards: Sequence[tuple[str, str]]) -> str:
    """Rules for udev that give boards to the group ``dialout``, and keep ModemManager away from them.

    ModemManager would send commands for modems to any tty.  ``boards`` are the vendor numbers of the USB devices (four
    hexadecimal digits) and the serial numbers.
    """
    lines = ["# Boards with an EPG target belong to the group dialout.  ModemManager must not treat them as modems."]
    for vendor, serial in boards:
        lines.append(
            f'SUBSYSTEM=="tty", ATTRS{{idVendor}}=="{vendor}", ATTRS{{serial}}=="{serial}", '
            'GROUP="dialout", MODE="0660", ENV{ID_MM_DEVICE_IGNORE}="1"'
        )
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    """One quoted word of ``ExecStart=``.  ``%`` and ``$`` are escaped, because systemd would expand them.

    Raises ValueError for text with a line end or another control character.
    """
    if not text.isprintable():
        raise ValueError(f"{text!r} is not one line of text")
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("%", "%%").replace("$", "$$")
    return f'"{escaped}"'


def _readme(agents: Sequence[Agent], installation: Installation, boards: bool) -> str:
    units = [unit_name(agent) for agent in agents]
    table = "\n".join(f"| `{unit_name(a)}` | {a.device or 'UDP port ' + a.arguments[-1]} |" for a in agents)
    rules = ""
    if boards:
        rules = f"""
The rules for udev give the boards to the group `dialout` and keep ModemManager from sending them modem commands:

```sh
sudo cp {RULES} /etc/udev/rules.d/
sudo udevadm control --reload
sudo udevadm trigger --subsystem-match=tty
```
"""
    return f"""\
# Agents as services

Written by `epg launch --systemd`, for the user `{installation.user}`, ROS 2 {installation.distribution}, the agent in
`{installation.workspace}` and ROS domain {installation.domain}.

| unit | connects |
|---|---|
{table}

A unit with a board starts when the board is plugged in, stops when it is unplugged, and is started again a second after
it has failed. Targets then reconnect without help.

## Install

The user must be allowed to open serial ports (log out and in again after this):

```sh
sudo usermod -aG dialout {installation.user}
```
{rules}
```sh
sudo cp *.service /etc/systemd/system/
sudo systemctl daemon-reload
sudo systemctl enable {" ".join(units)}
sudo systemctl start {" ".join(units)}
```

## Check

```sh
ls -l /dev/serial/by-id
systemctl status {units[0]}
journalctl -fu {units[0]}
```

## Remove

```sh
sudo systemctl disable --now {" ".join(units)}
```

and delete the files from `/etc/systemd/system`{" and `/etc/udev/rules.d`" if boards else ""}.
"""
