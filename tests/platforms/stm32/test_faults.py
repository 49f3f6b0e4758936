# SPDX-License-Identifier: Apache-2.0
"""Faults of the program on the emulated STM32H743: safe outputs, the right name, and a report after a reset."""

from __future__ import annotations

import math
import struct

import pytest

from tests.doubles.stm32.agenda import UNITS
from tests.doubles.stm32.machine import WATCHDOG, Machine
from tests.platforms.stm32.console import boot, start, stats
from tests.platforms.stm32.images import PLATFORMS
from tests.platforms.stm32.jiwy import MOTORS, Jiwy, motors_are_off

UNDEFINED, ENDLESS = b"\x00\xde", b"\xfe\xe7"
"""UDF, and a branch to itself."""
HOMED = 900
GAINS, COUNT = "jiwy_model_private_xx_P", 30
"""The parameters of the model.  EPG adds the prefix to the names of a model's own variables."""
OVERRUNS = 10
"""overrun_limit of targets/robots/jiwy/jiwy.tcf."""

both = pytest.mark.parametrize("platform", PLATFORMS)


def assert_disabled(jiwy: Jiwy, fault: str) -> None:
    """Safe now and from now on."""
    before = len(jiwy.chip.pin_changes)
    for _ in range(20):
        jiwy.run(1)
        assert jiwy.is_safe()
    assert [change for change in jiwy.chip.pin_changes[before:] if change.pin in MOTORS and change.level] == []
    said = jiwy.stats()
    assert (said["enabled"], said["fault"]) == ("0", fault)
    assert jiwy.chip.resets == []


@both
def test_a_value_that_is_not_finite(platform: str) -> None:
    jiwy = Jiwy(platform)
    jiwy.run(HOMED)
    jiwy.ask("pan_subscriber=1 tilt_subscriber=0.5")
    jiwy.run(20)
    assert not jiwy.is_safe()
    (nan,) = struct.unpack("<Q", struct.pack("<d", math.nan))
    for offset in range(0, 8 * COUNT, 8):
        jiwy.chip.write_word(GAINS, nan, offset=offset, size=8)
    jiwy.run(1)
    assert jiwy.is_safe(), "in the same cycle"
    assert_disabled(jiwy, "not_finite")


@both
def test_cycles_that_are_too_long(platform: str) -> None:
    """A step takes 2.4 ms: each cycle runs once, late, and two ticks have no cycle."""
    jiwy = Jiwy(platform)
    jiwy.run(50)
    chip = jiwy.chip
    slow = True
    chip.before("jiwy_model_step", lambda: chip.stall(chip.now + UNITS * 24 // 10_000) if slow else None)
    passed = jiwy.run_until(lambda: not any(jiwy.duties[-1]), cycles=4 * OVERRUNS)
    assert passed >= 2 * OVERRUNS
    slow = False
    jiwy.run(2)
    missed = int(jiwy.stats()["missed"])
    assert missed >= OVERRUNS
    assert_disabled(jiwy, "overrun")
    assert int(jiwy.stats()["missed"]) == missed


def wait_for_reset(chip: Machine) -> None:
    """With slow instructions, because the handler of faults polls."""
    chip.processor.clocks = 400
    chip.processor.set_frequency(chip.processor.frequency)
    chip.run_until(lambda: chip.resets != [], longest=0.2)
    chip.processor.clocks = 4


def assert_reported_after_the_watchdogs_reset(chip: Machine, fault: str) -> None:
    """The target runs again, but disabled."""
    assert chip.resets == [WATCHDOG]
    boot(chip)
    for _ in range(20):
        chip.run(0.001)
        assert motors_are_off(chip)
    said = stats(chip)
    assert (said["enabled"], said["fault"], said["faults"]) == ("0", fault, "1")
    assert int(said["cycles"]) >= 20


@both
def test_a_fault_of_the_processor_below_the_tick(platform: str) -> None:
    """An undefined instruction takes the place of a function that sends."""
    chip = start(platform)
    restore = chip.patch("epg_port_uart_send", UNDEFINED)
    chip.uarts[3].line.send(b"version\r\n")
    chip.run(0.005)
    assert {pin: chip.pin(pin) for pin in MOTORS} == dict.fromkeys(MOTORS, 0)
    wait_for_reset(chip)
    restore()
    assert_reported_after_the_watchdogs_reset(chip, "processor")


@both
def test_a_fault_of_the_processor_in_the_cycle(platform: str) -> None:
    """The program is in ITCM, to which the start copies the program again."""
    chip = start(platform)
    assert chip.symbols["jiwy_model_step"] < 0x10000
    chip.patch("jiwy_model_step", UNDEFINED)
    chip.run(0.002)
    assert {pin: chip.pin(pin) for pin in MOTORS} == dict.fromkeys(MOTORS, 0)
    wait_for_reset(chip)
    assert_reported_after_the_watchdogs_reset(chip, "processor")


@both
def test_a_model_that_never_returns(platform: str) -> None:
    chip = start(platform)
    chip.patch("jiwy_model_step", ENDLESS)
    chip.run_until(lambda: chip.resets != [], longest=0.12)
    assert_reported_after_the_watchdogs_reset(chip, "watchdog")


@both
def test_communication_that_never_returns(platform: str) -> None:
    """Control goes on for half a second, because the communication may come back; then the watchdog is not fed."""
    chip = start(platform)
    restore = chip.patch("epg_port_uart_send", ENDLESS)
    chip.uarts[3].line.send(b"version\r\n")
    begin = chip.seconds
    chip.run(0.4)
    assert any(chip.pin(pin) for pin in MOTORS), "control goes on"
    chip.run_until(lambda: chip.resets != [], longest=0.5)
    assert 0.5 < chip.seconds - begin < 0.65
    restore()
    assert_reported_after_the_watchdogs_reset(chip, "watchdog")
