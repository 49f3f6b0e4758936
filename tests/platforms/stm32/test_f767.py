# SPDX-License-Identifier: Apache-2.0
"""JIWY's image for a Nucleo-F767ZI on an emulated STM32F767: start, cycle, console, and parameters in flash."""

from __future__ import annotations

import pytest

from tests.doubles.stm32.f767 import Stm32f767
from tests.doubles.stm32.machine import PowerCut
from tests.doubles.stm32.usb_host import UsbHost
from tests.doubles.toolchain import skip_if_missing, unicorn
from tests.platforms.stm32.console import ask, boot, stats
from tests.platforms.stm32.images import PLATFORMS, images
from tests.platforms.stm32.test_faults import (
    ENDLESS,
    UNDEFINED,
    assert_reported_after_the_watchdogs_reset,
    wait_for_reset,
)

NAME = "Pan\\PID\\kp"
TICK = 50
"""The interrupt of TIM5."""
MOTORS = ("PE9", "PF13", "PF15", "PE11", "PE13", "PF14")


def machine(platform: str, *, clocks: int = 4, name: str = "jiwy") -> Stm32f767:
    skip_if_missing(unicorn)
    return Stm32f767(images(platform, "console", "nucleo_f767zi") / f"{name}_firmware.elf", clocks=clocks)


@pytest.mark.parametrize("platform", PLATFORMS)
def test_it_makes_the_clocks_and_runs(platform: str) -> None:
    chip = machine(platform, clocks=1)
    chip.run_to("epg_start_clocks", longest=0.1)
    assert {pin: chip.pin(pin) for pin in MOTORS} == dict.fromkeys(MOTORS, 0)
    chip.run_to("main", longest=0.1)
    assert (chip.clocks.core, chip.clocks.latency, chip.clocks.pll(1, "q")) == (216_000_000, 7, 48_000_000)
    assert (chip.timer_clock(1), chip.timer_clock(2)) == (108_000_000, 216_000_000)
    assert (chip.uart_clock(1), chip.uart_clock(2)) == (54_000_000, 108_000_000)
    chip.run(0.02)
    assert chip.word("error", size=1) == 0
    assert chip.word("running") == chip.symbols["stm32"]
    assert chip.timers["TIM5"].updates in range(15, 21), "the tick"
    assert chip.timers["TIM1"].updates in range(300, 401), "the tick has started the timer of the PWM outputs"
    assert chip.resets == chip.dma.errors == []


def test_it_refuses_without_the_external_clock() -> None:
    chip = machine("bare_metal")
    chip.clocks.crystal = 0
    read = chip.clocks.read
    chip.clocks.read = lambda offset: read(offset) & ~(1 << 17) if offset == 0 else read(offset)  # type: ignore[method-assign]
    chip.run_to("main", longest=0.3)
    chip.run(0.01)
    assert chip.clocks.core == 16_000_000
    assert chip.word("error", size=1) == 2, "EPG_MCU_ERROR_CLOCK"


@pytest.mark.parametrize(("platform", "two_banks"), [("bare_metal", False), ("freertos", False), ("bare_metal", True)])
def test_the_tick_goes_on_while_parameters_are_saved(platform: str, two_banks: bool) -> None:
    """With one bank, nothing reads the flash meanwhile, although bytes arrive whose interrupt has its code there."""
    chip = machine(platform)
    line = chip.uarts[3].line
    chip.flash.two_banks = two_banks
    chip.flash.erase_time = 0.3
    boot(chip)
    assert ask(chip, "version").startswith("ok version name=jiwy node=JIWY_node ")
    assert "error" in ask(chip, "save"), "the target is enabled"
    ask(chip, f"set {NAME}=2.5")
    ask(chip, "disable")
    chip.watch_flash()
    line.send(b"save\r\n")
    chip.run_until(lambda: chip.flash.busy, longest=0.1)
    ticks = chip.interrupts(TICK)
    line.send(b"\r\n")
    chip.run(0.1)
    assert chip.flash.busy and chip.interrupts(TICK) - ticks in range(99, 102), "the tick of 1 ms"
    chip.run_until(lambda: b"ok save" in line.received, longest=0.5)
    chip.run(0.05)
    line.take()
    found = stats(chip)
    assert {found[name] for name in ("missed", "overruns", "faults")} == {"0"}
    assert bool(chip.flash.reads) == two_banks
    assert chip.resets == chip.dma.errors == chip.cache.hazards == []
    assert [kind for kind, _ in chip.flash.operations][:2] == ["erase", "program"]
    chip.power_cycle()
    boot(chip)
    assert f"{NAME}=2.5" in ask(chip, "get")


