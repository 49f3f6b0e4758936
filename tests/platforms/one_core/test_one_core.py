# SPDX-License-Identifier: Apache-2.0
"""Control in the tick's interrupt on QEMU's Cortex-M4F and M7, on bare metal and on FreeRTOS."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cmake.project import ROOT
from tests.doubles.toolchain import skip_if_missing, tool
from tests.platforms.firmware.builds import PROCESSORS

from .board import HERE, OneCore, image

RUNNING, PRIORITY = 1, 8
"""Errors of ``epg/mcu.h``."""
FAULT_PROCESSOR, FAULT_PRIORITY = 12, 15
"""Of ``epg/fault.h``."""
FREE, PRIGROUP = 28, -16
"""Interrupts; the other number stands for the setting of all interrupts."""
LATENESS_NS = 4000
"""QEMU takes 16 ns for each instruction: the tick's interrupt begins within 250 instructions."""


def test_each_tick_has_its_cycle(board: OneCore) -> None:
    """While the console answers, the motors run, and the program's own interrupts and sums go on."""
    begin = board.order("?")
    assert board.console.ask("enable")[-1] == "ok enable"
    assert board.console.ask(r"set Pan\PID\kp=2.5")[-1] == "ok set"
    assert board.console.ask("watch")[-1] == "ok watch"
    assert board.let_pass(50).driven == 2, "homing"
    state = board.let_pass(2000)
    assert abs((state.time_us - begin.time_us) / 1000 - (state.cycles - begin.cycles)) <= 2
    assert (state.missed, state.overruns, state.fault, state.enabled) == (0, 0, 0, 1)
    assert state.lateness_max < LATENESS_NS
    assert state.turns - begin.turns >= 0.95 * (state.cycles - begin.cycles)
    assert state.sums > 1000 and state.wrong_sums == 0, "interrupts keep the FPU's registers"
    assert abs(state.timer1_calls - state.time_us / 2500) <= 2, "the program's handler"
    assert abs(state.systick_calls - state.time_us / 1000) <= 5, "the program's handler"


@pytest.mark.parametrize("order", ["b", "i"], ids=["masked_by_basepri", "interrupt_of_priority_1"])
def test_nothing_delays_the_tick(board: OneCore, order: str) -> None:
    """Four cycles run within the 4 ms in which the communication side cannot."""
    board.console.ask("enable")
    board.let_pass(50)
    board.order(order)
    state = board.let_pass(20)
    assert state.within >= 4
    assert (state.missed, state.overruns, state.fault) == (0, 0, 0)
    assert state.lateness_max < LATENESS_NS


def test_floods_on_both_lines_do_not_delay_the_tick(board: OneCore) -> None:
    board.console.ask("enable")
    begin = board.let_pass(50)
    for _ in range(20):
        board.console.send("version\n" * 100)
        board.agent.sendall(bytes(range(256)) * 4)
        state = board.let_pass(20)
    assert state.turns - begin.turns > 400, "each byte wakes the communication side"
    assert abs((state.time_us - begin.time_us) / 1000 - (state.cycles - begin.cycles)) <= 2
    assert (state.missed, state.overruns, state.fault, state.wrong_sums) == (0, 0, 0, 0)
    assert state.lateness_max < LATENESS_NS


def test_bytes_that_come_while_it_starts(program: tuple[str, str]) -> None:
    for _ in range(5):
        with OneCore(*program) as board:
            board.agent.sendall(bytes(4096))
            board.console.send("version\n" * 100)
            state = board.let_pass(50)
            assert (state.missed, state.fault) == (0, 0)
            assert board.console.ask("enable")[-1] == "ok enable"


def test_ticks_that_were_missed_are_counted(board: OneCore) -> None:
    """The program masks all interrupts for 3.5 ms, then its cycles are longer than the period."""
    board.let_pass(20)
    begin = board.order("?")
    board.order("p")
    state = board.let_pass(20)
    assert 2 <= state.missed <= 4 and state.fault == 0
    ticks = state.cycles + state.missed - begin.cycles - begin.missed
    assert abs((state.time_us - begin.time_us) / 1000 - ticks) <= 2
    board.console.ask("enable")
    begin = board.order("o")
    state = board.let_pass(50)
    assert 5 <= state.overruns - begin.overruns <= 6 and state.fault == 0
    assert 2 <= state.missed - begin.missed <= 6
    ticks = state.cycles + state.missed - begin.cycles - begin.missed
    assert abs((state.time_us - begin.time_us) / 1000 - ticks) <= 2


