# SPDX-License-Identifier: Apache-2.0
"""The outputs become safe after each fault of the program; RP2040 images in the emulator.

The bench has an H-bridge at a quarter of full duty (pins 2, 7, 8), and a lamp that is off when pin 15 is high.  It runs
from flash.  From its first cycle on, core 1 must not access flash: the outputs become safe without it.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from tests.doubles.rp2040.emulator import CYCLES_PER_MILLISECOND, Emulator
from tests.platforms.pico.images import PLATFORMS, images, skip_unless_emulated

VALUE, DIRECTION_A, DIRECTION_B, LAMP = 2, 7, 8, 15
SAFE = {VALUE: 0, DIRECTION_A: 0, DIRECTION_B: 0, LAMP: 1}
FAULT, PANIC, STUCK, ENABLE, DISABLE, FLASH, STOP, START, _, OVERFLOW = range(1, 11)
FAULT_NONE, FAULT_NOT_FINITE, FAULT_OVERRUN, FAULT_WATCHDOG, FAULT_PROCESSOR = 0, 1, 3, 11, 12
WATCHDOG_MS, CORE0_TIMEOUT_MS = 100, 500
MODEL = "bench_model_private_bench_"
"""EPG's prefix for the names of a model's own variables."""
GUARD = "write that the MPU forbids"
"""What the emulator says of a stack that has grown into its guard."""
NOT_PERMITTED = -4
"""PICO_ERROR_NOT_PERMITTED."""


@pytest.fixture(params=PLATFORMS)
def pico(request: pytest.FixtureRequest) -> Iterator[Emulator]:
    with driving(request.param) as emulator:
        yield emulator


@contextmanager
def driving(platform: str) -> Iterator[Emulator]:
    """The bench after 20 ms, while it drives the motor."""
    skip_unless_emulated(platform)
    with Emulator(images("pico", platform, "user_bench") / "user_bench.elf", wait_states=True) as emulator:
        emulator.call("watch_pins", pins=[VALUE, DIRECTION_A, DIRECTION_B, LAMP])
        emulator.run_until("sleep_between_ticks", core=1)
        emulator.call("forbid_flash", core=1)
        emulator.run(milliseconds=20)
        assert status(emulator) == (True, FAULT_NONE)
        assert levels(emulator)[DIRECTION_A] == 1 and levels(emulator)[LAMP] == 0
        yield emulator


def levels(pico: Emulator) -> dict[int, int]:
    """The level of each pin; the chip drives all of them."""
    states = {pin: pico.call("pin", pin=pin) for pin in SAFE}
    assert all(state["output"] for state in states.values()), states
    return {pin: state["level"] for pin, state in states.items()}


def edges(pico: Emulator, pin: int) -> list[int]:
    """The cycles at which the pin has changed since the last call."""
    return [cycle for cycle, number, *_ in pico.call("take", log="pins") if number == pin]


def status(pico: Emulator) -> tuple[bool, int]:
    """Enabled and fault, as the user's code read them last."""
    enabled, fault = struct.unpack_from("<B3xI", pico.read("status", 8))
    return bool(enabled), fault


def missed(pico: Emulator) -> int:
    return struct.unpack_from("<I", pico.read("status", 28), 24)[0]


def order(pico: Emulator, what: int, milliseconds: float = 3) -> None:
    pico.write_word("order", what)
    pico.run(milliseconds=milliseconds)


def assert_stays_safe(pico: Emulator, milliseconds: float) -> None:
    """The outputs are safe now and stay so for this time: no output has an edge."""
    pico.call("take", log="pins")
    assert levels(pico) == SAFE
    pico.run(milliseconds=milliseconds)
    assert pico.call("take", log="pins") == []
    assert levels(pico) == SAFE


def assert_reset_and_safe(pico: Emulator, fault: int, within: float) -> None:
    """The watchdog resets within this many ms.  Then everything runs, but disabled until a request to enable."""
    before = len(pico.run(cycles=1)["resets"])
    end = pico.cycle + within * CYCLES_PER_MILLISECOND
    while len((state := pico.run(milliseconds=0.1))["resets"]) == before:
        assert pico.cycle < end, state
    pico.call("forbid_flash", core=1, forbidden=False)  # core 1 starts again, by code in flash
    pico.run(milliseconds=25)
    assert status(pico) == (False, fault)
    assert_stays_safe(pico, 20)
    order(pico, ENABLE)
    assert status(pico) == (True, FAULT_NONE)
    assert levels(pico)[DIRECTION_A] == 1


def test_outputs_are_safe_before_main() -> None:
    skip_unless_emulated("bare_metal")
    with Emulator(images("pico", "bare_metal", "user_bench") / "user_bench.elf") as pico:
        pico.call("watch_pins", pins=list(SAFE))
        pico.run_until("main", core=0)
        assert levels(pico) == SAFE
        driven = {pin: cycle for cycle, pin, _, is_driven in pico.call("take", log="pins") if is_driven}
        assert set(driven) == set(SAFE)
        start = pico.run_until("epg_pico_start", core=0)["cycle"]
        assert max(driven.values()) < start


