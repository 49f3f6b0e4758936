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
import shlex
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from epg.generator.check.names import identifier_problem, namespace_problem, node_name_problem, topic_problem
from epg.generator.correction import short
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.source import Span

SERIAL = "$serial"

HOST_SERIAL = "host"
"""The word that replaces ``$serial`` in the names of a host program without ``--serial``."""

_SIGNS = frozenset(("communication", "subscriptions", "publications"))
"""Keys of a description; a JSON file that has none of them is something else."""

_MOST = 1e9
"""The largest number of seconds in a description."""


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

    @property
    def fields(self) -> list[str]:
        """The names of the values inside the message: ``pan.position`` for ``joints/pan.position``."""
        return [value.removeprefix(self.name).removeprefix("/") for value in self.values]


@dataclass(frozen=True)
class RobotUsb:
    """The USB device of a target.

    ``name`` is its manufacturer and its product in the names of udev, such as ``Raspberry_Pi_Pico``.  ``vendor`` is its
    vendor number: four hexadecimal digits in lower case, as in sysfs.  ``serial`` is the serial number that its
    ``.tcf`` gives to it, None if it has the number of the board, which has ``serial_digits`` hexadecimal digits.
    """

    name: str
    vendor: str
    serial: str | None
    serial_digits: int


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
    agent: str | None
    """The ROS 2 package and program of its agent, "" if it needs none.  None if an older EPG wrote the description."""
    transport: str | None
    usb: RobotUsb | None
    """None if its description does not have all names and numbers, as those of older EPGs and of boards with Zephyr."""
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

    Targets in one folder are sorted by name.  Paths without a target are reported, and descriptions that are damaged.
    """
    robots = []
    for path in paths:
        if path.is_dir():
            errors = diagnostics.error_count
            found = [robot for file in description_files(path) if (robot := _read(file, diagnostics)) is not None]
            if not found and diagnostics.error_count == errors:
                hint = "configure and build it first, or name a <name>.json"
                diagnostics.error("no-description", Span(str(path)), "there is no generated target here", hint=hint)
            robots += sorted(found, key=lambda robot: robot.name)
        elif not path.exists():
            diagnostics.error("file-not-found", Span(str(path)), f"there is no file '{path}'")
        else:
            errors = diagnostics.error_count
            robot = _read(path, diagnostics)
            if robot is not None:
                robots.append(robot)
            elif diagnostics.error_count == errors:
                hint = "the description is in the build folder: epg/<name>/<name>.json"
                message = "this is not the description of a generated target"
                diagnostics.error("not-a-description", Span(str(path)), message, hint=hint)
    return robots


def description_files(folder: Path) -> list[Path]:
    """The JSON files at the places where CMake writes descriptions: in the build folder or those of subprojects."""
    return sorted({*folder.glob("epg/*/*.json"), *folder.glob("*/epg/*/*.json"), *folder.glob("*/*/epg/*/*.json")})


def _read(file: Path, diagnostics: Diagnostics) -> Robot | None:
    """The target that ``file`` describes.  None if it is not a description, or after an error if it is damaged."""
    try:
        data = json.loads(file.read_text(encoding="utf-8"))
    except json.JSONDecodeError as problem:
        if file.suffix == ".json":
            report_damaged(Span(str(file), problem.lineno, problem.colno), "it is not JSON from here on", diagnostics)
        return None
    except (OSError, ValueError, RecursionError):
        if file.suffix == ".json":
            report_damaged(Span(str(file)), "it cannot be read as JSON", diagnostics)
        return None
    if not isinstance(data, dict) or _SIGNS.isdisjoint(data):
        return None
    try:
        return robot_of(file, data)
    except DamagedDescription as problem:
        report_damaged(Span(str(file)), str(problem), diagnostics)
        return None


def report_damaged(span: Span, problem: str, diagnostics: Diagnostics) -> None:
    """Reports that a description is damaged, and the command that writes it again."""
    file = Path(span.file)
    build = next((folder for folder in file.parents if (folder / "CMakeCache.txt").is_file()), None)
    command = "configure the project again"
    if build is not None:
        quoted = shlex.quote(str(build))
        command = f'run "cmake {quoted}"' if quoted.startswith("'") else f"run 'cmake {quoted}'"
    message = f"this description of a target is damaged: {problem}"
    hint = f"{command}: CMake then writes this file again"
    diagnostics.error("description-damaged", span, message, hint=hint)


def robot_of(file: Path, data: dict[str, Any]) -> Robot:
    """The target in a description.  Raises DamagedDescription if a value of it is missing or wrong."""
    root = _Part(data, "")
    communication = root["communication"]
    agent, usb = communication.get("agent"), communication.get("usb")
    transport, control = communication.get("transport"), root.get("control")
    start = control.get("enable_at_start") if control else None
    return Robot(
        file=file,
        name=root["name"].name(identifier_problem),
        board=root["target"]["board"].name(_word_problem),
        platform=root["target"]["platform"].name(_word_problem),
        node=root["node"].name(node_name_problem),
        namespace=root["namespace"].name(namespace_problem),
        domain=communication.whole_of("domain", 232),
        enable_at_start=start is not None and start.value is True,
        period=communication["period"].number(least=1e-6),
        middleware=communication["middleware"].name(_word_problem),
        agent=agent.name(_word_problem) if agent else None,
        transport=transport.name(_word_problem) if transport else None,
        usb=_usb_device(usb) if usb else None,
        subscriptions=tuple(_topic(topic) for topic in root["subscriptions"].elements()),
        publications=tuple(_topic(topic) for topic in root["publications"].elements()),
        messages={name: text.text() for name, text in root.entries("messages").items()},
        wires=dict(_wire(wire) for key in ("inputs", "outputs") for wire in root.elements_of(key)),
    )


def _usb_device(data: _Part) -> RobotUsb | None:
    """The USB device, or None if a name or number is missing that its manufacturer or its port layer gives to it."""
    names = [data.text_of(key, "") for key in ("manufacturer", "product")]
    vendor, digits = data.whole_of("vendor_id", 0xFFFF), data.whole_of("serial_digits", 64)
    serial = data.get("serial")
    if "" in names or vendor is None or digits is None:
        return None
    name = "_".join(udev_name(text) for text in names)
    return RobotUsb(name, f"{vendor:04x}", udev_name(serial.text()) if serial else None, digits)


def udev_name(text: str) -> str:
    """A text of a USB device in the form that ``/dev/serial/by-id`` uses.

    udev replaces by "_" blanks and all characters other than letters, digits and ``#+-.:=@_``
    (systemd, src/shared/device-nodes.c, allow_listed_char_for_devnode()).

    >>> udev_name("Robots & Sons (Ltd)")
    'Robots___Sons__Ltd_'
    """
    return re.sub(r"[^A-Za-z0-9#+\-.:=@_]", "_", "_".join(text.split()))


def _topic(data: _Part) -> RobotTopic:
    timeout = data.get("timeout")
    topic = RobotTopic(
        name=data["topic"].name(topic_problem),
        type=data["type"].text(),
        qos=data["qos"].text(),
        role=data["role"].text(),
        values=tuple(part.text() for part in data["values"].elements()),
        elements=tuple(part.text() for part in data["elements"].elements()),
        component=data.text_of("component", ""),
        timeout=timeout.number() if timeout else 0.0,
        on_timeout=data.text_of("on_timeout", "hold"),
    )
    if topic.type == "std_msgs/msg/Float64MultiArray":
        for field in topic.fields:
            if field not in topic.elements:
                raise DamagedDescription(f"'{data.place}.elements' has no '{short(field)}'")
    elif "" in topic.fields and not topic.elements:
        raise DamagedDescription(f"'{data.place}.elements' is empty")
    return topic


def _wire(data: _Part) -> tuple[tuple[str, str], tuple[str, str]]:
    """The ends of a wire: ((component, port of the component), (port of the model, unit))."""
    unit = data["component_unit"].text() or data["unit"].text()
    return (data["component"].text(), data["component_port"].text()), (data["port"].text(), unit)


class DamagedDescription(ValueError):
    """A value of a description is missing or wrong: somebody or something has changed the file.

    The message names the value by its place in the file, such as 'communication.period'.
    """


@dataclass(frozen=True)
class _Part:
    """A value of a description, and its place in the file.  The methods raise DamagedDescription."""

    value: Any
    place: str

    def get(self, key: str) -> _Part | None:
        """The value of ``key``.  None if it is missing or null."""
        if not isinstance(self.value, dict):
            raise DamagedDescription(f"{self._named()} is not a map of names to values")
        found = self.value.get(key)
        return None if found is None else _Part(found, f"{self.place}.{key}".lstrip("."))

    def __getitem__(self, key: str) -> _Part:
        part = self.get(key)
        if part is None:
            raise DamagedDescription(f"'{f'{self.place}.{key}'.lstrip('.')}' is missing")
        return part

    def elements(self) -> list[_Part]:
        if not isinstance(self.value, list):
            raise DamagedDescription(f"{self._named()} is not a list")
        return [_Part(value, f"{self.place}[{index}]") for index, value in enumerate(self.value)]

    def elements_of(self, key: str) -> list[_Part]:
        """The elements of the list ``key``, which can be missing."""
        part = self.get(key)
        return part.elements() if part else []

    def entries(self, key: str) -> dict[str, _Part]:
        """The entries of the map ``key``, which can be missing."""
        part = self.get(key) or _Part({}, key)
        if not isinstance(part.value, dict):
            raise DamagedDescription(f"{part._named()} is not a map of names to values")
        return {name: part[name] for name in part.value}

    def text(self) -> str:
        if not isinstance(self.value, str):
            raise DamagedDescription(f"{self._named()} is not a text")
        return self.value

    def text_of(self, key: str, otherwise: str) -> str:
        """The text ``key``, which can be missing."""
        part = self.get(key)
        return part.text() if part else otherwise

    def name(self, problem: Callable[[str], str | None]) -> str:
        """A text that ``problem`` accepts, or an empty one.

        EPG checks names before it writes a description, but other programs can change the file.  Names are written into
        launch files and systemd units, where a line end in a name would add a command.
        """
        text = self.text()
        if text and problem(text) is not None:
            raise DamagedDescription(f"{self._named()} is not a possible name")
        return text

    def number(self, least: float = 0.0) -> float:
        known = isinstance(self.value, (int, float)) and not isinstance(self.value, bool)
        if not known or not least <= self.value <= _MOST:
            raise DamagedDescription(f"{self._named()} is not a possible number")
        return float(self.value)

    def whole(self, most: int) -> int:
        if type(self.value) is not int or not 0 <= self.value <= most:
            raise DamagedDescription(f"{self._named()} is not a whole number from 0 to {most}")
        return int(self.value)

    def whole_of(self, key: str, most: int) -> int | None:
        """The whole number ``key``; None if it is missing."""
        part = self.get(key)
        return part.whole(most) if part else None

    def _named(self) -> str:
        return f"'{self.place}'" if self.place else "the file"


def _word_problem(text: str) -> str | None:
    return None if re.fullmatch(r"[\w.+-]+", text) else "is not a word"
