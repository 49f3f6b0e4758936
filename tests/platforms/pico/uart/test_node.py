# SPDX-License-Identifier: Apache-2.0
"""A ROS 2 node whose agent is on a serial line and whose console is on USB, in the emulator."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.doubles.rp2040.build import build
from tests.doubles.rp2040.emulator import Emulator
from tests.doubles.xrce_agent.messages import float64, read_float64
from tests.platforms.pico.closed_loop.robot import AXES, angle, connect
from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated
from tests.platforms.pico.xrce.agent import BoardAgent, UartLink

BAUD = 460800
HOMED = 900
"""Milliseconds after which both axes have homed from 0.12 rad."""


@pytest.mark.parametrize("platform", PLATFORMS)
def test_jiwy_on_a_serial_line(platform: str) -> None:
    skip_unless_emulated(platform)
    check_serial_line(node_image(platform))


def node_image(platform: str, **variables: str) -> Path:
    settings = {"PLATFORM": platform, **variables}
    return (
        build("tests/platforms/pico/uart/project", targets=["node_firmware"], variables=settings) / "node_firmware.elf"
    )


def check_serial_line(elf: Path) -> None:
    """JIWY holds a position that arrived over the line, and connects again to an agent that was away."""
    with Emulator(elf, usb={"seed": 3}) as pico:
        connect(pico, {"pan": 0.12, "tilt": 0.12})
        pico.run(milliseconds=50)
        with BoardAgent(pico, UartLink(pico, uart=0, baud=BAUD)) as agent:
            agent.wait_for("rt/pan_publisher")
            agent.run(HOMED)
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
