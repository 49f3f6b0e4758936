# SPDX-License-Identifier: Apache-2.0
"""Zephyr's image for the Pico in the RP2040 emulator: the PIO decoders count every edge, whatever the reader does.

`firmware` has five decoders: four on PIO 0 that share the program, one on PIO 1; two have B on the lower pin, two
are inverted.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from tests.doubles.rp2040.emulator import Emulator
from tests.doubles.toolchain import arm_gcc, node, rp2040js, skip_if_missing

from .firmware_requests import EHOSTDOWN, EIO, FETCH, POKE, PRESET, READ, RESUME, SKIPPED, SUSPEND, WATCH
from .workspace import build, workspace

PINS = [(2, 3), (5, 4), (6, 7), (9, 8), (10, 11)]
SIGNS = [1, 1, -1, -1, 1]
LIMIT = 9
"""The smallest number of cycles between edges that the program counts exactly."""


class Board:
    """The image, with an encoder at each decoder."""

    def __init__(self, image: Path) -> None:
        self.pico = Emulator(image)
        self.pico.run(milliseconds=10)
        assert self.pico.call("faults") == []
        for n, (a, b) in enumerate(PINS):
            self.pico.call("encoder", name=str(n), a=a, b=b)

    def ask(self, request: int) -> list[int]:
        """Sends a request to the firmware, for each decoder; returns the decoders' errors."""
        self.pico.write_word("done", 0)
        self.pico.write_word("request", request)
        for _ in range(100):
            self.pico.run(milliseconds=0.2)
            if self.pico.word("done") == request:
                return [self.pico.word("errors", offset=4 * n, signed=True) for n in range(len(PINS))]
        raise AssertionError(f"request {request} was not answered: {self.pico.call('faults')}")

    def positions(self) -> list[int]:
        return [self.pico.word("positions", offset=8 * n, size=8, signed=True) for n in range(len(PINS))]

    def read(self) -> list[int]:
        assert self.ask(READ) == [0] * len(PINS)
        return self.positions()

    def move(self, kind: str, **parameters: object) -> None:
        for n in range(len(PINS)):
            self.pico.call("move", name=str(n), kind=kind, **{"seed": n + 1, **parameters})

    def edges(self, directions: list[int], apart: int = 100) -> None:
        start = self.pico.cycle + 200
        self.move("schedule", edges=[[start + apart * k, direction] for k, direction in enumerate(directions)])
        self.pico.run(cycles=400 + apart * len(directions))

    def watch(self, milliseconds: float) -> int:
        """Makes the firmware read repeatedly; returns the number of reads."""
        before = self.pico.word("rounds")
        self.pico.write_word("request", WATCH)
        self.pico.run(milliseconds=milliseconds)
        self.pico.write_word("request", 0)
        self.pico.run(milliseconds=2)
        return self.pico.word("rounds") - before

    def rest(self) -> None:
        for n in range(len(PINS)):
            self.pico.call("move", name=str(n), kind="rest")

    def true_counts(self) -> list[int]:
        """The edges of the encoders, with the sign that the decoders must give them."""
        counts = [self.pico.call("encoder_count", name=str(n)) for n in range(len(PINS))]
        return [sign * count for sign, count in zip(SIGNS, counts, strict=True)]


@pytest.fixture(scope="module")
def image() -> Path:
    skip_if_missing(partial(workspace, "rpi_pico"), arm_gcc, node, rp2040js)
    return build("tests/zephyr/firmware", "rpi_pico") / "zephyr" / "zephyr.elf"


@pytest.fixture
def board(image: Path) -> Iterator[Board]:
    made = Board(image)
    yield made
    faults = made.pico.call("faults")
    made.pico.close()
    assert faults == []


def test_the_kernel_sleeps_as_long_as_it_says(board: Board) -> None:
    """SysTick ends WFI.  The firmware waits for k_msleep(1) between requests, which takes at most two ticks more."""
    board.pico.run(milliseconds=20)
    state = board.pico.run(milliseconds=20)
    assert state["cores"][0]["waiting"], "the idle thread is in WFI most of the time"
    before = board.pico.cycle
    board.ask(READ)
    assert (board.pico.cycle - before) / 125_000 < 1.6


@pytest.mark.parametrize("seed", [1, 2])
def test_random_walks_at_the_limit_rate(board: Board, seed: int) -> None:
    assert board.read() == [0] * len(PINS)
    for n in range(len(PINS)):
        board.pico.call(
            "move", name=str(n), kind="random", seed=100 * seed + n,
            shortest=LIMIT, longest=60, reversal=0.1, burst=100,
        )  # fmt: skip
    assert board.watch(8) > 20
    board.rest()
    assert board.read() == board.true_counts()
    assert max(abs(count) for count in board.true_counts()) > 50
    assert board.pico.word("failures") == 0
    assert board.ask(SKIPPED) == [0] * len(PINS)
    assert [board.pico.word("skipped", offset=4 * n) for n in range(len(PINS))] == [0] * len(PINS)


