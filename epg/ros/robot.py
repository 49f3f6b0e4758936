# SPDX-License-Identifier: Apache-2.0
"""Reads the descriptions of generated targets (``<build>/epg/<name>/<name>.json``) for the tools for ROS 2.

>>> full_name("pan_subscriber", "/robot1", "JIWY_node")
'/robot1/pan_subscriber'
>>> full_name("~/enable", "", "JIWY_node"), full_name("/pan", "/robot1", "JIWY_node")
('/JIWY_node/enable', '/pan')
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from epg.check.names import identifier_problem, namespace_problem, node_name_problem, topic_problem
from epg.dataclass import dataclass
from epg.diagnostics import Diagnostics
from epg.source import Span

SERIAL = "$serial"

HOST_SERIAL = "host"
"""The word that replaces ``$serial`` in the names of a host program without ``--serial``."""

RASPBERRY_PI = 0x2E8A
"""The USB vendor number of a Pico whose ``.tcf`` does not set ``communication.usb``."""

PICO_DIGITS = 16
"""The hexadecimal digits of the serial number of a Pico."""

USB_NAMES = {"manufacturer": "Raspberry Pi", "product": "Pico"}
"""The texts of a Pico on USB without ``communication.usb``: targets/families/rp2/usb/include/tusb_config.h."""


@dataclass(frozen=True)
class RobotTopic:
    """A topic.  ``name`` is the name in the ``.tcf``.

    ``values`` are the names of its values in CSV files.  ``elements`` are the names of all elements of its message.
    ``component`` is the component with the topic, or empty.  ``timeout`` is the age in s from which a setpoint is too
    old, 0 for none, and ``on_timeout`` the action then.
    """

    name: str
    type: str
    qos: str
    role: str
    values: tuple[str, ...]
    elements: tuple[str, ...]
    component: str = ""
    timeout: float = 0.0
    on_timeout: str = "hold"


@dataclass(frozen=True)
class Robot:
    """One target.  ``node`` and ``namespace`` can contain ``$serial``.  ``domain`` is None for the default domain."""

    file: Path
    name: str
    board: str
    platform: str
    node: str
    namespace: str
    domain: int | None
    enable_at_start: bool
    period: float
    """The time between two publications, in s."""
    middleware: str
    transport: str | None
    usb_name: str
    """The manufacturer and the product of its USB device in the names of udev, such as ``Raspberry_Pi_Pico``."""
    usb_vendor: str
    """The vendor number of its USB device: four hexadecimal digits in lower case, as in sysfs."""
    usb_serial: str | None
    """The serial number that its ``.tcf`` gives to its USB device.  None if the device has the number of the board."""
    serial_digits: int
    """The hexadecimal digits of the number of the board."""
    subscriptions: tuple[RobotTopic, ...]
    publications: tuple[RobotTopic, ...]
    messages: Mapping[str, str]
    """The complete definitions of messages that components name, by type."""
    wires: Mapping[tuple[str, str], tuple[str, str]]
    """The model's port and the unit of each port of a component that is bound: (component, port) -> (port, unit)."""

    def with_serial(self, serial: str) -> Robot:
        """The same target, with the board's serial number in the names of its node and namespace."""
        return replace(self, node=self.node.replace(SERIAL, serial), namespace=self.namespace.replace(SERIAL, serial))

    @property
    def has_serial_in_names(self) -> bool:
        return SERIAL in self.node + self.namespace

    def topic(self, topic: RobotTopic) -> str:
        """The full name in ROS of one of its topics."""
        return full_name(topic.name, self.namespace, self.node)

    @property
    def full_node(self) -> str:
        return f"{self.namespace}/{self.node}"


def full_name(name: str, namespace: str, node: str) -> str:
    """The full name of a topic, as ``ros2 topic list`` shows it.

    ``name`` is absolute, private (``~/``) or relative to the namespace.
    """
    if name.startswith("/"):
        return name
    if name.startswith("~"):
        return f"{namespace}/{node}{name[1:]}"
    return f"{namespace}/{name}"