def test_all_other_vectors_stay_the_programs(board: OneCore) -> None:
    assert board.order("v").result == 1
    board.order("s")
    assert board.order("v").result == 1
    board.order("r")
    assert board.order("v").result == 1


def test_an_interrupt_of_the_ticks_priority_is_a_fault(board: OneCore) -> None:
    board.console.ask("enable")
    assert board.let_pass(50).driven == 2
    board.order("e")
    state = board.let_pass(1100)
    assert (state.fault, state.enabled, state.driven, state.priority - 16) == (FAULT_PRIORITY, 0, 0, FREE)
    assert any("fault=priority" in line for line in board.console.ask("stats"))
    board.order("d")
    board.console.ask("enable")
    state = board.let_pass(1100)
    assert (state.fault, state.enabled) == (0, 1)


def test_an_interrupt_of_the_ticks_priority_refuses_the_start(board: OneCore) -> None:
    assert board.order("s").result == 1
    for order, name, back in (("e", FREE, "d"), ("g", PRIGROUP, "G")):
        board.order(order)
        refused = board.order("r")
        assert (refused.result, refused.error, refused.priority - 16) == (0, PRIORITY, name)
        board.order(back)
    started = board.order("r")
    assert (started.result, started.error, started.priority) == (1, 0, 16)


def test_it_stops_and_starts_again(board: OneCore) -> None:
    board.console.ask("enable")
    assert board.let_pass(50).driven == 2
    stopped = board.order("s")
    assert (stopped.result, stopped.driven) == (1, 0)
    after = board.let_pass(300)
    assert (after.cycles, after.turns) == (stopped.cycles, stopped.turns)
    assert after.timer1_calls > stopped.timer1_calls + 100, "the program runs, and the watchdog does not reset it"
    assert board.order("r").result == 1
    again = board.order("r")
    assert (again.result, again.error) == (0, RUNNING)
    state = board.let_pass(100)
    assert 90 < state.cycles < stopped.cycles + 110
    assert (state.missed, state.fault, state.enabled, state.driven) == (0, 0, 0, 0)


def test_a_fault_handler_that_returns_does_not_let_control_go_on(board: OneCore) -> None:
    """The handler finds the exception as it was, and returns into the cycle, which then switches the motors on."""
    board.console.until("ready ")
    board.order("f")
    board.console.send("enable\n")
    board.console.until("ready ")
    state = board.let_pass(50)
    assert (state.faults, state.driven_in_fault) == (1, 0)
    assert (state.fault, state.enabled, state.driven) == (FAULT_PROCESSOR, 0, 0)


@pytest.mark.parametrize("processor", ["mps2_an386", "mps2_an500"])
def test_a_fault_of_the_main_stack_resets_at_once(processor: str) -> None:
    """The program's handler would need that stack."""
    with OneCore(processor, "bare_metal") as board:
        board.console.ask("enable")
        board.let_pass(50)
        board.give("m")
        board.console.until("ready ")
        state = board.let_pass(50)
        assert (state.faults, state.fault, state.driven) == (0, FAULT_PROCESSOR, 0)


def test_a_long_write_to_the_store_is_not_a_silence(board: OneCore) -> None:
    """It takes longer than the time after which the watchdog would reset the board; cycles go on."""
    board.console.ask(r"set Pan\PID\kp=2.5")
    begin = board.order("?")
    assert board.console.ask("save")[-1] == "ok save values=1"
    state = board.let_pass(50)
    assert state.time_us - begin.time_us > 800_000
    assert abs((state.time_us - begin.time_us) / 1000 - (state.cycles - begin.cycles)) <= 2
    assert (state.missed, state.fault) == (0, 0)
    board.give("h")
    board.console.until("ready ")
    assert board.console.ask(r"get Pan\PID\kp")[0] == r"parameter Pan\PID\kp=2.5 generated=2.6"


