# SPDX-License-Identifier: Apache-2.0
"""The control loop in the emulator: RP2040 images with the compiler's arithmetic.  Times are cycles of 8 ns.

The flash has its cache, and the cores wait for each other; docs/emulator.md lists what the emulator simulates.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator

import pytest

from tests.doubles.rp2040.emulator import CYCLES_PER_MILLISECOND, Emulator
from tests.platforms.pico.images import PLATFORMS, images, skip_unless_emulated

PERIOD = CYCLES_PER_MILLISECOND
MOTOR_PERIOD = 6250
"""Cycles of the motors' PWM at 20 kHz."""
TICK_SLICE, PAN_SLICE, TILT_SLICE = 7, 1, 2
WRAP_EXCEPTION = 16 + 4
"""PWM_IRQ_WRAP: RP2040 data sheet, 2.3.2."""


@pytest.fixture(scope="module", params=PLATFORMS)
def pico(request: pytest.FixtureRequest) -> Iterator[Emulator]:
    """A user's executable after 0.1 s, with all events recorded.  From its start on, core 1 must not access flash."""
    skip_unless_emulated(request.param)
    elf = images("pico", request.param, "user_jiwy") / "user_jiwy.elf"
    with Emulator(elf, wait_states=True) as emulator:
        emulator.call("watch_exceptions", numbers=[WRAP_EXCEPTION])
        emulator.call("watch_pwm", slices=[TICK_SLICE, PAN_SLICE, TILT_SLICE], wraps=True)
        emulator.call("watch_span", name="cycle", core=1, **{"from": "on_wrap", "to": "return"})
        emulator.run_until("sleep_between_ticks", core=1)
        emulator.call("forbid_flash", core=1)
        emulator.run(milliseconds=100)
        yield emulator


@pytest.fixture(scope="module")
def ticks(pico: Emulator) -> list[int]:
    """The cycles at which core 1 entered the handler; the other core never enters it."""
    log = [entry for entry in pico.call("take", log="exceptions") if entry[3]]
    assert {core for _, core, _, _ in log} == {1}
    return [cycle for cycle, *_ in log]


@pytest.fixture(scope="module")
def wraps(pico: Emulator) -> dict[int, list[int]]:
    """The wraps of each slice."""
    found: dict[int, list[int]] = {}
    for cycle, slice_, *_ in pico.call("take", log="pwm"):
        found.setdefault(slice_, []).append(cycle)
    return found


def test_every_tick_comes_at_the_same_phase(ticks: list[int]) -> None:
    assert len(ticks) >= 90
    assert {tick - ticks[0] - k * PERIOD for k, tick in enumerate(ticks)} == {0}


def test_the_handler_begins_with_the_wrap(ticks: list[int], wraps: dict[int, list[int]]) -> None:
    entry = {tick - wrap for tick, wrap in zip(ticks, wraps[TICK_SLICE])}
    assert len(entry) == 1 and max(entry) <= 20, "interrupt latency of the M0+ out of WFI"


def test_motors_have_the_phase_of_the_tick(wraps: dict[int, list[int]]) -> None:
    for motor in (PAN_SLICE, TILT_SLICE):
        assert {(wrap - wraps[TICK_SLICE][0]) % MOTOR_PERIOD for wrap in wraps[motor]} == {0}


def test_core_1_reads_no_flash_in_a_cycle(pico: Emulator, ticks: list[int]) -> None:
    span = pico.call("span", name="cycle")
    assert len(span["passages"]) >= len(ticks) - 1
    assert span["flash_total"] == 0, span["flash"][:10]


def test_no_fault(pico: Emulator) -> None:
    assert pico.call("faults") == []
    enabled, fault = struct.unpack_from("<B3xI", pico.read("status", 8))
    assert (enabled, fault) == (1, 0)


def test_statistics_tell_the_same(pico: Emulator, ticks: list[int]) -> None:
    """The firmware's lateness and computation times agree with the times that the emulator measures."""
    assert statistics(pico)["missed"] == 0
    assert statistics(pico)["overruns"] == 0
    assert statistics(pico)["outputs_late"] == 0
    assert abs(statistics(pico)["cycles"] - len(ticks)) <= 2
    assert statistics(pico)["lateness_max"] < 1500, "ns; interrupt latency and the way to the cycle"
    assert 10_000 < statistics(pico)["computation_min"] < 400_000


def statistics(pico: Emulator) -> dict[str, int]:
    """The first members of epg_statistics_t, as the user's code copies them to `status`."""
    raw = pico.read("status", 16 + 9 * 4)
    names = ("cycles", "overruns", "missed", "lateness_max", "computation_min", "computation_max")
    values = struct.unpack_from("<6IQI", raw, 16)
    return {**dict(zip(names, values)), "outputs_late": values[-1]}
