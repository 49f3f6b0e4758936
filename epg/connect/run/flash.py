# SPDX-License-Identifier: Apache-2.0
"""Writes a product of a build to a board: to the drive of its boot program, by its family's tool, or by west.

>>> # boards = boards_for(job, application, products)
>>> # run = FlashRun(changed=wake_the_page); run.start(boards, boards.found[0], replace=False)
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

from epg.connect.activity import Activity, Outcome, message_of
from epg.connect.build.build_messages import BuildMessage, Messages
from epg.connect.projects import Job
from epg.generator.bootstrap import cache_folder
from epg.generator.catalog.platform import Flashing
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, UserError
from epg.generator.install import remedy
from epg.generator.resolve.application import Application
from epg.generator.source import Span
from epg.generator.tools.find_tool import Surroundings
from epg.generator.tools.remedy import command_for
from epg.generator.tools.tools import load_tools
from epg.generator.tools.uf2_drives import Uf2Drive, copy_to_drive, uf2_drives
from epg.generator.tools.usb_boards import NOT_LISTED, attached
from epg.system import flash

_NO_ACCESS = re.compile(r"LIBUSB_ERROR_ACCESS|was unable to connect|ermission denied", re.IGNORECASE)
"""What picotool and OpenOCD print if the user may not use a device."""
_HINTS = {
    "wrong-chip": "attach the board of this target, or choose the target for this board",
    "other-program": "to overwrite it, choose 'Replace the other program'",
}
"""The remedies on the page, in place of those about files of systems."""
WEST = "west"


@dataclass(frozen=True)
class FlashableBoard:
    """One board that can be written.  ``id`` distinguishes it, ``shown`` describes it to the user.

    It has a ``drive``, or the ``job`` for the tool of its family; else west finds it.
    """

    id: str
    shown: str
    image: Path
    drive: Uf2Drive | None = None
    job: flash.FlashJob | None = None


@dataclass(frozen=True)
class Boards:
    """The boards that can be written now.  If there is none, ``problem`` and ``hint`` are the reason and the remedy.

    ``program`` is the program of the tool, ``folder`` the build folder, and ``tool`` the name of the tool.
    """

    found: tuple[FlashableBoard, ...] = ()
    problem: str = ""
    hint: str = ""
    tool: str = ""
    program: str = ""
    folder: Path = Path()

    def data(self) -> dict[str, object]:
        """The boards for the page."""
        listed = [{"id": each.id, "shown": each.shown, "file": str(each.image)} for each in self.found]
        return {"found": listed, "problem": self.problem, "hint": self.hint}


def boards_for(job: Job, application: Application, products: Sequence[Path]) -> Boards:
    """The boards to which ``products`` of the target's last build can be written."""
    target = application.target
    images = {path.suffix: path for path in reversed(products)}
    uf2, elf = images.get(".uf2"), images.get(".elf")
    flashing = target.platform.family.flash if target.platform.family is not None else None
    if uf2 is not None and target.soc.drive:
        drives = [drive for drive in uf2_drives() if drive.board == target.soc.drive]
        if drives:
            return Boards(tuple(_on_drive(drive, uf2) for drive in drives))
    if flashing is not None and elf is not None:
        return _by_tool(job, application, flashing, elf)
    if job.built_by == WEST and products and not target.platform.simulates_plant:
        return _by_west(job, products[0])
    return Boards(problem="EPG does not know how this target is written to its board", hint="download the file")


def _on_drive(drive: Uf2Drive, image: Path) -> FlashableBoard:
    return FlashableBoard(f"drive {drive.folder}", f"{drive.board}, the drive {drive.folder}", image, drive=drive)


def _by_tool(job: Job, application: Application, flashing: Flashing, image: Path) -> Boards:
    """The boards that are attached by USB, for the tool of the family."""
    tools = load_tools(job.request.roots, Diagnostics())
    where = Surroundings.here(cache_folder())
    flashing = flash.usable(flashing, tools, where)
    reason, hint = flash.flash_problem(application, flashing, None)
    if reason:
        return Boards(problem=f"EPG cannot flash this target: {reason}", hint=hint)
    tool = tools.get(flashing.tool)
    program = flash.program_of(tool, where) if tool is not None else ""
    by_hand = flashing.by_hand or "connect its debug probe by USB"
    devices = attached(flashing.usb)
    if devices is None:
        return Boards(problem=NOT_LISTED, hint=by_hand)
    if not devices:
        hint = f"{by_hand[0].upper()}{by_hand[1:]}, and look again"
        return Boards(problem="no board was found", hint=hint)
    if not program and tool is not None:
        drive = " (or hold BOOTSEL while you plug the board in: then its drive is used)" if flashing.by_hand else ""
        return Boards(problem=f"{tool.title} was not found", hint=f"get it: {command_for(tool, where, tools)}{drive}")
    boards = []
    for device in devices:
        arguments, serial, shown = flash.board_of(device, flashing)
        work = flash.FlashJob(
            job.request.name, Span(str(image)), application, flashing, image, arguments, serial, f"'{shown}'"
        )
        boards.append(FlashableBoard(shown, f"{device.product or target_title(application)} {shown}", image, job=work))
    return Boards(tuple(boards), tool=flashing.tool, program=program)


