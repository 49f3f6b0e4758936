# SPDX-License-Identifier: Apache-2.0
"""Writes the images of a system to its boards, with the tools and arguments that the families of the chips name.

A swapped serial number would move the wrong robot, and boards with images of different builds may not understand each
other's messages.  Therefore no program is written before all images and all boards were checked:

1. Each target has an image that was built from the files as they are now, and a board.
2. Each board answers, has the expected chip, and has no program of another target.
3. Boards that run a program are restarted, and checked then.  Their outputs are off from now on.

After a mistake up to here, restarted boards start their programs again.
"""

from __future__ import annotations

import json
import re
import shlex
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import field
from pathlib import Path

from epg.generator.bootstrap import cache_folder
from epg.generator.catalog.platform import Flashing
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.emit.cmake import PathNames
from epg.generator.emit.outputs import application_outputs
from epg.generator.resolve.application import Application
from epg.generator.source import Span
from epg.generator.tools.find_tool import Surroundings, find_tool
from epg.generator.tools.tools import Tool, load_tools
from epg.generator.tools.usb_boards import NOT_LISTED, UsbDevice, attached
from epg.runs.robot import Robot, robot_of
from epg.system.check_system import CheckedSystem
from epg.system.images import built_hash, image_file, images_of
from epg.system.system import SystemTarget

PATIENCE = 10.0
"""The longest time in seconds in which a board must answer after a restart."""

_PAUSE = 0.5
_ARGUMENT = re.compile(r"\{(serial|bus|address|image|name|register)\}")


class UnusableTool(Exception):
    """A tool cannot reach boards at all.  ``tool`` is its name."""

    def __init__(self, tool: str) -> None:
        super().__init__(tool)
        self.tool = tool


@dataclass(frozen=True)
class FlashJob:
    """The image of the target ``name``, and its board.  ``span`` is the position of messages about it.

    ``board`` are the arguments that choose the board.  ``shown`` is the board in messages.
    """

    name: str
    span: Span
    application: Application
    flashing: Flashing
    image: Path
    board: tuple[str, ...]
    serial: str
    shown: str

    def arguments(self, which: Sequence[str]) -> list[str]:
        """The arguments ``which`` of the tool, for this image and this board."""
        chip = self.application.target.soc
        values = {
            "image": self.image.as_posix(),
            "name": self.application.target.board.sdks.get(self.flashing.tool, ""),
            "register": f"0x{chip.identity_register or 0:08x}",
        }
        words = [word for part in which for word in (self.board if part == "{board}" else (part,))]
        return [_ARGUMENT.sub(lambda match: values.get(match[1], match[0]), word) for word in words]


def flashing_of(checked: CheckedSystem, name: str) -> Flashing | None:
    """How the boards of a target are flashed; None if its family of chips does not say it."""
    family = checked.loader.family(checked.applications[name].target.soc.family)
    if family is None or family.flash is None:
        return None
    return usable(family.flash, load_tools(checked.loader.roots, Diagnostics()), Surroundings.here(cache_folder()))


def usable(flashing: Flashing, tools: Mapping[str, Tool], where: Surroundings) -> Flashing:
    """``flashing``, or its other way if only the tool of that is on this computer."""
    other = flashing.otherwise
    if other is None or other.tool not in tools or not program_of(tools[other.tool], where):
        return flashing
    return flashing if flashing.tool in tools and program_of(tools[flashing.tool], where) else other