def test_every_edge_at_the_limit_rate(board: Board) -> None:
    board.move("random", shortest=LIMIT, longest=LIMIT, reversal=0.0)
    board.watch(4)
    board.rest()
    counts = board.true_counts()
    assert board.read() == counts
    assert all(abs(count) > 40_000 for count in counts)
    assert board.pico.word("failures") == 0


def test_edges_beyond_the_limit_are_lost_and_noticed(board: Board) -> None:
    """This also proves that these tests can fail."""
    board.move("random", shortest=4, longest=5, reversal=0.1)
    board.watch(2)
    board.rest()
    assert all(read != true for read, true in zip(board.read(), board.true_counts(), strict=True))
    board.ask(SKIPPED)
    assert all(board.pico.word("skipped", offset=4 * n) > 0 for n in range(len(PINS)))


def test_nothing_is_lost_when_nobody_reads(board: Board) -> None:
    board.move("constant", interval=10, direction=-1)
    board.pico.run(milliseconds=20)
    board.rest()
    assert board.read() == board.true_counts()
    assert abs(board.true_counts()[0]) > 200_000


def test_wraps_of_the_32_bit_count(board: Board) -> None:
    """The register is set near its limits; the count, 64 bits wide, continues."""
    expected = 0
    for register in (0x70000000, 0xE0000000, 0xFFFFFFF0, 0x7FFFFFF0, 0xFFFFFFE0):
        before = board.pico.call("pio", block=0, machine=0)["y"]
        board.pico.call("pio", block=0, machine=0, set={"y": register})
        expected += (register - before) % 2**32
        assert board.read()[0] == expected
        board.edges([1] * 40)
        expected += 40
        assert board.read()[0] == expected
    assert expected > 2**32
    board.edges([-1] * 60)
    assert board.read()[0] == expected - 60


def test_presets_and_angles(board: Board) -> None:
    board.edges([1] * 7)
    presets = [0, -(2**40), 2**62, 1999, -1]
    for n, preset in enumerate(presets):
        board.pico.write_word("presets", preset, offset=8 * n, size=8)
    assert board.ask(PRESET) == [0] * len(PINS)
    assert board.read() == presets
    board.edges([1] * 3)
    assert board.read() == [preset + 3 * sign for preset, sign in zip(presets, SIGNS, strict=True)]

    board.ask(FETCH)
    angles = [board.pico.word("angles", offset=4 * k, signed=True) for k in range(2 * len(PINS))]
    assert angles[0:2] == [0, 540_000]  # 3 counts of 2000
    assert angles[6:8] == [359, 280_000]  # 1996
    assert angles[8:10] == [0, 360_000]  # 2


def test_suspended_decoders_do_not_count(board: Board) -> None:
    board.edges([1] * 11)
    before = board.read()
    assert board.ask(SUSPEND) == [0] * len(PINS)
    assert board.ask(READ) == [-EHOSTDOWN] * len(PINS)
    board.edges([1] * 5)
    assert board.ask(RESUME) == [0] * len(PINS)
    assert board.read() == before
    board.edges([-1] * 2)
    assert board.read() == [count - 2 * sign for count, sign in zip(before, SIGNS, strict=True)]


def test_a_halted_state_machine_is_an_error(board: Board) -> None:
    """A write stops all state machines of PIO 0: reads give an error instead of a constant position."""
    board.pico.write_word("poke_address", 0x50200000)  # PIO0's CTRL
    board.pico.write_word("poke_value", 0)
    board.ask(POKE)
    assert board.ask(READ) == [-EIO] * 4 + [0]


def test_the_sample_says_count_and_angle(image: Path) -> None:
    """The console is in memory, because the emulator has no serial port for UARTs."""
    console = {"CONFIG_RAM_CONSOLE": "y", "CONFIG_UART_CONSOLE": "n", "CONFIG_LOG": "n"}
    sample = build("zephyr_module/samples/qdec", "rpi_pico", settings=console) / "zephyr" / "zephyr.elf"
    with Emulator(sample) as pico:
        pico.run(milliseconds=10)
        pico.call("encoder", name="shaft", a=10, b=11)
        pico.call("move", name="shaft", kind="constant", interval=12_500, direction=-1)  # 10 counts a millisecond
        pico.run(milliseconds=350)
        pico.call("move", name="shaft", kind="rest")
        turned = pico.call("encoder_count", name="shaft")
        pico.run(milliseconds=200)
        said = pico.read("ram_console_buf").split(b"\0")[0].decode().splitlines()
        assert pico.call("faults") == []
    assert "count 0, angle 0.000000 degrees" in said
    assert turned < -3000
    degrees, thousandths = divmod(-turned * 180, 1000)
    assert said[-1] == f"count {turned}, angle -{degrees}.{thousandths:03}000 degrees"
    assert len(said) == 7  # the kernel's first line, and one line every 100 ms
