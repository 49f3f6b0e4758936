# SPDX-License-Identifier: Apache-2.0
"""JIWY's firmware moves JIWY: two simulated motors on the pins, commands over the USB serial port.

The test sends setpoints on the console as a user does.  docs/emulator.md describes the computation of the motors.
"""

from __future__ import annotations

import math
import re

import pytest

from tests.doubles.rp2040.emulator import Emulator
from tests.platforms.pico.images import PLATFORMS, images, skip_unless_emulated

PAN_COUNT = math.pi / 1112
"""Angle of the camera for one count of the pan encoder, in rad."""
TILT_COUNT = math.pi / 2 / 221
AXES = {
    "pan": {"pins": (10, 11), "bridge": {"slice": 1, "channel": 0, "pinA": 7, "pinB": 8}, "stops": [0, math.pi]},
    "tilt": {"pins": (12, 13), "bridge": {"slice": 2, "channel": 0, "pinA": 5, "pinB": 6}, "stops": [0, math.pi / 2]},
}


def angle(pico: Emulator, axis: str) -> float:
    return float(pico.call("motor_state", name=axis)["angle"])


def statistics(said: str) -> dict[str, float]:
    return {name: float(value) for name, value in re.findall(r"^stat (\w+)=(\S+)\r?$", said, re.MULTILINE)}


@pytest.mark.parametrize(
    ("board", "platform"), [*(("pico", platform) for platform in PLATFORMS), ("pico_w", "freertos")]
)
def test_jiwy_homes_and_goes_where_it_is_told(board: str, platform: str) -> None:
    skip_unless_emulated(platform)
    elf = images(board, platform, "jiwy_firmware", middleware="console") / "jiwy_firmware.elf"
    with Emulator(elf, usb={"seed": 3}) as pico:
        for name, axis in AXES.items():
            a, b = axis["pins"]
            pico.call("encoder", name=name, a=a, b=b)
            where = {"bridge": axis["bridge"], "stops": axis["stops"], "angle": 0.5}
            pico.call("motor", name=name, encoder=name, axis=name, **where)
        pico.run(milliseconds=2000)
        assert angle(pico, "pan") == pytest.approx(0, abs=PAN_COUNT), "homed: at the end stop"
        assert angle(pico, "tilt") == pytest.approx(0, abs=TILT_COUNT)

        pico.send("pan_subscriber=1 tilt_subscriber=0.5\n")
        pico.run(milliseconds=1000)
        assert angle(pico, "pan") == pytest.approx(1, abs=2 * PAN_COUNT)
        assert angle(pico, "tilt") == pytest.approx(0.5, abs=2 * TILT_COUNT)

        pico.receive()
        pico.send("stats\n")
        pico.run(milliseconds=50)
        counted = statistics(pico.receive())
        assert counted["missed"] == counted["overruns"] == counted["faults"] == 0
        assert counted["cycles"] >= 2900
        for side in ("control", "communication"):
            used, size = counted[f"{side}_stack_used"], counted[f"{side}_stack_size"]
            assert 0 < used * 1.25 <= size, side


@pytest.mark.parametrize("platform", PLATFORMS)
def test_picotool_reboots_the_board(platform: str) -> None:
    """The request of `picotool reboot -f`: to the interface, of class RESET_REQUEST_FLASH."""
    skip_unless_emulated(platform)
    elf = images("pico", platform, "jiwy_firmware", middleware="console") / "jiwy_firmware.elf"
    with Emulator(elf, usb={"seed": 3}) as pico:
        pico.run(milliseconds=2000, configured=True)
        pico.run(milliseconds=20)
        pico.call("usb_control", type=0x21, request=0x02, index=2)
        state = pico.run(milliseconds=300)
        assert len(state["resets"]) == 1
        pico.run(milliseconds=2000, configured=True)
        pico.run(milliseconds=20)
        pico.receive()
        pico.send("stats\n")
        pico.run(milliseconds=50)
        assert "enabled=1 fault=none" in pico.receive(), "a reboot that was asked for is no fault"
