# SPDX-License-Identifier: Apache-2.0
"""Fixtures: a board with the test program, in the emulator."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import astuple, dataclass
from pathlib import Path

import pytest

from tests.doubles.rp2040.build import build
from tests.doubles.rp2040.emulator import Emulator
from tests.doubles.toolchain import arm_gcc, node, pico_sdk, rp2040js, skip_if_missing

PROJECT = "tests/libraries/pico_quadrature/program"

COUNT, VELOCITY = 0, 1
ANY = 0xFF
INIT, READ, WATCH, STOP, PRESET, OTHERS = 1, 2, 3, 4, 5, 6
OK, PINS, PIN_IN_USE, PULL, BLOCK, STATE_MACHINE, INSTRUCTION_MEMORY, HALTED = range(8)


@dataclass(frozen=True)
class Config:
    """``epg_pico_quadrature_config_t``, and True to attach instead of claiming."""

    pin_a: int
    pin_b: int
    block: int = 0
    state_machine: int = ANY
    variant: int = COUNT
    pull: int = 0
    invert: bool = False
    attach: bool = False


class Board:
    """Requests to the test program, and encoders on the pins."""

    def __init__(self, pico: Emulator) -> None:
        self.pico = pico
        self.encoders: list[Config] = []
        pico.run_until("main")

    def ask(self, request: int) -> None:
        """Sends a request to the program and waits until it is done."""
        self.pico.write_word("done", 0)
        self.pico.write_word("request", request)
        for _ in range(200):
            self.pico.run(cycles=1000)
            if self.pico.word("done") == request and self.pico.word("request") == 0:
                return
        raise AssertionError(f"request {request} was not answered: {self.pico.call('faults')}")

    def init(self, *configs: Config) -> list[int]:
        """Initialises decoders, with an encoder on the pins of each; returns their errors."""
        self.encoders = list(configs)
        self.pico.write_word("count", len(configs))
        for n, config in enumerate(configs):
            for k, value in enumerate(astuple(config)):
                self.pico.write_word("parameters", int(value), offset=32 * n + 4 * k)
            if config.pin_a < 30 and config.pin_b < 30:
                self.pico.call("encoder", name=str(n), a=config.pin_a, b=config.pin_b)
        self.ask(INIT)
        return self.errors()

    def errors(self) -> list[int]:
        return [self.pico.word("errors", offset=4 * n) for n in range(len(self.encoders))]

    def read(self) -> list[int]:
        """The positions after one read of each decoder."""
        self.ask(READ)
        return self.positions()

    def positions(self) -> list[int]:
        return [self.pico.word("positions", offset=8 * n, size=8, signed=True) for n in range(len(self.encoders))]

    def watch(self, milliseconds: float) -> int:
        """Makes the program read repeatedly for this time; returns the number of reads."""
        before = self.pico.word("rounds")
        self.pico.write_word("request", WATCH)
        self.pico.run(milliseconds=milliseconds)
        self.pico.write_word("request", 0)
        self.pico.run(cycles=20_000)
        return self.pico.word("rounds") - before

    def move(self, n: int, kind: str, **parameters: object) -> None:
        self.pico.call("move", name=str(n), kind=kind, **parameters)

    def edges(self, n: int, directions: list[int], *, apart: int = 100) -> None:
        """Moves an encoder by single edges."""
        start = self.pico.cycle + 200
        self.move(n, "schedule", edges=[[start + apart * k, direction] for k, direction in enumerate(directions)])
        self.pico.run(cycles=400 + apart * len(directions))

    def rest(self) -> None:
        for n in range(len(self.encoders)):
            self.move(n, "rest")

    def true_counts(self) -> list[int]:
        """The number of edges that each encoder has made."""
        return [self.pico.call("encoder_count", name=str(n)) for n in range(len(self.encoders))]


@pytest.fixture(scope="session")
def image() -> Path:
    skip_if_missing(pico_sdk, arm_gcc, node, rp2040js)
    return build(PROJECT, targets=["encoders"]) / "encoders.elf"


@pytest.fixture
def new_board(image: Path) -> Iterator[Callable[[], Board]]:
    """Makes boards; checks at the end that none has had a fault."""
    made: list[Emulator] = []

    def make() -> Board:
        made.append(Emulator(image))
        return Board(made[-1])

    yield make
    for pico in made:
        faults = pico.call("faults")
        pico.close()
        assert faults == []


@pytest.fixture
def board(new_board: Callable[[], Board]) -> Board:
    return new_board()
