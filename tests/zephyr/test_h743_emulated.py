# SPDX-License-Identifier: Apache-2.0
"""Zephyr's image for the STM32H743 on an emulated chip: six timers count exactly, over wraps between two reads."""

from __future__ import annotations

import random
from functools import partial
from pathlib import Path

import pytest

from tests.doubles.stm32.stm32h743 import Stm32h743
from tests.doubles.toolchain import arm_gcc, skip_if_missing, unicorn

from .firmware_requests import EHOSTDOWN, FETCH, PRESET, READ, RESUME, SKIPPED, SUSPEND, WATCH
from .workspace import build, workspace

# In the order of `firmware`: timer, pins and their alternate function (data sheet DS12110, table 9), sign.
DECODERS = {
    "TIM1": (("E", 9), ("E", 11), 1, 1),
    "TIM2": (("A", 15), ("B", 3), 1, 1),
    "TIM3": (("A", 6), ("A", 7), 2, -1),
    "TIM4": (("D", 12), ("D", 13), 2, 1),
    "TIM5": (("A", 0), ("A", 1), 2, -1),
    "TIM8": (("C", 6), ("C", 7), 3, 1),
}
SHORT = [name for name in DECODERS if name not in ("TIM2", "TIM5")]
LATENCY = 16383
"""Counts that may pass between a match and its interrupt: docs/zephyr-qdec.md, for 16 bits."""
ENOTSUP = 134


class Board:
    """The image after its start, with an encoder at each timer."""

    def __init__(self, image: Path) -> None:
        self.chip = Stm32h743(image)
        self.chip.boot()
        self.true = dict.fromkeys(DECODERS, 0)
        """The counts that the decoders must show."""
        for name, (a, b, function, _) in DECODERS.items():
            self.chip.attach(name, a, b, alternate_function=function)
        self.chip.run(1000)
        assert self.errors() == [0] * len(DECODERS)

    def errors(self) -> list[int]:
        return [self.chip.word("errors", offset=4 * n, signed=True) for n in range(len(DECODERS))]

    def ask(self, request: int) -> list[int]:
        """Sends a request to the firmware, for each decoder; returns the decoders' errors."""
        self.chip.write_word("done", 0)
        self.chip.write_word("request", request)
        for _ in range(100):
            self.chip.run(1000)
            if self.chip.word("done") == request:
                return self.errors()
        raise AssertionError(f"request {request} was not answered: the processor is at {self.chip.pc:#x}")

    def read(self) -> dict[str, int]:
        assert self.ask(READ) == [0] * len(DECODERS)
        return {name: self.chip.word("positions", offset=8 * n, size=8, signed=True) for n, name in enumerate(DECODERS)}

    def move(self, name: str, edges: int, *, latency: int = 0) -> None:
        self.chip.move(name, edges, latency=latency)
        self.true[name] += edges * DECODERS[name][3]

    def preset(self, counts: dict[str, int]) -> None:
        for n, name in enumerate(DECODERS):
            self.chip.write_word("presets", counts[name], offset=8 * n, size=8)
        assert self.ask(PRESET) == [0] * len(DECODERS)
        self.true = dict(counts)


@pytest.fixture(scope="module")
def image() -> Path:
    skip_if_missing(partial(workspace, "nucleo_h743zi"), arm_gcc, unicorn)
    return build("tests/zephyr/firmware", "nucleo_h743zi") / "zephyr" / "zephyr.elf"


@pytest.fixture
def board(image: Path) -> Board:
    return Board(image)


def test_timers_are_set_up(board: Board) -> None:
    """The devicetree's prescalers of 99 are ignored; TIM2 has filter 3, TIM4 filter 15."""
    for name, timer in board.chip.timers.items():
        assert timer.prescaler == 0
        assert timer.filters == {"TIM2": (3, 3), "TIM4": (15, 15)}.get(name, (0, 0))


@pytest.mark.parametrize("name", DECODERS)
def test_wraps_that_nobody_reads(board: Board, name: str) -> None:
    """More than 100 ranges of 16 bits, or 5 of 32, in both directions; the other decoders do not change."""
    turns = 5 << 32 if board.chip.timers[name].bits == 32 else 10_000_000
    for edges in (turns + 1, -3 * turns, turns - 7, 1, -1):
        board.move(name, edges)
        assert board.read() == board.true
    assert max(board.true[name], -board.true[name]) > turns // 2