def test_communication_does_not_wait_for_a_slow_tick() -> None:
    """The period is 2.5 ms.  The program's SysTick, or EPG's own if the program has none, wakes the communication."""
    with OneCore("mps2_an386", "bare_metal", "slow") as board:
        begin = board.order("?")
        state = board.let_pass(500)
        assert state.turns - begin.turns >= (state.time_us - begin.time_us) / 1000 - 2
        assert abs(state.systick_calls - state.time_us / 1000) <= 5, "the program's handler"
        board.order("s")
        board.order("n")
        board.order("r")
        begin = board.order("?")
        state = board.let_pass(500)
        assert state.turns - begin.turns >= (state.time_us - begin.time_us) / 1000 - 2
        assert state.systick_calls == begin.systick_calls
        assert (state.missed, state.fault) == (0, 0)


def test_a_project_can_add_the_kernel_itself() -> None:
    skip_if_missing(kernel)
    settings = {"KERNEL": str(kernel()), "FREERTOS_PORT": "GCC_ARM_CM7"}
    built = image("mps2_an500", "freertos", **settings).parent
    assert (built / "kernel" / "libfreertos_kernel.a").is_file() and not (
        built / "libFreeRTOS-Kernel-Static.a"
    ).exists()
    with OneCore("mps2_an500", "freertos", **settings) as board:
        board.console.ask("enable")
        state = board.let_pass(100)
        assert (state.missed, state.fault, state.enabled) == (0, 0, 1)


WRONG = """#include "{config}"
#undef configSUPPORT_STATIC_ALLOCATION
#define configSUPPORT_STATIC_ALLOCATION 0
#undef configSUPPORT_DYNAMIC_ALLOCATION
#define configSUPPORT_DYNAMIC_ALLOCATION 1
#undef INCLUDE_uxTaskGetStackHighWaterMark
#undef configTICK_RATE_HZ
#define configTICK_RATE_HZ ((TickType_t)100)
"""
LINES = [
    "#define configSUPPORT_STATIC_ALLOCATION 1",
    "#define INCLUDE_uxTaskGetStackHighWaterMark 1",
    "#define configTICK_RATE_HZ 1000",
]


@pytest.mark.parametrize("known", [True, False], ids=["while it configures", "by the compiler"])
def test_all_wrong_settings_of_the_kernel_are_one_message(known: bool, tmp_path: Path) -> None:
    """CMake does not know a folder that only a build can evaluate: then the compiler reports the settings."""
    skip_if_missing(kernel, lambda: PROCESSORS["m7"].tool("gcc"))
    config = ROOT / "targets/platforms/freertos/config/FreeRTOSConfig.h"
    (tmp_path / "FreeRTOSConfig.h").write_text(WRONG.format(config=config))
    settings = {
        "CMAKE_TOOLCHAIN_FILE": HERE.parent / "firmware/toolchains/arm.cmake",
        "PROCESSOR": " ".join(PROCESSORS["m7"].options),
        "BOARD": "mps2_an500",
        "PLATFORM": "freertos",
        "CONTROLLER": "jiwy",
        "KERNEL": kernel(),
        "FREERTOS_PORT": "GCC_ARM_CM7",
        "FREERTOS_CONFIG": tmp_path if known else f"$<1:{tmp_path}>",
        "Python3_EXECUTABLE": sys.executable,
    }
    build = tmp_path / "build"
    command = ["cmake", "-S", str(HERE / "program"), "-B", str(build), *(f"-D{n}={v}" for n, v in settings.items())]
    done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "CMAKE_GENERATOR": "Ninja"})
    assert (done.returncode != 0) == known, done.stderr
    if known:
        shown = [line.strip() for line in done.stderr.splitlines() if "#define" in line]
        assert f"Write in {tmp_path}/FreeRTOSConfig.h:" in " ".join(done.stderr.split())
        assert [line.split(" /*")[0] for line in shown] == LINES
    else:
        done = subprocess.run(["ninja", "-C", build], capture_output=True, text=True)
        failed, *_ = (text for text in done.stdout.split("FAILED: ")[1:] if "needs in FreeRTOSConfig.h" in text)
        assert all(line in failed for line in LINES), done.stdout


def kernel() -> Path:
    return tool("freertos_kernel")
