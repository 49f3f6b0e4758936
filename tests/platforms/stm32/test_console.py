# SPDX-License-Identifier: Apache-2.0
"""JIWY's console on the emulated STM32H743: a UART by DMA, and parameters in flash when the power is cut."""

from __future__ import annotations

import pytest

from tests.doubles.stm32.machine import Machine, PowerCut
from tests.platforms.stm32.console import ask, boot, start
from tests.platforms.stm32.images import PLATFORMS

NAME = "Pan\\PID\\kp"
DAMAGED = 68
"""Offset of the counter in epg_uart_t: uart.h, epg/port_uart.h and epg/ring.h."""


def _gain(chip: Machine) -> float:
    (value,) = (word.partition("=")[2] for word in ask(chip, "get").split() if word.startswith(NAME + "="))
    return float(value)


@pytest.mark.parametrize("platform", PLATFORMS)
def test_it_answers_by_dma_and_feeds_the_watchdog(platform: str) -> None:
    chip = start(platform)
    assert ask(chip, "version").startswith("ok version name=jiwy node=JIWY_node ")
    assert chip.watchdog.on
    assert chip.dma.errors == chip.cache.hazards == chip.resets == []


@pytest.mark.parametrize("platform", PLATFORMS)
@pytest.mark.parametrize("baud", [57_600, 1_500_000])
def test_bytes_at_another_baud_rate_disturb_nothing(platform: str, baud: int) -> None:
    """They come without pause, each with a framing error."""
    chip = start(platform)
    line = chip.uarts[3].line
    line.baud = baud
    line.send(bytes(range(256)) * 40)
    chip.run(0.05)
    line.sent.clear()
    chip.run(0.001)
    line.baud = None
    line.send(b"\r\n")
    chip.run(0.01)
    line.take()
    stats = dict(word.split("=") for word in ask(chip, "stats").split() if "=" in word)
    assert {stats[name] for name in ("missed", "overruns", "faults", "lines_dropped")} == {"0"}
    assert stats["enabled"] == "1"
    assert chip.word("jiwy_stlink", offset=DAMAGED) > 200
    assert chip.dma.errors == chip.cache.hazards == chip.resets == []


def test_parameters_are_whole_when_the_power_is_cut_in_any_operation() -> None:
    chip = start("bare_metal")
    ask(chip, f"set {NAME}=2.5")
    ask(chip, "disable")
    assert ask(chip, "save").startswith("ok save")
    count = len(chip.flash.operations)
    assert count >= 3, "an erasure, data, and the head"
    for operation in range(1, count + 1):
        ask(chip, f"set {NAME}={operation}")
        ask(chip, "disable")
        chip.flash.cut_power_in(operation)
        with pytest.raises(PowerCut):
            ask(chip, "save")
        chip.power_cycle()
        boot(chip)
        assert _gain(chip) == 2.5
    assert chip.dma.errors == chip.cache.hazards == []