def plan(checked: CheckedSystem, names: Collection[str], images: Path, diagnostics: Diagnostics) -> list[FlashJob]:
    """The jobs of the targets ``names``, in the order of the file.  Reports all mistakes."""
    built = {name for name, _, _ in images_of(checked)}
    by_family: dict[str, list[str]] = {}
    for name, application in checked.applications.items():
        by_family.setdefault(application.target.soc.family, []).append(name)
    jobs = []
    for name in checked.applications:
        if name not in names:
            continue
        application, target = checked.applications[name], checked.system.targets[name]
        flashing = flashing_of(checked, name)
        if name not in built:
            reason = f"EPG builds no image for the platform '{application.target.platform.name}'"
            hint = "docs/systems.md lists the platforms with images: flash the others with the tools of their projects"
        elif flashing is None:
            reason = f"the family '{application.target.soc.family}' does not say how its boards are flashed"
            hint = "docs/adding-a-family.md describes the key 'flash'"
        else:
            files = application_outputs(application, checked.loader.roots, PathNames(None))
            description = json.loads(files[f"{name}.json"])
            reason, hint = flash_problem(application, flashing, robot_of(checked.system.path, description))
        if reason or flashing is None:
            diagnostics.error("not-flashable", target.span, f"EPG cannot flash '{name}': {reason}", hint=hint)
            continue
        hash = str(description["hash"])
        if target.project is not None:  # it can give EPG more arguments, such as IOC
            hash = built_hash(target, images) or hash
        image = image_file(target, hash, images, diagnostics)
        chosen = _board(target, flashing, by_family[application.target.soc.family], diagnostics)
        if image is not None and chosen is not None:
            board, serial, shown = chosen
            jobs.append(FlashJob(name, target.span, application, flashing, image, board, serial, shown))
    return jobs


def flash_problem(application: Application, flashing: Flashing, robot: Robot | None) -> tuple[str, str]:
    """The reason why the boards of a target cannot be flashed, and a hint; empty texts if they can be flashed.

    ``robot`` is the description of a target of a system, whose boards are known by their serial numbers.
    """
    target = application.target
    if not target.soc.identity:
        hint = "write 'identity' in its soc.yaml: docs/adding-a-board.md describes it"
        return f"the chip '{target.soc.name}' cannot be recognized", hint
    if any("{name}" in part for part in flashing.write) and flashing.tool not in target.board.sdks:
        hint = f"write 'sdks: {{{flashing.tool}: <its name there>}}' in its board.yaml"
        return f"the name of the board '{target.board.name}' in {flashing.tool} is not known", hint
    serial = robot.usb.serial if robot is not None and robot.usb is not None else None
    if serial is not None and flashing.named_by == "serial":
        hint = "remove 'communication.usb.serial', or write the image by hand"
        return f"its board has the serial number '{serial}' only while it runs the program", hint
    return "", ""


def board_of(device: UsbDevice, flashing: Flashing) -> tuple[tuple[str, ...], str, str]:
    """The arguments that choose an attached board, its serial number, and the board in messages.

    There are none for a board of which neither a serial number nor a place is known: the tool takes the only one.
    """
    if device.id not in flashing.without_serial:
        return _chosen(flashing.by_serial, {"serial": device.serial}), device.serial, device.serial
    if not device.bus:
        return (), "", "in BOOTSEL mode"
    place = {"bus": device.bus, "address": device.address}
    return _chosen(flashing.by_place, place), "", f"at bus {device.bus}, address {device.address}"


def run_command(command: Sequence[str], shown: bool) -> tuple[int, str]:
    """Runs a command of a tool.  Returns its exit status and its output, which is printed instead if ``shown``."""
    if shown:
        return subprocess.run(command, stdin=subprocess.DEVNULL, stdout=sys.stderr).returncode, ""
    done = subprocess.run(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
    )
    return done.returncode, done.stdout


def _board(
    target: SystemTarget, flashing: Flashing, rivals: Sequence[str], diagnostics: Diagnostics
) -> tuple[tuple[str, ...], str, str] | None:
    """The arguments that choose the board of a target, its serial number, and the board in messages.

    ``rivals`` are the targets for boards of the same family.  Returns None after reporting that the file must name it.
    """
    serial = target.serial if flashing.named_by == "serial" else target.probe
    if serial is not None:
        serial = serial.upper() if flashing.named_by == "serial" else serial
        return _chosen(flashing.by_serial, {"serial": serial}), serial, serial
    devices = attached(flashing.usb)
    if devices is not None and len(devices) == len(rivals) == 1:
        return board_of(devices[0], flashing)
    if len(rivals) > 1:
        reason = f"the system has {len(rivals)} targets for such boards"
    elif devices is None:
        reason = NOT_LISTED
    else:
        reason = f"{len(devices) or 'no'} fitting boards are attached"
    hint = f"write '{flashing.named_by}: <serial number>' for it in the system file{_listed(devices, flashing)}"
    diagnostics.error("board-not-named", target.span, f"the board of '{target.name}' is not known: {reason}", hint=hint)
    return None


