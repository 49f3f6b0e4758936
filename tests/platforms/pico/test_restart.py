# SPDX-License-Identifier: Apache-2.0
"""A target stops and starts again while USB receives bytes all the time; RP2040 images in the emulator."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.doubles.rp2040.emulator import Emulator
from tests.platforms.pico.images import PLATFORMS, images, skip_unless_emulated

STOP, START, STOP_WITHIN = 7, 8, 9
NODE, CONSOLE = 0, 1
"""Numbers of the serial ports."""
ABOVE_COMMUNICATION = 3
TIMES = 100


@pytest.fixture(params=PLATFORMS)
def pico(request: pytest.FixtureRequest) -> Iterator[Emulator]:
    """JIWY in a user's program; one port is flooded with bytes that are not a message, the console is open."""
    skip_unless_emulated(request.param)
    image = images("pico", request.param, "user_jiwy", middleware="xrce_console") / "user_jiwy.elf"
    with Emulator(image, usb={"seed": 7}) as emulator:
        assert emulator.run(milliseconds=1000, configured=True)["usb"] == "configured"
        emulator.run(milliseconds=5)
        if request.param == "freertos":
            emulator.write_word("priority", ABOVE_COMMUNICATION)
        emulator.call("usb_flood", text="flood " * 10, port=NODE)
        yield emulator
        assert emulator.call("faults") == []
        assert emulator.run(cycles=1)["resets"] == []


def obeyed(pico: Emulator, order: int, milliseconds: float) -> bool:
    """The result of <name>_stop() or <name>_start(); the order is given after ``milliseconds``."""
    pico.write_word("answer", 1000)
    pico.run(milliseconds=milliseconds)
    pico.write_word("order", order)
    for _ in range(100):
        pico.run(milliseconds=0.5)
        answer = pico.word("answer")
        if answer != 1000:
            return bool(answer)
    raise AssertionError(f"order {order} was not obeyed: {pico.run(cycles=1)}, {pico.call('faults')}")


def assert_runs(pico: Emulator) -> None:
    """The control loop has cycles, and the console answers."""
    pico.receive(port=CONSOLE)
    pico.send("\nversion\n", port=CONSOLE)
    assert "ok version" in pico.run_until_text("ok version", milliseconds=100, port=CONSOLE)
    pico.run(milliseconds=5)
    cycles = pico.word("status", offset=16)
    pico.run(milliseconds=5)
    assert pico.word("status", offset=16) > cycles


def test_stopped_and_started_many_times(pico: Emulator) -> None:
    """Communication can be stopped at any point: it leaves nothing locked, and its next run is like the first."""
    for number in range(TIMES):
        assert obeyed(pico, STOP, number * 0.137 % 3), number
        assert obeyed(pico, START, number * 0.071 % 2), number
        if number % 10 == 0:
            assert_runs(pico)
    assert_runs(pico)


def test_a_second_stop_and_a_second_start(pico: Emulator) -> None:
    assert obeyed(pico, STOP, 0) and obeyed(pico, STOP, 1), "what is stopped needs no stop"
    assert obeyed(pico, START, 1)
    assert not obeyed(pico, START, 1), "it runs already"
    assert_runs(pico)


def test_communication_cannot_stop_itself(pico: Emulator) -> None:
    """A callback of TinyUSB runs within communication, which would have to wait for its own end."""
    assert not obeyed(pico, STOP_WITHIN, 0)
    assert_runs(pico)
    assert obeyed(pico, STOP, 1), "from elsewhere it can be stopped still"
    assert obeyed(pico, START, 1)
    assert_runs(pico)
