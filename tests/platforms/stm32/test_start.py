# SPDX-License-Identifier: Apache-2.0
"""EPG's start-up code on the emulated STM32H743: from the reset until the target runs, or refuses to start."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.doubles.stm32.clocks import CR, REVISION_Y
from tests.doubles.stm32.dma import CR as DMA_CR
from tests.doubles.stm32.dma import MEMORY_STEPS as MINC
from tests.doubles.stm32.machine import Machine
from tests.doubles.stm32.timers import CEN, CNT, CR1
from tests.doubles.toolchain import skip_if_missing, unicorn
from tests.platforms.stm32.images import PLATFORMS, images

HSE_READY = 1 << 17
OTHER_STREAMS = 32
"""Offset in the generated table, epg_stm32_hardware_t."""
ERROR_RESOURCE = 4
RECEIVE, TRANSMIT = 45, 46
"""The requests of USART3."""


def image(platform: str, name: str = "jiwy") -> Path:
    skip_if_missing(unicorn)
    return images(platform, "xrce") / f"{name}_firmware.elf"


def motor_pins(elf: Path) -> set[str]:
    """The pins of the generated table of outputs."""
    (source,) = elf.parent.glob("epg/**/jiwy_stm32.c")
    table = source.read_text(encoding="utf-8").partition("outputs[] = {")[2].partition("};")[0]
    return set(re.findall(r"/\* (P[A-Z]\d+):", table))


@pytest.mark.parametrize("platform", PLATFORMS)
def test_outputs_are_safe_before_the_clocks_and_main(platform: str) -> None:
    elf = image(platform)
    chip = Machine(elf)
    chip.run_to("epg_start_clocks", longest=0.1)
    assert len(motor_pins(elf)) == 6
    assert {pin: chip.pin(pin) for pin in motor_pins(elf)} == dict.fromkeys(motor_pins(elf), 0)
    chip.run_to("main", longest=0.1)
    assert {pin: chip.pin(pin) for pin in motor_pins(elf)} == dict.fromkeys(motor_pins(elf), 0)


@pytest.mark.parametrize("platform", PLATFORMS)
@pytest.mark.parametrize(("name", "mhz"), [("jiwy", 400), ("fast", 480), ("relbot", 400)])
def test_it_makes_the_clocks_and_runs(platform: str, name: str, mhz: int) -> None:
    chip = Machine(image(platform, name))
    chip.run_to("main", longest=0.1)
    assert chip.clocks.core == mhz * 1_000_000
    assert (chip.timer_clock(1), chip.timer_clock(2)) == (mhz * 500_000, mhz * 500_000)
    assert (chip.uart_clock(1), chip.uart_clock(2)) == (mhz * 250_000, mhz * 250_000)
    chip.run(0.02)
    assert chip.word("error", size=1) == 0
    assert chip.word("running") == chip.symbols["stm32"]
    assert len({change.pin for change in chip.pin_changes}) >= 6
    assert chip.resets == []


def test_it_refuses_without_the_external_clock() -> None:
    """Nothing waits forever: the chip stays on its internal clock, and the target does not start."""
    chip = Machine(image("bare_metal"))
    read = chip.clocks.read
    chip.clocks.read = lambda offset: read(offset) & ~(HSE_READY if offset == CR else 0)  # type: ignore[method-assign]
    chip.run_to("epg_one_core_panic", longest=0.5)
    assert chip.clocks.core == 64_000_000
    assert chip.word("wrong_clock", offset=8) == 64_000_000
    assert chip.word("running") == 0


def test_old_silicon_refuses_480_mhz() -> None:
    chip = Machine(image("bare_metal", "fast"), revision=REVISION_Y)
    chip.run_to("epg_one_core_panic", longest=0.5)
    assert chip.clocks.core == 64_000_000
    assert chip.word("running") == 0


@pytest.mark.parametrize("platform", PLATFORMS)
def test_pwm_starts_by_the_trigger_of_the_tick(platform: str) -> None:
    """Both counters show the same time from then on: one clock of the tick's timer is four of the PWM's."""
    chip = Machine(image(platform))
    chip.run_to("main", longest=0.1)
    tick, pwm = chip.timers["TIM15"], chip.timers["TIM1"]
    chip.run_until(lambda: pwm.read(CR1) & CEN != 0, longest=0.05, step=0.0001)
    assert pwm.listens_to() == "TIM15" and tick.read(CR1) & CEN
    chip.run(0.0123)
    clocks = (tick.read(CNT) & 0xFFFF) * (tick.prescaler + 1)
    assert 0 <= (pwm.read(CNT) - clocks) % (pwm.period + 1) <= tick.prescaler


def test_the_uart_gets_streams_that_the_program_leaves() -> None:
    """One is the program's by its .ioc, one is set up, and one has a request already."""
    chip = Machine(image("bare_metal"))
    chip.run_to("main", longest=0.1)
    chip.processor.cpu.mem_write(chip.symbols["epg_stm32_hardware"] + OTHER_STREAMS, (1 << 7).to_bytes(4, "little"))
    chip.dma.streams[6].registers[DMA_CR] = MINC
    chip.dma.mux[5] = 10
    chip.run(0.01)
    assert {number: request for number, request in enumerate(chip.dma.mux) if request} == {
        3: TRANSMIT,
        4: RECEIVE,
        5: 10,
    }
    assert chip.word("running") != 0


def test_it_refuses_to_start_without_two_streams() -> None:
    chip = Machine(image("bare_metal"))
    chip.run_to("main", longest=0.1)
    chip.processor.cpu.mem_write(chip.symbols["epg_stm32_hardware"] + OTHER_STREAMS, b"\xff\xfe\x00\x00")
    chip.run_to("epg_one_core_panic", longest=0.5)
    assert chip.word("error", size=1) == ERROR_RESOURCE
    assert chip.word("running") == 0
    assert not any(chip.dma.mux)
