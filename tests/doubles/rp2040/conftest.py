# SPDX-License-Identifier: Apache-2.0
"""Fixtures: the programs that test the emulator, and a board that runs their cases."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.doubles.toolchain import arm_gcc, node, pico_sdk, rp2040js, skip_if_missing

from .build import build
from .emulator import Emulator


@pytest.fixture(scope="session")
def programs() -> Path:
    """The folder with serial.elf and cases.elf."""
    skip_if_missing(pico_sdk, arm_gcc, node, rp2040js)
    return build("tests/doubles/rp2040/programs")


class Board:
    """Runs the cases of ``cases.elf``."""

    def __init__(self, pico: Emulator) -> None:
        self.pico = pico
        pico.run_until("main")

    def begin(self, case: str, *arguments: int) -> None:
        """Starts a case and does not wait for its end."""
        for n, value in enumerate(arguments):
            self.pico.write_word("arguments", value, offset=4 * n)
        self.pico.write_word("request", self.pico.call("symbol", name=case)["address"])

    def case(self, case: str, *arguments: int, milliseconds: float = 50) -> list[int]:
        """Runs a case to its end and returns its results."""
        done = self.pico.word("done")
        self.begin(case, *arguments)
        end = self.pico.cycle + milliseconds * 125_000
        while self.pico.word("done") == done:
            assert self.pico.cycle < end, (self.pico.call("state"), self.pico.call("faults"))
            self.pico.run(cycles=5000)
        return self.results()

    def results(self) -> list[int]:
        data = self.pico.read("results")
        return [int.from_bytes(data[n : n + 4], "little") for n in range(0, len(data), 4)]


@pytest.fixture
def new_board(programs: Path) -> Iterator[Callable[..., Board]]:
    made: list[Emulator] = []

    def make(**options: Any) -> Board:
        made.append(Emulator(programs / "cases.elf", **options))
        return Board(made[-1])

    yield make
    for pico in made:
        pico.close()


@pytest.fixture
def board(new_board: Callable[..., Board]) -> Board:
    return new_board()
