# SPDX-License-Identifier: Apache-2.0
"""JIWY's firmware with micro-ROS under faults of agent and cable; its stack; its build for a Pico 2."""

from __future__ import annotations

import random

import pytest

from integration.micro_ros.tests.pico.firmware import MicroRosJiwy, firmware, library
from tests.doubles.rp2040.build import build
from tests.doubles.rp2040.emulator import Emulator
from tests.doubles.toolchain import binutils
from tests.doubles.xrce_agent.messages import float64, read_float64
from tests.platforms.pico.closed_loop.robot import AXES, angle, connect
from tests.platforms.pico.images import skip_unless_emulated
from tests.platforms.pico.stacks.workload import COMMANDS
from tests.platforms.pico.test_faults import START, STOP, order
from tests.platforms.pico.xrce.agent import BoardAgent, UartLink
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
    """JIWY holds a position that arrived over the line, and connects again to an agent that was away."""
    skip_unless_emulated("freertos")
    settings = {"PLATFORM": "freertos", "MIDDLEWARE": "micro_ros", "MICRO_ROS_PATH": library()}
    folder = build("tests/platforms/pico/uart/project", targets=["node_firmware"], variables=settings)
    with Emulator(folder / "node_firmware.elf", usb={"seed": 3}) as pico:
        connect(pico, {"pan": 0.12, "tilt": 0.12})
        pico.run(milliseconds=50)
        with BoardAgent(pico, UartLink(pico, uart=0, baud=460800)) as agent:
            agent.wait_for("rt/pan_publisher")
            agent.run(900)  # both axes have homed from 0.12 rad
            for _ in range(2):
                agent.topics.publish("rt/pan_subscriber", float64(0.5), reliable=False)
                agent.run(500)
                assert angle(pico, "pan") == pytest.approx(0.5, abs=3 * AXES[0].rad_per_count)
                newest = read_float64(agent.heard("rt/pan_publisher")[-1].data)
                assert newest == pytest.approx(0.5, abs=3 * AXES[0].rad_per_count)
                agent.kill()  # a wire does not report this: the board must detect it itself
                agent.run(1500)
                agent.start()
                agent.wait_for("rt/pan_publisher", milliseconds=3000)
            pico.receive()
            pico.send("stats\n")
            agent.run(50)
            said = pico.receive()
            assert "stat reconnects=2\r\n" in said
            assert "stat overruns=0\r\n" in said
            assert "stat missed=0\r\n" in said
            assert len(pico.call("usb")["ports"]) == 1, "the console has the only serial port on USB"
            assert agent.serial.broken == 0
        assert pico.call("faults") == []


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