def _chosen(arguments: Sequence[str], values: Mapping[str, str]) -> tuple[str, ...]:
    return tuple(_ARGUMENT.sub(lambda match: values.get(match[1], match[0]), word) for word in arguments)


def _listed(devices: Sequence[UsbDevice] | None, flashing: Flashing) -> str:
    """The end of a hint: the attached boards."""
    if not devices:
        return ""
    shown = [
        "one in BOOTSEL mode" + (f" at bus {device.bus}, address {device.address}" if device.bus else "")
        if device.id in flashing.without_serial
        else f"{device.serial} ({device.product})"
        if device.product
        else device.serial
        for device in devices
    ]
    return f"; attached are {', '.join(shown)}"


@dataclass
class Flasher:
    """Runs jobs.  ``programs`` are the programs of the tools, ``show`` prints a line.

    With ``replace``, programs of other targets are overwritten.  ``run_tool`` runs a command, as :func:`run_command`.
    """

    jobs: Sequence[FlashJob]
    programs: Mapping[str, str]
    diagnostics: Diagnostics
    show: Callable[[str], None]
    replace: bool = False
    run_tool: Callable[[Sequence[str], bool], tuple[int, str]] = run_command
    restarted: list[FlashJob] = field(default_factory=list)

    def dry_run(self) -> None:
        """Prints the commands, and runs none."""
        self.show("# all boards must fit")
        for job in self.jobs:
            self._show(job, job.flashing.find)
        if any(job.flashing.restart for job in self.jobs):
            self.show("# a board that runs a program is restarted, and must fit then")
        for job in self.jobs:
            if job.flashing.restart:
                self._show(job, job.flashing.restart)
                self._show(job, job.flashing.find)
        self.show("# the images are written")
        for job in self.jobs:
            self._show(job, job.flashing.write)

    def run(self) -> None:
        """Flashes all boards.  Stops after reporting mistakes; raises UnusableTool."""
        try:
            self._prepare()
        finally:
            if self.diagnostics.has_errors:
                for job in self.restarted:
                    self._run(job, job.flashing.leave)
        self.diagnostics.stop_if_errors()
        for number, job in enumerate(self.jobs):
            self._show(job, job.flashing.write)
            status, _ = self.run_tool(self._command(job, job.flashing.write), True)
            if status != 0:
                self._report_failure(job, status, self.jobs[:number], self.jobs[number + 1 :])

    def _prepare(self) -> None:
        running = []
        for job in self.jobs:
            good, output = self._run(job, job.flashing.find)
            if good:
                self._check(job, output)
            elif job.flashing.unusable and re.search(job.flashing.unusable, " ".join(output.split())):
                raise UnusableTool(job.flashing.tool)
            elif job.flashing.restart and self._is_attached(job):
                running.append(job)
            else:
                self._report_missing(job, output)
        self.diagnostics.stop_if_errors()
        for job in running:
            good, output = self._run(job, job.flashing.restart)
            if not good:
                self._report_missing(job, output)
                break
            self.restarted.append(job)
            good, output = self._wait(job)
            if not good:
                self._report_missing(job, output)
                break
            self._check(job, output)
        self.diagnostics.stop_if_errors()

    def _check(self, job: FlashJob, facts: str) -> None:
        """Reports a board that has another chip, or a program of another target."""
        match = re.search(job.flashing.chip, facts, re.MULTILINE)
        chip = job.application.target.soc
        if match is None or match[1] != chip.identity:
            other = f"has the chip {match[1]}" if match else "does not say which chip it has"
            title = chip.title if chip.identity in chip.title else f"{chip.title}, which is {chip.identity}"
            message = f"the board {job.shown} {other}, but '{job.name}' is for the {title}"
            hint = f"correct '{job.flashing.named_by}' of '{job.name}', or attach another board"
            self.diagnostics.error("wrong-chip", job.span, message, hint=hint)
        program = re.search(job.flashing.program, facts, re.MULTILINE) if job.flashing.program else None
        if program is not None and program[1] != job.name and not self.replace:
            message = f"the board {job.shown} has the program of the target '{program[1]}', and not of '{job.name}'"
            hint = f"correct '{job.flashing.named_by}', or add --replace if '{job.name}' shall replace it"
            self.diagnostics.error("other-program", job.span, message, hint=hint)

    def _is_attached(self, job: FlashJob) -> bool:
        """False if this operating system lists USB devices, and the board is not among them."""
        devices = attached(job.flashing.usb)
        return devices is None or any(device.serial == job.serial for device in devices)

    def _report_missing(self, job: FlashJob, output: str) -> None:
        message = f"the board {job.shown} of '{job.name}' does not answer: {_last(output)}"
        hint = "attach it" + (f", or {job.flashing.by_hand}" if job.flashing.by_hand else "")
        hint += _listed(attached(job.flashing.usb), job.flashing)
        self.diagnostics.error("board-not-found", job.span, message, hint=hint)

    def _report_failure(self, job: FlashJob, status: int, done: Sequence[FlashJob], others: Sequence[FlashJob]) -> None:
        tool = job.flashing.tool
        message = f"the image of '{job.name}' was not written: {tool} ended with status {status}"
        groups = [("written", done), ("not written", others)]
        listed = [f"{title}: {', '.join(each.name for each in group)}" for title, group in groups if group]
        hint = ". ".join([*listed, f"correct the error that {tool} shows above, and flash all boards again"])
        self.diagnostics.error("flash-failed", job.span, message, hint=hint)
        self.diagnostics.stop_if_errors()

    def _wait(self, job: FlashJob) -> tuple[bool, str]:
        """Waits until a restarted board answers."""
        self._show(job, job.flashing.find)
        end = time.monotonic() + PATIENCE
        while True:
            good, output = self._answer(job, job.flashing.find)
            if good or time.monotonic() > end:
                return good, output
            time.sleep(_PAUSE)

    def _run(self, job: FlashJob, arguments: Sequence[str]) -> tuple[bool, str]:
        self._show(job, arguments)
        return self._answer(job, arguments)

    def _answer(self, job: FlashJob, arguments: Sequence[str]) -> tuple[bool, str]:
        """True if the command succeeds, and its output."""
        status, output = self.run_tool(self._command(job, arguments), False)
        return status == 0, output

    def _command(self, job: FlashJob, arguments: Sequence[str]) -> list[str]:
        return [self.programs[job.flashing.tool], *job.arguments(arguments)]

    def _show(self, job: FlashJob, arguments: Sequence[str]) -> None:
        self.show(f"{shlex.join(self._command(job, arguments))}  # {job.name}")


def _last(output: str) -> str:
    """The last paragraph of an output, on one line."""
    paragraphs = [" ".join(part.split()) for part in re.split(r"\n\s*\n", output) if part.strip()]
    return paragraphs[-1] if paragraphs else "no output"


def program_of(tool: Tool, where: Surroundings) -> str:
    """The program of a tool: its name if it is in ``PATH``, else its path; empty if it is not found."""
    name = tool.programs[0] if tool.programs else tool.name
    if shutil.which(name, path=where.path):
        return name
    path = find_tool(tool, where).path
    if path is None:
        return ""
    return shutil.which(name, path=str(path)) or "" if path.is_dir() else str(path)