@pytest.mark.parametrize("name", DECODERS)
@pytest.mark.parametrize("direction", [1, -1])
def test_late_interrupts(board: Board, name: str, direction: int) -> None:
    range_ = 1 << board.chip.timers[name].bits
    latency = range_ // 4 - 1
    assert range_ != 1 << 16 or latency == LATENCY
    board.move(name, direction * 20 * range_, latency=latency)
    assert board.read() == board.true


def test_interrupts_that_are_too_late_lose_a_range(board: Board) -> None:
    """This proves that the tests can fail, and that the documented latency is the limit."""
    board.move("TIM3", 16384 + LATENCY + 2, latency=LATENCY + 2)
    assert board.read()["TIM3"] == board.true["TIM3"] + 65536


@pytest.mark.parametrize("place", [0, 16384, 32768, -1])
def test_a_trembling_shaft_causes_no_interrupts(board: Board, place: int) -> None:
    board.move("TIM4", place)
    served = board.chip.interrupts
    for _ in range(1000):
        for edges in (1, -2, 1):
            board.move("TIM4", edges)
    assert board.chip.interrupts - served <= 1
    assert board.read() == board.true


@pytest.mark.parametrize("seed", range(4))
def test_edges_at_any_instruction_of_a_reader(board: Board, seed: int) -> None:
    """The firmware reads all the time; shafts move, and interrupts come, between any two instructions."""
    dice = random.Random(seed)
    board.chip.write_word("request", WATCH)
    for _ in range(2500):
        name = dice.choice(list(DECODERS))
        board.move(name, round(dice.gauss(0, 1) * 10 ** dice.uniform(0, 5)))
        board.chip.run(dice.randint(1, 60))
    assert board.chip.word("rounds") > 20
    assert board.chip.interrupts > 100
    board.chip.write_word("request", 0)
    board.chip.run(20_000)
    assert board.read() == board.true
    assert board.chip.word("failures") == 0


def test_presets(board: Board) -> None:
    for number, count in enumerate([0, -1, 123_456_789, 1 << 40, -(1 << 62)]):
        for name in DECODERS:
            board.move(name, 30_000 + number)
        board.preset({name: count + n for n, name in enumerate(DECODERS)})
        assert board.read() == board.true
        for name in DECODERS:
            board.move(name, -70_001)
        assert board.read() == board.true


def test_angles(board: Board) -> None:
    board.move("TIM1", 100_001)
    board.move("TIM3", 3)
    assert board.ask(FETCH) == [0] * len(DECODERS)
    angles = [board.chip.word("angles", offset=4 * k, signed=True) for k in range(2 * len(DECODERS))]
    assert angles[0:2] == [18000, 180_000]
    assert angles[4:6] == [0, -540_000]


def test_skipped_edges_cannot_be_told(board: Board) -> None:
    assert board.ask(SKIPPED) == [-ENOTSUP] * len(DECODERS)


def test_suspended_decoders_do_not_count(board: Board) -> None:
    for name in DECODERS:
        board.move(name, 40_000)
    before = board.read()
    assert board.ask(SUSPEND) == [0] * len(DECODERS)
    assert not any(timer.clocked for timer in board.chip.timers.values())
    assert board.ask(READ) == [-EHOSTDOWN] * len(DECODERS)
    served = board.chip.interrupts
    for name in DECODERS:
        board.chip.move(name, 100_000)
    assert board.chip.interrupts == served
    assert board.ask(RESUME) == [0] * len(DECODERS)
    assert board.read() == before
    for name in DECODERS:
        board.move(name, -90_000)
    assert board.read() == board.true


def test_a_register_that_is_reset_shows(board: Board) -> None:
    """The model is not a mock of the driver: without encoder mode, clock or pins it does not count."""
    for name, spoil in (("TIM1", {0x08: 0}), ("TIM4", {0x18: 0}), ("TIM8", {0x00: 0})):
        board.chip.timers[name].registers.update(spoil)
        board.chip.move(name, 100)
    board.chip.timers["TIM2"].clocked = False
    board.chip.move("TIM2", 100)
    board.chip.registers[0x58020000 + 0x20] = 0  # GPIOA AFRL
    board.chip.move("TIM3", 100)
    assert set(board.read().values()) == {0}
