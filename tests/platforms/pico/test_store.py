# SPDX-License-Identifier: Apache-2.0
"""Parameters that `save` has put into flash are there after a restart, even if the supply failed meanwhile.

JIWY's RP2040 images with the console; the emulator's boot ROM erases and programs flash.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

import pytest

from tests.platforms.pico.closed_loop.board import Board, image
from tests.platforms.pico.closed_loop.robot import AXES
from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated

PARAMETER, GENERATED, OTHER = r"Pan\PID\kp", 2.6, r"Tilt\PID\kp"
SECTOR, PAGE = 4096, 256
STORE = 2 * 1024 * 1024 - 3 * SECTOR
"""Offset of the first of two sectors in the flash of a Pico."""
HEAD = SECTOR - PAGE
ERASED_WORDS = SECTOR // 4
SIZE_OF_HEAD = 16
ERASE_MS = 45


@pytest.fixture(params=PLATFORMS)
def board(request: pytest.FixtureRequest) -> Iterator[Board]:
    """JIWY, disabled, with no stored parameters."""
    skip_unless_emulated(request.param)
    with Board(image(request.param), {"pan": 0.12, "tilt": 0.12}) as made:
        made.pico.call("watch_flash")
        made.ask("disable")
        yield made


def value(board: Board, parameter: str = PARAMETER) -> float:
    found = re.search(r"^parameter \S+=(\S+)", board.ask(f"get {parameter}"), re.MULTILINE)
    assert found is not None
    return float(found[1])


def stored(board: Board) -> str:
    """The stored parameters that the firmware found at its start."""
    found = re.search(r"stored=(\w+)\s", final_line(board, "version"))
    assert found is not None
    return found[1]


def final_line(board: Board, command: str) -> str:
    """The end of the answer to a command, after ``ok`` and its name."""
    rest = board.ask(command).rpartition(f"ok {command}")[2]
    return rest if "\n" in rest else rest + board.pico.run_until_text("\n", milliseconds=50)


def restart(board: Board, command: str) -> None:
    """Restarts by ``reset`` or ``cut_power``; the robot stays disabled."""
    board.pico.call(command)
    board.pico.receive()
    board.pico.run_until_text("ready", milliseconds=1000)
    board.ask("disable")


@dataclass(frozen=True)
class Write:
    """A word of flash that was erased or a byte that was programmed."""

    cycle: int
    offset: int
    size: int
    value: int


def writes(board: Board) -> list[Write]:
    """The writes since the last call."""
    return [Write(*entry) for entry in board.pico.call("take", log="flash")]


def assert_nothing_went_wrong(board: Board) -> None:
    assert board.pico.call("faults") == []
    stats = board.stats()
    assert (stats["fault"], stats["missed"], stats["overruns"]) == ("none", "0", "0")


@pytest.mark.parametrize("how", ["reset", "cut_power"])
def test_saved_values_are_there_after_a_restart(board: Board, how: str) -> None:
    assert (value(board), stored(board)) == (GENERATED, "nothing")
    board.ask(f"set {PARAMETER}=2.25 {OTHER}=0.1")
    assert value(board) == 2.25
    restart(board, how)
    assert (value(board), stored(board)) == (GENERATED, "nothing"), "as it was not saved"

    board.ask(f"set {PARAMETER}=2.25 {OTHER}=0.1")
    assert "values=2" in final_line(board, "save")
    restart(board, how)
    assert (value(board), value(board, OTHER), stored(board)) == (2.25, 0.1, "loaded")

    board.ask(f"set {PARAMETER}={GENERATED}")
    assert "values=1" in final_line(board, "save")
    restart(board, how)
    assert (value(board), value(board, OTHER), stored(board)) == (GENERATED, 0.1, "loaded")
    assert_nothing_went_wrong(board)


def test_the_sectors_take_turns(board: Board) -> None:
    """The two sectors are used in turn, and no other flash is changed, above all not the image."""
    sectors = []
    for number in range(3):
        board.ask(f"set {PARAMETER}={number}")
        board.ask("save")
        offsets = [write.offset - STORE for write in writes(board)]
        sector = offsets[0] // SECTOR
        assert {offset // SECTOR for offset in offsets} == {sector}
        sectors.append(sector)
    assert sectors in ([0, 1, 0], [1, 0, 1])


def test_control_waits_and_outputs_stay_safe_meanwhile(board: Board) -> None:
    board.ask(f"set {PARAMETER}=1")
    board.pico.run(milliseconds=5)
    board.pico.call("take", log="pins")
    board.pico.send("save\n")
    board.assert_stays_safe(*AXES, milliseconds=ERASE_MS)
    assert "ok save" in board.pico.run_until_text("ok save")
    assert board.is_safe(*AXES)
    assert_nothing_went_wrong(board)
    assert board.pico.run(cycles=1)["resets"] == []
    board.ask("enable")
    board.pico.run(milliseconds=100)
    assert not board.is_safe(*AXES), "it homes"
    assert_nothing_went_wrong(board)


def test_nothing_is_written_while_enabled(board: Board) -> None:
    board.ask("enable")
    board.ask(f"set {PARAMETER}=1.5")
    board.pico.send("save\n")
    said = board.pico.run_until_text("error save")
    board.pico.run(milliseconds=100)
    assert "ok save" not in said + board.pico.receive()
    assert writes(board) == []
    assert board.stats()["enabled"] == "1"
    restart(board, "reset")
    assert (value(board), stored(board)) == (GENERATED, "nothing")


def test_the_supply_fails_at_any_moment(board: Board) -> None:
    """The supply fails after any number of erased words and programmed bytes: the old or the new values are found."""
    board.ask(f"set {PARAMETER}=1")
    board.ask("save")
    log = writes(board)
    programmed = len(log) - ERASED_WORDS
    assert {write.size for write in log[:ERASED_WORDS]} == {4} and programmed == 2 * PAGE, (
        "a page of values, and the head"
    )
    old = 1.0
    first_of_head = ERASED_WORDS + PAGE + 1
    outcomes = set()
    cuts = [
        1,
        2,
        ERASED_WORDS // 2,
        ERASED_WORDS,
        ERASED_WORDS + 1,
        ERASED_WORDS + 40,
        first_of_head - 1,
        first_of_head,
    ]
    cuts += [first_of_head + byte for byte in (3, 4, 8, 12, 14)]
    cuts += [first_of_head + SIZE_OF_HEAD - 1, first_of_head + SIZE_OF_HEAD, len(log)]
    for number, cut in enumerate(cuts):
        new = 1.5 + number
        board.ask(f"set {PARAMETER}={new}")
        writes(board)
        board.pico.call("watch_flash", stop_after=cut)
        board.pico.send("save\n")
        assert board.pico.run(milliseconds=100)["reason"] == "flash"
        assert len(writes(board)) == cut
        restart(board, "cut_power")
        found = value(board)
        assert found in (old, new) and stored(board) == "loaded", f"after {cut} writes"
        assert found == new or cut < first_of_head + SIZE_OF_HEAD, "the last bytes are 0xFF, as after erasing"
        outcomes.add((found == new, cut > ERASED_WORDS + PAGE))
        old = found
    assert outcomes == {(False, False), (False, True), (True, True)}
    assert_nothing_went_wrong(board)
