# SPDX-License-Identifier: Apache-2.0
"""The emulator's PWM, PIO, timers and pins, exact to the cycle."""

from __future__ import annotations

import itertools

import pytest

from .conftest import Board

PWM_WRAP = 16 + 4


def edges_of(board: Board, pin: int) -> list[tuple[int, int]]:
    return [(cycle, level) for cycle, p, level, _ in board.pico.call("take", log="pins") if p == pin]


@pytest.mark.parametrize("divider", [16, 40, 23], ids=["1", "2.5", "1.4375"])
@pytest.mark.parametrize(("top", "a", "b"), [(999, 300, 700), (6249, 1, 6249), (99, 0, 100)])
def test_pwm_levels(board: Board, top: int, a: int, b: int, divider: int) -> None:
    """Each period lasts (TOP + 1) x divider cycles.  The output is high for as many counts as the level."""
    board.pico.call("watch_pins", pins=[2, 3])
    board.case("case_pwm", top, a, b, divider, 0)
    board.pico.call("take", log="pins")
    board.pico.run(cycles=20 * (top + 1) * divider // 16)
    log = board.pico.call("take", log="pins")
    period = (top + 1) * divider / 16
    for pin, level in ((2, a), (3, b)):
        edges = [(cycle, high) for cycle, p, high, _ in log if p == pin]
        if level in (0, top + 1):
            assert edges == []
            continue
        rises = [cycle for cycle, high in edges if high]
        assert len(rises) >= 18
        assert all(abs(later - earlier - period) < 1 for earlier, later in itertools.pairwise(rises))
        assert abs((rises[-1] - rises[0]) / (len(rises) - 1) - period) < 0.1
        pairs = [(x, y) for x, y in itertools.pairwise(edges) if x[1] and not y[1]]
        assert all(abs(y[0] - x[0] - level * divider / 16) < 1 for x, y in pairs)


def test_phase_correct_and_inverted(board: Board) -> None:
    """The period is twice as long, with pulses around its ends; channel A is inverted."""
    board.pico.call("watch_pins", pins=[2, 3])
    board.case("case_pwm", 999, 300, 300, 16, 3)
    board.pico.call("take", log="pins")
    board.pico.run(cycles=10_000)
    log = board.pico.call("take", log="pins")
    a = [(cycle, level) for cycle, pin, level, _ in log if pin == 2]
    b = [(cycle, level) for cycle, pin, level, _ in log if pin == 3]
    assert [cycle for cycle, _ in a] == [cycle for cycle, _ in b]
    assert all(x != y for (_, x), (_, y) in zip(a, b, strict=True))
    falls = [cycle for cycle, level in b if not level]
    rises = [cycle for cycle, level in b if level and cycle > falls[0]]
    assert {later - earlier for earlier, later in itertools.pairwise(falls)} == {2000}
    assert {rise - fall for fall, rise in zip(falls, rises, strict=False)} == {1400}


def test_pwm_registers(board: Board) -> None:
    enabled, between, other, more, stopped, advanced = board.case("case_pwm_registers")[:6]
    assert enabled == 1 << 1 | 1 << 5
    assert 0 < other < between < 30  # the slices started together: this is the time between the reads
    assert more == 1 << 1 | 1 << 2 | 1 << 5
    assert stopped == 100
    assert 100 + 2 <= advanced < 120


@pytest.mark.parametrize(("tick", "period"), [(12_500, 6250), (12_500, 2500)])
def test_a_tick_and_what_it_writes(board: Board, tick: int, period: int) -> None:
    """Slices that start in the same cycle stay in phase: the level that a tick writes takes effect one period later."""
    board.pico.call("watch_exceptions", numbers=[PWM_WRAP])
    board.pico.call("watch_pwm", slices=[1])
    board.case("case_pwm_tick", tick, period)
    entries = [cycle for cycle, core, _, entered in board.pico.call("take", log="exceptions") if entered and core == 0]
    assert len(entries) == 50
    assert {later - earlier for earlier, later in itertools.pairwise(entries)} == {tick}
    taken = [entry[0] for entry in board.pico.call("take", log="pwm") if entry[2] > 0]
    assert len(taken) == 50  # the last level takes effect when the slices stop
    # The interrupt's entry is 15 cycles after the wrap: the latency of the hardware.
    assert {cycle - entry for cycle, entry in zip(taken[:49], entries, strict=False)} == {period - 15}


def test_wraps_are_reported_with_the_levels_in_effect(board: Board) -> None:
    board.pico.call("watch_pwm", slices=[1], wraps=True)
    board.case("case_pwm", 999, 300, 700, 16, 0)
    board.pico.call("take", log="pwm")
    board.pico.run(cycles=10_000)
    log = board.pico.call("take", log="pwm")
    assert len(log) == 10
    assert {tuple(entry[1:5]) for entry in log} == {(1, 300, 700, 999)}
    assert {later[0] - earlier[0] for earlier, later in itertools.pairwise(log)} == {1000}
    assert [entry[5] for entry in log] == list(range(log[0][5], log[0][5] + 10))


@pytest.mark.parametrize("divider", [256, 512, 640, 1000])
def test_a_pio_wave_with_delays_and_divider(board: Board, divider: int) -> None:
    board.pico.call("watch_pins", pins=[6])
    board.case("case_pio_wave", divider, 20)
    edges = edges_of(board, 6)
    rises = [cycle for cycle, level in edges if level][1:]
    assert len(rises) > 60
    assert abs((rises[-1] - rises[0]) / (len(rises) - 1) - 8 * divider / 256) < 0.1
    falls = [cycle for cycle, level in edges if not level and cycle > rises[0]]
    assert all(abs(fall - rise - 3 * divider / 256) < 1 for rise, fall in zip(rises, falls, strict=False))


def test_pio_shifts_between_state_machines(board: Board) -> None:
    assert board.case("case_pio_shift")[0] == 0


def test_pio_flags_interrupt_a_processor(board: Board) -> None:
    interrupts = board.case("case_pio_flags")[1]
    assert 100 < interrupts < 12_500 // 32


def test_pio_sees_a_pin_after_two_cycles(board: Board) -> None:
    """The synchroniser takes 2 cycles; in the emulator, the MOV that reads the new level sets its pin in that cycle."""
    board.case("case_pio_latency")
    board.pico.call("watch_pins", pins=[6, 9])
    for level in (1, 0, 1):
        board.pico.call("drive", pin=9, level=level)
        board.pico.run(cycles=100)
    log = board.pico.call("take", log="pins")
    driven = [cycle for cycle, pin, _, _ in log if pin == 9]
    shown = [cycle for cycle, pin, _, _ in log if pin == 6]
    assert [b - a for a, b in zip(driven, shown, strict=True)] == [2, 2, 2]


@pytest.mark.parametrize("wait", [20, 100, 1001])
def test_an_alarm_comes_in_its_microsecond(board: Board, wait: int) -> None:
    seen, due, number = board.case("case_alarm", wait)[:3]
    assert seen - due in (0, 1)  # the handler reads the clock a few cycles later
    assert number == 2


def test_systick_has_a_period_of_rvr_plus_1(board: Board) -> None:
    board.pico.call("watch_exceptions", numbers=[15])
    results = board.case("case_systick", 1250, 205)
    assert results[0] in (20, 21)
    entries = [cycle for cycle, _, _, entered in board.pico.call("take", log="exceptions") if entered]
    assert {later - earlier for earlier, later in itertools.pairwise(entries)} <= set(range(1245, 1256))
    assert abs((entries[-1] - entries[0]) / (len(entries) - 1) - 1250) < 1
    assert 0 < results[1] < 20


def test_pins(board: Board) -> None:
    """A pin has the level of the chip's output, else of the outside, else of its pull resistor."""
    assert board.case("case_pins", 14, 0, 0, 1)[0] == 1  # pull-up
    assert board.case("case_pins", 14, 0, 0, 2)[0] == 0  # pull-down
    board.pico.call("drive", pin=14, level=1)
    assert board.case("case_pins", 14, 0, 0, 2)[0] == 1
    board.pico.call("drive", pin=14, level=None)
    assert board.case("case_pins", 14, 1, 1, 2)[0] == 1
    state = board.pico.call("pin", pin=14)
    assert (state["level"], state["output"], state["function"]) == (1, True, 5)
