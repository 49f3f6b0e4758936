# SPDX-License-Identifier: Apache-2.0
"""Zephyr's port layer in the RP2040 emulator, with a target of one motor (`port`): ticks, safe outputs, resets, bytes.

The motor's PWM is at GP2 and its direction at GP3; bytes that arrive over USB and over the UART are echoed.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from tests.doubles.rp2040.emulator import Emulator
from tests.doubles.toolchain import arm_gcc, node, rp2040js, skip_if_missing

from .workspace import build, c_library, workspace

STOP, START, PANIC, HANG, LOCK_INTERRUPTS, DISABLE_SPARE_IRQ, SUSPEND, RESUME = range(1, 9)
NO_FAULT, WATCHDOG, PROCESSOR = 0, 11, 12
"""Values of epg/fault.h."""
WRONG_TICK = 3
"""The value of EPG_ZEPHYR_ERROR_TICK."""
TICK_CLOCK = 8
"""The offset of `tick.clock` in epg_zephyr_target_t."""
MOTOR, FORWARD = 2, 3
"""Numbers of pins."""
MOTOR_SLICE = 1


class Board:
    """The image, and its program's report about the target."""

    def __init__(self, image: Path) -> None:
        self.pico = Emulator(image)

    def ask(self, request: int, milliseconds: float = 20) -> None:
        self.pico.write_word("request", request)
        self.pico.run(milliseconds=milliseconds)

    def status(self) -> dict[str, int]:
        """Members of the control object (epg/status.h, epg/statistics.h), which follow a pointer."""
        words = [self.pico.word("control", offset=8 + 4 * n) for n in range(10)]
        names = ["cycles", "overruns", "missed", "lateness_max", "computation_min", "computation_max"]
        return {"enabled": words[0] & 0xFF, "fault": words[1] & 0xFF, **dict(zip(names, words[4:], strict=True))}

    def forward(self) -> bool:
        return bool(self.pico.call("pin", pin=FORWARD)["level"])


@pytest.fixture(scope="module")
def image() -> Path:
    skip_if_missing(partial(workspace, "rpi_pico"), arm_gcc, node, rp2040js, c_library)
    return build("tests/zephyr/port", "rpi_pico", settings=c_library()) / "zephyr" / "zephyr.elf"


@pytest.fixture
def board(image: Path) -> Iterator[Board]:
    made = Board(image)
    made.pico.run(milliseconds=100)
    yield made
    faults = made.pico.call("faults")
    made.pico.close()
    assert faults == []


def test_every_tick_runs_a_cycle_while_usb_is_flooded(board: Board) -> None:
    """The threads of the USB stack are cooperative, but the control thread has priority over them."""
    board.pico.call("usb_open")
    board.pico.call("usb_flood")
    before = board.status()["cycles"]
    board.pico.run(milliseconds=300)
    after = board.status()
    assert 297 <= after["cycles"] - before <= 303
    assert (after["missed"], after["overruns"], after["fault"]) == (0, 0, NO_FAULT)
    assert after["lateness_max"] < 40_000, "nanoseconds"
    assert len(board.pico.receive()) > 20_000


def test_ticks_that_come_while_interrupts_are_locked_are_missed(board: Board) -> None:
    """For 3.5 ms: of four ticks, only the last one has a cycle, which is late."""
    board.ask(LOCK_INTERRUPTS)
    status = board.status()
    assert status["missed"] in (2, 3)
    assert status["overruns"] == 1
    assert (status["enabled"], status["fault"]) == (1, NO_FAULT)


def test_an_interrupt_that_a_cycle_disables_stays_disabled(board: Board) -> None:
    board.ask(DISABLE_SPARE_IRQ)
    assert board.pico.word("spare_enabled") == 0


def test_interrupts_go_on_while_the_control_thread_does_not_run(board: Board) -> None:
    """This lasts less than the watchdog's time."""
    sent = random.Random(3).randbytes(200)
    board.ask(SUSPEND, milliseconds=5)
    stopped = board.status()["cycles"]
    board.pico.call("uart_send", uart=1, hex=sent.hex(), baud=115200)
    board.pico.run(milliseconds=45)
    assert board.status()["cycles"] == stopped
    assert bytes.fromhex(board.pico.call("uart_receive", uart=1)) == sent
    board.ask(RESUME)
    status = board.status()
    assert status["cycles"] > stopped + 10
    assert status["missed"] > 40
    assert (status["enabled"], status["fault"]) == (1, NO_FAULT)