def target_title(application: Application) -> str:
    return application.target.board.summary


def _by_west(job: Job, image: Path) -> Boards:
    """The board that ``west flash`` finds by the runner of Zephyr's board."""
    tools = load_tools(job.request.roots, Diagnostics())
    where = Surroundings.here(cache_folder())
    program = flash.program_of(tools[WEST], where)
    if not program:
        return Boards(problem="west was not found", hint=f"get it: {command_for(tools[WEST], where, tools)}")
    build = Path(os.path.abspath(job.build_dir or image.parent.parent))
    board = FlashableBoard(WEST, "the board that 'west flash' finds", image)
    return Boards((board,), tool=WEST, program=program, folder=build)


class FlashRun(Activity):
    """One writing.  ``file`` and ``board`` in its state are what is written to where.

    ``can_replace`` is True if the board has the program of another target.
    """

    more: ClassVar = {"file": "", "board": "", "can_replace": False, "can_try": False}

    def start(self, boards: Boards, board: FlashableBoard, *, replace: bool) -> None:
        """Writes to ``board``.  With ``replace``, the program of another target is overwritten."""
        self.shown |= {"file": str(board.image), "board": board.shown}
        self.begin(lambda: self._flash(boards, board, replace))

    def _flash(self, boards: Boards, board: FlashableBoard, replace: bool) -> Outcome:
        shown = {"file": str(board.image), "board": board.shown}
        if board.drive is not None:
            outcome = self._copy(board.image, board.drive)
        elif board.job is not None:
            outcome = self._by_tool(boards, board.job, replace)
        else:
            outcome = self._by_west(boards)
        state = "cancelled" if self.is_cancelled and board.drive is None else outcome.state  # a copy is not interrupted
        return Outcome(state, outcome.messages, {**shown, **outcome.more})

    def _copy(self, image: Path, drive: Uf2Drive) -> Outcome:
        problem = copy_to_drive(image, drive, lambda done, total: self.progress("write", done, total))
        hint = "hold BOOTSEL while you plug the board in, and flash again"
        return (
            Outcome("failed", [BuildMessage("error", problem, hint=hint, id="flash-failed")])
            if problem
            else Outcome("done")
        )

    def _by_tool(self, boards: Boards, job: flash.FlashJob, replace: bool) -> Outcome:
        diagnostics = Diagnostics()
        programs = {boards.tool: boards.program}
        try:
            flash.Flasher([job], programs, diagnostics, self.read, replace, self._run_tool).run()
        except flash.UnusableTool:
            text = f"{boards.tool} cannot reach boards: it was built without USB"
            hint = "hold BOOTSEL while you plug the board in: then its drive is used"
            return Outcome("failed", [BuildMessage("error", text, hint=hint, id="tool-missing")])
        except UserError:
            messages_of_tool = [message_of(each.data()) for each in diagnostics]
            refused = _NO_ACCESS.search("\n".join(self.lines(0)))
            hints = {each.id: _HINTS.get(each.id, each.hint) for each in messages_of_tool}
            if refused:
                hints |= dict.fromkeys(("board-not-found", "flash-failed"), remedy("board access", tool=boards.tool))
            messages = [
                BuildMessage("error", each.message, hint=hints.get(each.id, ""), id=each.id)
                for each in messages_of_tool
            ]
            other = any(each.id == "other-program" for each in messages_of_tool)
            return Outcome("failed", messages, {"can_replace": other})
        return Outcome("done")

    def _run_tool(self, command: Sequence[str], shown: bool) -> tuple[int, str]:
        """Runs a command of the tool for the Flasher: its output is in the log."""
        begin = len(self.lines(0))
        status = self.run("write" if shown else "find", command, Path.cwd(), os.environ)
        return status, "\n".join(self.lines(begin))

    def _by_west(self, boards: Boards) -> Outcome:
        messages = Messages((boards.folder,))
        self.read_messages(messages)
        command = (boards.program, "flash", "--skip-rebuild", "-d", str(boards.folder))
        status = self.run("write", command, boards.folder, os.environ)
        return Outcome("done") if status == 0 else Outcome("failed", messages.finish(failed=True))
