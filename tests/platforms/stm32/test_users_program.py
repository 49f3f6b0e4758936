# SPDX-License-Identifier: Apache-2.0
"""``examples/existing_cubemx_repository`` on the emulated STM32H743: program and controller share the chip."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from tests.doubles.stm32.machine import Machine
from tests.doubles.stm32.nvic import FIRST
from tests.doubles.toolchain import skip_if_missing, unicorn
from tests.examples.test_existing_cubemx_repository import configure, repository_in, run

COUNTS_PER_RADIAN = 4096 * 18 / math.tau
"""Of controller/turntable.tcf."""
BUTTON = 40
"""EXTI15_10."""


@pytest.fixture(scope="module")
def elf(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The example as it is built in a project of STM32CubeMX: its start-up code, clocks and handlers."""
    skip_if_missing(unicorn)
    repository = repository_in(tmp_path_factory.mktemp("station"))
    configure(repository)
    run(repository, "cmake", "--build", "--preset", "Release")
    return repository / "build/Release/station.elf"


@pytest.fixture
def chip(elf: Path) -> Machine:
    chip = Machine(elf, clocks=8)
    chip.attach("TIM4", ("D", 12), ("D", 13), alternate_function=2)
    chip.run_to("main")
    return chip


def ask(chip: Machine, command: str) -> str:
    line = chip.uarts[2].line
    line.take()
    line.send(command.encode() + b"\r\n")
    chip.run_until(lambda: re.search(rb"^(ok|error).*\n", line.received, re.MULTILINE) is not None, longest=0.5)
    return line.take().decode()


def test_the_program_and_the_controller_share_the_chip(chip: Machine) -> None:
    """The program's interrupts and its report go on; the controller counts, drives, and answers at its console.

    The program has the values of cycles after its first call.
    """
    begin = chip.seconds
    chip.run(0.1)
    assert "ok enable" in ask(chip, "enable")
    chip.turn("TIM4", round(0.5 * COUNTS_PER_RADIAN))
    for _ in range(3):
        chip.processor.nvic.pend(FIRST + BUTTON)
        chip.run(0.01)
    assert "ok setpoint" in ask(chip, "angle=0.8")
    chip.run(0.005)
    assert chip.timers["TIM1"].duty(1), "the error drives the motor"
    assert (chip.pin("PE10"), chip.pin("PE12")) == (1, 0)
    chip.run_until(lambda: b"cycles" in chip.uarts[3].line.received, longest=2.2, step=0.01)
    chip.run(0.005)
    said = chip.uarts[3].line.take().decode()
    assert re.fullmatch(r"(pressed 3 times\n){2}(499|500) mrad, \d+ cycles\n", said)
    assert chip.word("presses") == 3
    passed = 1000 * (chip.seconds - begin)
    assert chip.word("uwTick") == pytest.approx(passed, abs=2)
    assert {change.level for change in chip.pin_changes if change.pin == "PB0"} >= {0, 1}
    stats = dict(re.findall(r"(\w+)=(\S+)", ask(chip, "stats")))
    assert int(stats["cycles"]) == pytest.approx(1000 * float(stats["time"]), abs=1.1)
    assert {stats[name] for name in ("missed", "overruns", "faults")} == {"0"}
    assert chip.dma.errors == chip.cache.hazards == chip.resets == []


def test_the_programs_handler_runs_after_a_fault_with_safe_outputs(chip: Machine) -> None:
    """Its HardFault_Handler never returns: the watchdog resets."""
    chip.run(0.1)
    ask(chip, "enable")
    ask(chip, "angle=0.8")
    chip.run(0.005)
    chip.patch("epg_port_uart_send", b"\x00\xde")
    chip.uarts[2].line.send(b"version\r\n")
    chip.run(0.01)
    assert chip.processor.pc & ~3 == chip.symbols["HardFault_Handler"] & ~3
    assert {pin: chip.pin(pin) for pin in ("PE9", "PE10", "PE12")} == {"PE9": 0, "PE10": 0, "PE12": 0}
    chip.run_until(lambda: chip.resets != [], longest=0.2)