@pytest.mark.parametrize("platform", PLATFORMS)
def test_a_stop_that_comes_while_parameters_are_saved_wins(platform: str) -> None:
    """The enable that came before it does not act; an enable after it does."""
    chip = machine(platform)
    line = chip.uarts[3].line
    chip.flash.erase_time = 0.1
    boot(chip)
    ask(chip, f"set {NAME}=2.5")
    ask(chip, "disable")
    line.send(b"save\r\n")
    chip.run_until(lambda: chip.flash.busy, longest=0.1)
    line.send(b"enable\r\n")
    chip.run(0.03)
    line.send(b"disable\r\n")
    chip.run(0.03)
    assert chip.flash.busy
    assert b"able" not in line.received
    chip.run_until(lambda: b"ok disable" in line.received, longest=0.5)
    said = line.take().decode()
    assert "ok save" in said
    assert "error enable refused: stopped by" in said
    assert "state enabled=1" not in said
    assert stats(chip)["enabled"] == "0"
    assert "ok enable" in ask(chip, "enable")
    assert chip.resets == chip.dma.errors == chip.cache.hazards == []


@pytest.mark.parametrize("two_banks", [False, True])
def test_parameters_are_whole_when_the_power_is_cut(two_banks: bool) -> None:
    """In the erasure, in the first word, and in the last one, of the head."""
    chip = machine("bare_metal")
    chip.flash.two_banks = two_banks
    chip.flash.erase_time = 0.01
    boot(chip)
    ask(chip, f"set {NAME}=2.5")
    ask(chip, "disable")
    assert ask(chip, "save").startswith("ok save")
    for operation in (1, 2, len(chip.flash.operations)):
        ask(chip, f"set {NAME}={operation}")
        ask(chip, "disable")
        chip.flash.cut_power_in(operation)
        with pytest.raises(PowerCut):
            ask(chip, "save")
        chip.power_cycle()
        boot(chip)
        assert f"{NAME}=2.5" in ask(chip, "get")


@pytest.mark.parametrize("platform", PLATFORMS)
def test_the_console_answers_on_usb(platform: str) -> None:
    chip = machine(platform, name="usb")
    host = UsbHost(chip)
    chip.run_to("main")
    chip.run_until(lambda: host.configured, longest=0.3)
    (port,) = host.ports
    port.open()
    chip.run_until(lambda: b"ready" in port.received, longest=0.1)
    port.take()
    port.send(b"version\r\n")
    chip.run_until(lambda: b"ok version name=on_usb" in port.received, longest=0.5)
    assert chip.resets == chip.dma.errors == []


@pytest.mark.parametrize(("instruction", "fault"), [(UNDEFINED, "processor"), (ENDLESS, "watchdog")])
def test_a_fault_is_reported_after_the_watchdogs_reset(instruction: bytes, fault: str) -> None:
    """The start copies the program to SRAM1 again."""
    chip = machine("bare_metal")
    boot(chip)
    chip.patch("jiwy_model_step", instruction)
    wait_for_reset(chip)
    assert_reported_after_the_watchdogs_reset(chip, fault)


def test_encoders_count() -> None:
    chip = machine("bare_metal")
    chip.attach("TIM4", ("D", 12), ("D", 13), alternate_function=2)
    chip.attach("TIM8", ("C", 6), ("C", 7), alternate_function=3)
    boot(chip)
    chip.turn("TIM4", -30_000)
    chip.turn("TIM8", 5)
    chip.run(0.002)
    chip.turn("TIM4", -30_000)
    chip.run(0.002)
    size, count = 16, 8  # of decoder_t in quadrature.c, and the offset of its count
    counts = [chip.word("decoders", offset=size * index + count, signed=True) for index in (3, 7)]
    assert counts == [-60_000, 5]