def test_the_motor_runs_until_the_target_is_stopped_and_again(board: Board) -> None:
    assert board.forward()
    assert board.pico.call("pwm", slice=MOTOR_SLICE)["top"] == 6249
    board.ask(STOP)
    assert not board.forward()
    stopped = board.status()["cycles"]
    board.pico.run(milliseconds=50)
    assert board.status()["cycles"] == stopped
    board.ask(START, milliseconds=50)
    assert (board.pico.word("started"), board.pico.word("error")) == (1, 0)
    assert board.forward()
    assert 30 < board.status()["cycles"] < 60, "counted anew"
    assert board.status()["missed"] == 0


def test_a_target_for_another_clock_is_refused(board: Board) -> None:
    board.ask(STOP)
    clock = board.pico.word("zephyr", offset=TICK_CLOCK)
    assert clock == 125_000_000
    board.pico.write_word("zephyr", 133_000_000, offset=TICK_CLOCK)
    board.ask(START)
    assert (board.pico.word("started"), board.pico.word("error")) == (0, WRONG_TICK)
    assert not board.forward()
    board.pico.write_word("zephyr", clock, offset=TICK_CLOCK)
    board.ask(START)
    assert (board.pico.word("started"), board.pico.word("error")) == (1, 0)


def test_a_target_that_runs_does_not_start_again(board: Board) -> None:
    board.ask(START)
    assert (board.pico.word("started"), board.pico.word("error")) == (0, 1)
    assert board.forward()


def test_encoder(board: Board) -> None:
    board.pico.call("encoder", name="motor", a=10, b=11)
    start = board.pico.cycle + 200
    board.pico.call("move", name="motor", kind="schedule", edges=[[start + 100 * k, 1] for k in range(500)])
    board.pico.run(milliseconds=5)
    assert board.pico.word("count") == 500


@pytest.mark.parametrize(("request_", "fault"), [(PANIC, PROCESSOR), (HANG, WATCHDOG)])
def test_outputs_are_safe_and_the_board_starts_again_with_the_fault(board: Board, request_: int, fault: int) -> None:
    """The watchdog resets at once after a panic, else after half a second without communication."""
    board.pico.call("watch_pins", pins=[MOTOR])
    board.pico.run(milliseconds=5)
    assert len(board.pico.call("take", log="pins")) >= 198, "the motor's PWM"
    board.ask(request_, milliseconds=30)
    if request_ == PANIC:
        board.pico.call("take", log="pins")
        board.pico.run(milliseconds=5)
        assert board.pico.call("take", log="pins") == [], "made safe by the handler, long before the reset"
        assert not board.forward()
    state = board.pico.run(milliseconds=1000)
    assert [reset["cause"] for reset in state["resets"]] == ["watchdog"]
    status = board.status()
    assert status["cycles"] > 100, "it runs again"
    assert (status["enabled"], status["fault"]) == (0, fault)
    assert not board.forward()


def test_bytes_over_usb(board: Board) -> None:
    sent = random.Random(1).randbytes(5000)
    board.pico.call("usb_open")
    board.pico.run(milliseconds=5)
    board.pico.call("usb_send", hex=sent.hex())
    board.pico.run(milliseconds=150)
    assert board.pico.receive_bytes() == sent
    serial = board.pico.call("usb")
    assert serial["id"] == [0x2E8A, 0x000A]


def test_who_opens_the_port_gets_nothing_of_who_has_closed_it(board: Board) -> None:
    board.pico.call("usb_open")
    board.pico.run(milliseconds=5)
    board.pico.call("usb_open", open=False)
    board.pico.run(milliseconds=5)
    board.pico.send("for nobody")
    board.pico.run(milliseconds=5)
    board.pico.call("usb_open")
    board.pico.run(milliseconds=5)
    board.pico.receive()
    board.pico.send("again")
    board.pico.run(milliseconds=5)
    assert board.pico.receive() == "again"


def test_bytes_over_a_uart(board: Board) -> None:
    sent = random.Random(2).randbytes(1000)
    board.pico.call("uart_send", uart=1, hex=sent.hex(), baud=115200)
    board.pico.run(milliseconds=150)
    assert bytes.fromhex(board.pico.call("uart_receive", uart=1)) == sent
    board.pico.call("uart_send", uart=1, hex="55", damaged=True)
    board.pico.run(milliseconds=5)
    assert board.status()["fault"] == NO_FAULT