@pytest.mark.parametrize("what", [FAULT, PANIC])
def test_a_fault_on_core_0(pico: Emulator, what: int) -> None:
    order(pico, what, milliseconds=1)
    assert {fault["core"] for fault in pico.call("faults")} <= {0}
    assert_stays_safe(pico, 20)
    assert_reset_and_safe(pico, FAULT_PROCESSOR, within=WATCHDOG_MS)


def test_a_fault_on_core_1(pico: Emulator) -> None:
    pico.write_word(MODEL + "fault", 1)
    pico.call("take", log="pins")
    pico.run(milliseconds=1.1)
    first, *later = pico.call("faults")
    assert first["core"] == 1 and "flash" not in first["cause"]
    last_edge = max(cycle for cycle, *_ in pico.call("take", log="pins"))
    assert all(fault["cycle"] > last_edge for fault in later), "the SDK's handler, in flash, runs after EPG's"
    assert_stays_safe(pico, 20)
    assert_reset_and_safe(pico, FAULT_PROCESSOR, within=WATCHDOG_MS)


@pytest.mark.parametrize("core", [0, 1])
def test_a_stack_overflow(core: int) -> None:
    """The fault stores registers in the stack.  If they hit its guard, too, the core locks up; the watchdog resets."""
    with driving("bare_metal") as pico:
        if core == 0:
            order(pico, OVERFLOW, milliseconds=1)
        else:
            pico.write_word(MODEL + "depth", 1000)
            pico.run(milliseconds=1.1)
        faults = pico.call("faults")
        assert (faults[0]["core"], faults[0]["cause"]) == (core, GUARD)
        if any(fault["lockup"] and fault["cause"] == GUARD for fault in faults):
            limit = WATCHDOG_MS + (CORE0_TIMEOUT_MS if core == 0 else 0)
            assert_reset_and_safe(pico, FAULT_WATCHDOG, within=limit)
        else:
            assert_stays_safe(pico, 20)
            assert_reset_and_safe(pico, FAULT_PROCESSOR, within=WATCHDOG_MS)


def test_core_0_stuck(pico: Emulator) -> None:
    order(pico, STUCK, milliseconds=10)
    assert levels(pico)[DIRECTION_A] == 1, "control goes on while core 0 may come back"
    assert_reset_and_safe(pico, FAULT_WATCHDOG, within=CORE0_TIMEOUT_MS + WATCHDOG_MS)


def test_a_model_that_never_returns(pico: Emulator) -> None:
    pico.write_word(MODEL + "loops", 0xFFFFFFFF)
    assert_reset_and_safe(pico, FAULT_WATCHDOG, within=WATCHDOG_MS + 2)


def test_a_value_that_is_not_finite(pico: Emulator) -> None:
    pico.write_word(MODEL + "not_finite", 1)
    pico.run(milliseconds=1.1)
    assert_stays_safe(pico, 5)
    assert pico.call("faults") == []
    assert status(pico) == (False, FAULT_NOT_FINITE)


def test_overruns_disable_and_missed_ticks_are_counted(pico: Emulator) -> None:
    """A step takes about 2.4 ms: each cycle runs once, late, and two ticks have no cycle."""
    pico.write_word(MODEL + "loops", 2_400 * 125 // 5)
    pico.run(milliseconds=30)
    assert status(pico) == (False, FAULT_OVERRUN)
    assert missed(pico) > 3
    pico.write_word(MODEL + "loops", 0)
    pico.run(milliseconds=5)
    count = missed(pico)
    assert_stays_safe(pico, 10)
    assert missed(pico) == count


def test_flash_is_written_only_while_outputs_are_safe(pico: Emulator) -> None:
    order(pico, FLASH)
    assert pico.word("answer", signed=True) == NOT_PERMITTED
    order(pico, DISABLE)
    order(pico, FLASH)
    assert pico.word("answer", signed=True) == 0
    assert missed(pico) == 0, "nobody waited for those ticks"
    order(pico, ENABLE)
    assert status(pico) == (True, FAULT_NONE)
    pico.run(milliseconds=20)
    assert missed(pico) == 0


def test_stop_and_start(pico: Emulator) -> None:
    order(pico, STOP)
    assert_stays_safe(pico, 250)
    assert pico.run(cycles=1)["resets"] == [], "the watchdog is off"
    pico.call("forbid_flash", core=1, forbidden=False)
    order(pico, START, milliseconds=15)
    assert pico.word("answer") == 1
    assert status(pico) == (True, FAULT_NONE)
    assert levels(pico)[DIRECTION_A] == 1


def test_no_other_core_is_needed_for_safety(pico: Emulator) -> None:
    """After a fault of core 0, core 0 executes nothing any more: a second order has no effect."""
    order(pico, FAULT, milliseconds=1)
    turns = pico.word("turns")
    order(pico, ENABLE, milliseconds=10)
    assert pico.word("turns") == turns
    assert levels(pico) == SAFE
