# SPDX-License-Identifier: Apache-2.0
"""Zephyr's image of JIWY on a Pico is a ROS 2 node that follows setpoints, and its control cycles are on time."""

from __future__ import annotations

import struct
from collections.abc import Iterator

import pytest

from tests.doubles.rp2040.emulator import CYCLES_PER_MILLISECOND
from tests.doubles.xrce_agent.messages import read_diagnostics
from tests.platforms.pico.closed_loop.robot import AXES
from tests.platforms.pico.xrce.board import CONSOLE_PORT
from tests.platforms.pico.xrce.checks import assert_it_tracks
from tests.platforms.pico.xrce.scenarios import SCENARIOS, assert_holds, hold

from .board import ZephyrJiwy, skip_unless_emulated
from .checks import assert_undisturbed

"""Seconds between two messages of a topic, as in jiwy.tcf."""
RESTARTS = 5
LATEST = 150
"""Milliseconds from the start of an agent to the board's first message, at most."""
SAFE = 100 * CYCLES_PER_MILLISECOND // 1000
"""Cycles after a fault until no output is driven: 100 us."""
NOWHERE = 0x60000001
"""An address without code."""


@pytest.fixture(scope="module")
def jiwy() -> Iterator[ZephyrJiwy]:
    skip_unless_emulated()
    with ZephyrJiwy() as made:
        made.home()
        yield made


def test_it_tracks(jiwy: ZephyrJiwy) -> None:
    """Follows a sine of 0.4 rad in 2 s, with a setpoint every 10 ms; both axes publish together, every 33 ms."""
    jiwy.begin()
    assert_it_tracks(jiwy, 1.2)
    stats = assert_undisturbed(jiwy)
    assert (stats["unsent"], stats["malformed"]) == ("0", "0")
    said = read_diagnostics(jiwy.agent.heard("rt/diagnostics")[-1].data)
    assert (said.name, said.values["fault"], said.values["overruns"]) == ("JIWY_node", "none", "0")


def test_agents_are_restarted(jiwy: ZephyrJiwy) -> None:
    hold(jiwy)
    times = []
    for number in range(RESTARTS):
        jiwy.agent.kill()
        jiwy.agent.run(11 * number)
        jiwy.agent.start()
        begin = jiwy.agent.now()
        times.append(1000 * (jiwy.agent.wait_for("rt/pan_publisher").time - begin))
        jiwy.agent.run(7 * number)
    assert max(times) < LATEST
    assert jiwy.reconnects() == RESTARTS
    assert_is_back(jiwy)


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_it_comes_back(jiwy: ZephyrJiwy, scenario: str) -> None:
    hold(jiwy)
    SCENARIOS[scenario](jiwy)
    assert_is_back(jiwy)


def assert_is_back(jiwy: ZephyrJiwy) -> None:
    """The loop was undisturbed; setpoints arrive, and published positions are those of the axes."""
    assert_holds(jiwy)
    assert_undisturbed(jiwy)
    hold(jiwy, 0.3)
    for axis in AXES:
        assert jiwy.position(axis.name) == pytest.approx(0.3, abs=3 * axis.rad_per_count)


def test_a_hard_fault_of_main(jiwy: ZephyrJiwy) -> None:
    """Overwrites its return addresses while both axes move: outputs become safe at once, and stay safe.

    This must be the last test of this board, because the watchdog then resets it.
    """
    pins = [pin for axis in AXES for pin in axis.outputs]
    hold(jiwy)
    jiwy.point(1.2, 1.2)
    jiwy.agent.run(60)
    jiwy.pico.call("watch_pins", pins=pins)
    stack = jiwy.pico.read("z_main_stack")
    returns = [n for n, (word,) in enumerate(struct.iter_unpack("<I", stack)) if word >> 20 == 0x100 and word & 1]
    assert len(returns) > 1
    for number in returns:
        jiwy.pico.write_word("z_main_stack", NOWHERE, offset=4 * number)
    for number in range(110):  # main() sleeps for a second
        jiwy.point(*(2 * [1.2 if number % 20 < 10 else 0.2]))
        jiwy.agent.run(10)
        if jiwy.faults():
            break
    (fault, *_) = jiwy.faults()
    jiwy.agent.run(800)
    high = [cycle - fault["cycle"] for cycle, _, level, _ in jiwy.pico.call("take", log="pins") if level]
    assert min(high) < -100 * SAFE, "the motors were driven"
    assert max(high) < SAFE
    assert all(jiwy.pico.call("pin", pin=pin)["level"] == 0 for pin in pins)
    assert [reset["cause"] for reset in jiwy.pico.run(cycles=1)["resets"]] == ["watchdog"]
    jiwy.pico.call("usb_open", port=CONSOLE_PORT)
    jiwy.agent.run(300)
    stats = jiwy.stats()
    assert (stats["enabled"], stats["fault"]) == ("0", "processor")
