# SPDX-License-Identifier: Apache-2.0
"""JIWY's firmware with micro-ROS under faults of agent and cable; its stack; its build for a Pico 2."""

from __future__ import annotations

import random

import pytest

from integration.micro_ros.tests.pico.firmware import MicroRosJiwy, firmware, library
from tests.doubles.toolchain import binutils
from tests.platforms.pico.images import skip_unless_emulated
from tests.platforms.pico.stacks.workload import COMMANDS
from tests.platforms.pico.test_faults import START, STOP, order
from tests.platforms.pico.uart.test_node import check_serial_line, node_image
from tests.platforms.pico.xrce.board import CONSOLE_PORT
from tests.platforms.pico.xrce.scenarios import SCENARIOS, assert_is_back, hold, restart

SILENCE = 1000  # milliseconds after which micro_ros gives a silent agent up


def test_all_that_happens_to_xrce() -> None:
    with MicroRosJiwy() as jiwy:
        jiwy.home()
        for scenario in SCENARIOS.values():
            hold(jiwy)
            scenario(jiwy)
            assert_is_back(jiwy)


def test_restarts() -> None:
    with MicroRosJiwy() as jiwy:
        jiwy.home()
        hold(jiwy)
        most = jiwy.pico.word("arena", offset=8)
        restart(jiwy, times=50)
        assert jiwy.pico.word("arena", offset=8) == most
        assert_is_back(jiwy)


def test_a_serial_line() -> None:
    skip_unless_emulated("freertos")
    check_serial_line(node_image("freertos", MIDDLEWARE="micro_ros", MICRO_ROS_PATH=library()))


def test_it_is_stopped_and_started_wherever_it_waits() -> None:
    """A user's task stops it, which deletes EPG's task: each time, libmicroros has all its memory again."""
    with MicroRosJiwy(executable="user_jiwy") as jiwy:
        for milliseconds in (1, 4, 7, 9, 11, 13, 15, 17, 19, 22, 60):
            jiwy.agent.kill()
            jiwy.agent.run(3)
            jiwy.agent.start()
            jiwy.agent.run(milliseconds)
            order(jiwy.pico, STOP, milliseconds=5)
            order(jiwy.pico, START, milliseconds=5)
            jiwy.agent.wait_for("rt/pan_publisher", milliseconds=1500)
        assert jiwy.faults() == []


@pytest.mark.parametrize("seed", [3, 4])
def test_a_quarter_is_left_of_the_stack(seed: int) -> None:
    """The console does everything it can while the board makes the node, loses its agent and searches for it."""
    draw = random.Random(seed)
    with MicroRosJiwy(seed) as jiwy:
        jiwy.agent.run(300)
        text = "".join(f"{draw.choice(COMMANDS)}\n" for _ in range(400))
        jiwy.pico.call("usb_flood", text=text, port=CONSOLE_PORT)
        jiwy.agent.run(300)
        for _ in range(4):
            jiwy.agent.restart()
            jiwy.agent.run(150)
        jiwy.agent.freeze()
        jiwy.agent.run(SILENCE + 500)
        jiwy.agent.thaw()
        jiwy.agent.run(400)
        jiwy.pico.call("usb_flood", on=False, port=CONSOLE_PORT)
        jiwy.agent.run(500)
        jiwy.pico.send("\nwatch off\n", port=CONSOLE_PORT)
        jiwy.agent.run(300)
        stats = jiwy.stats()
        used, size = int(stats["communication_stack_used"]), int(stats["communication_stack_size"])
        assert used > 3500, "the work is as hard as it was when the size was chosen"
        assert used * 5 <= size * 4
        assert (stats["missed"], stats["overruns"]) == ("0", "0")


def test_a_pico_2_can_have_the_same_library() -> None:
    """The image is linked, but does not run."""
    assert " clock_gettime" in binutils("nm", str(firmware("pico2")))
