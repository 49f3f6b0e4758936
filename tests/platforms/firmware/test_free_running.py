# SPDX-License-Identifier: Apache-2.0
"""JIWY on boards in QEMU at the ticks of a timer: its console, and mistakes of the program around it."""

from __future__ import annotations

from .free_running import FreeRunning

FAULT_OVERRUN, FAULT_TICK = 3, 14
"""Of ``epg/fault.h``."""


def test_the_cycle_has_the_time_of_the_timer(board: FreeRunning) -> None:
    """While the console answers and a parameter changes, each tick has its cycle, and no cycle is late."""
    begin = board.order("?")
    assert board.console.ask("enable")[-1] == "ok enable"
    assert board.console.ask(r"set Pan\PID\kp=2.5")[-1] == "ok set"
    assert board.console.ask(r"get Pan\PID\kp") == [r"parameter Pan\PID\kp=2.5 generated=2.6", "ok get"]
    assert board.console.ask("watch")[-1] == "ok watch"
    state = board.let_pass(500)
    assert abs((state.time_us - begin.time_us) / 1000 - (state.cycles - begin.cycles)) <= 1
    assert (state.missed, state.overruns, state.fault, state.alive) == (0, 0, 0, 1)
    assert state.lateness_max < 20_000
    stats = board.console.ask("stats")
    assert any(line.startswith("stat enabled=1 fault=none") for line in stats), stats
    assert "stat missed=0" in stats and "stat overruns=0" in stats


def test_a_timer_with_twice_the_period_is_a_fault(board: FreeRunning) -> None:
    board.console.ask("enable")
    board.let_pass(50)
    board.order("d")
    state = board.let_pass(600)
    assert (state.fault, state.unsafe) == (FAULT_TICK, 0), state
    assert any("fault=tick" in line for line in board.console.ask("stats"))
    board.order("c")
    board.let_pass(300)
    board.console.ask("enable")
    state = board.let_pass(300)
    assert state.fault == 0


def test_cycles_that_are_too_long_are_a_fault(board: FreeRunning) -> None:
    board.console.ask("enable")
    before = board.let_pass(20)
    board.order("o")
    state = board.let_pass(100)
    assert (state.fault, state.unsafe) == (FAULT_OVERRUN, 0)
    assert state.overruns - before.overruns >= 10
    assert state.missed > 0
    board.console.ask("enable")
    assert board.let_pass(50).fault == 0


def test_it_stops_and_starts_again(board: FreeRunning) -> None:
    board.console.ask("enable")
    assert board.let_pass(50).unsafe > 0, "homing drives the motors"
    stopped = board.order("s")
    assert (stopped.result, stopped.unsafe) == (1, 0)
    assert board.let_pass(50).cycles == stopped.cycles
    assert board.order("r").result == 1
    assert board.order("r").result == 0, "it runs already"
    started = board.let_pass(100)
    assert 0 < started.cycles < stopped.cycles + 100
    assert (started.missed, started.fault, started.unsafe) == (0, 0, 0), "it is disabled at first"
    board.console.ask("enable")
    assert board.let_pass(50).unsafe > 0


def test_a_program_that_stops_to_communicate_is_not_alive(board: FreeRunning) -> None:
    assert board.let_pass(50).alive == 1
    assert board.order("k").result == 0
    state = board.let_pass(10)
    assert (state.alive, state.missed, state.fault) == (1, 0, 0), "control has not noticed it"


def test_safe_in_a_fault_handler(board: FreeRunning) -> None:
    board.console.ask("enable")
    assert board.let_pass(50).unsafe > 0
    assert board.order("h").unsafe == 0