def load_robots(paths: list[Path], diagnostics: Diagnostics) -> list[Robot]:
    """The targets of the descriptions ``paths``, which are files or build folders.

    Targets in one folder are sorted by name.  Paths without a target are reported.
    """
    robots = []
    for path in paths:
        if path.is_dir():
            found = [robot for file in description_files(path) if (robot := _read(file)) is not None]
            if not found:
                hint = "configure and build it first, or name a <name>.json"
                diagnostics.error("no-description", Span(str(path)), "there is no generated target here", hint=hint)
            robots += sorted(found, key=lambda robot: robot.name)
        elif (robot := _read(path)) is not None:
            robots.append(robot)
        elif path.exists():
            hint = "the description is in the build folder: epg/<name>/<name>.json"
            message = "this is not the description of a generated target"
            diagnostics.error("not-a-description", Span(str(path)), message, hint=hint)
        else:
            diagnostics.error("file-not-found", Span(str(path)), f"there is no file '{path}'")
    return robots


def description_files(folder: Path) -> list[Path]:
    """The JSON files at the places where CMake writes descriptions: in the build folder or those of subprojects."""
    return sorted({*folder.glob("epg/*/*.json"), *folder.glob("*/epg/*/*.json"), *folder.glob("*/*/epg/*/*.json")})


def _read(file: Path) -> Robot | None:
    """The target that ``file`` describes.  None if it is not a description."""
    try:
        data = json.loads(file.read_text(encoding="utf-8"))
        return robot_of(file, data)
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None


def robot_of(file: Path, data: dict[str, Any]) -> Robot:
    """The target in a description.  Raises ValueError, KeyError or TypeError if it is not one."""
    communication = data["communication"]
    domain = communication.get("domain")
    if domain is not None and (type(domain) is not int or not 0 <= domain <= 232):
        raise ValueError("not a ROS domain")
    transport = communication["transport"]
    usb = communication.get("usb", {})
    return Robot(
        file=file,
        name=_checked(data["name"], identifier_problem),
        board=_checked(data["target"]["board"], _word_problem),
        platform=_checked(data["target"]["platform"], _word_problem),
        node=_checked(data["node"], node_name_problem),
        namespace=_checked(data["namespace"], namespace_problem),
        domain=domain,
        enable_at_start=data.get("control", {}).get("enable_at_start", False) is True,
        period=float(communication["period"]),
        middleware=_checked(communication["middleware"], _word_problem),
        transport=None if transport is None else _checked(transport, _word_problem),
        usb_name="_".join(udev_name(usb.get(key, text)) for key, text in USB_NAMES.items()),
        usb_vendor=f"{usb.get('vendor_id', RASPBERRY_PI):04x}",
        usb_serial=udev_name(usb["serial"]) if "serial" in usb else None,
        serial_digits=int(usb.get("serial_digits", PICO_DIGITS)),
        subscriptions=tuple(_topic(topic) for topic in data["subscriptions"]),
        publications=tuple(_topic(topic) for topic in data["publications"]),
        messages={str(name): str(text) for name, text in data.get("messages", {}).items()},
        wires={
            (wire["component"], wire["component_port"]): (
                str(wire["port"]),
                str(wire["component_unit"] or wire["unit"]),
            )
            for wire in [*data.get("inputs", []), *data.get("outputs", [])]
        },
    )


def udev_name(text: str) -> str:
    """A text of a USB device in the form that ``/dev/serial/by-id`` uses.

    udev replaces by "_" blanks and all characters other than letters, digits and ``#+-.:=@_``
    (systemd, src/shared/device-nodes.c, allow_listed_char_for_devnode()).

    >>> udev_name("Robots & Sons (Ltd)")
    'Robots___Sons__Ltd_'
    """
    return re.sub(r"[^A-Za-z0-9#+\-.:=@_]", "_", "_".join(text.split()))


def _topic(data: dict[str, Any]) -> RobotTopic:
    name = _checked(data["topic"], topic_problem)
    values, elements = tuple(data["values"]), tuple(data["elements"])
    component = data.get("component") or ""
    timeout, on_timeout = float(data.get("timeout", 0.0)), str(data.get("on_timeout", "hold"))
    return RobotTopic(name, data["type"], data["qos"], data["role"], values, elements, component, timeout, on_timeout)


def _checked(text: object, problem: Callable[[str], str | None]) -> str:
    """Returns ``text`` if ``problem`` accepts it.  Raises ValueError otherwise.

    EPG checks names before it writes a description, but other programs can change the file.  Names are written into
    launch files and systemd units, where a line end in a name would add a command.
    """
    if not isinstance(text, str) or (text and problem(text) is not None):
        raise ValueError(f"{text!r} is not a name")
    return text


def _word_problem(text: str) -> str | None:
    return None if re.fullmatch(r"[\w.+-]+", text) else "is not a word"
