# SPDX-License-Identifier: Apache-2.0
"""Images of ``project/`` for a Nucleo board, built once and kept in EPG's cache."""

from __future__ import annotations

from pathlib import Path

from tests.doubles.toolchain import ROOT, arm_gcc, skip_if_missing, tool
from tests.platforms.firmware.builds import HERE as FIRMWARE
from tests.platforms.firmware.builds import PROCESSORS, build

HERE = Path(__file__).resolve().parent
PROJECT = HERE / "project"
PLATFORMS = ("bare_metal", "freertos")
PARTS = ("cmsis_core", "freertos_kernel", "micro_xrce_dds_client", "micro_cdr", "tinyusb")


def images(platform: str, middleware: str, board: str = "nucleo_h743zi") -> Path:
    """The folder with ``jiwy_firmware.elf`` and the other programs; skips without the tools."""
    series = board.removeprefix("nucleo_")[:2]
    parts = (f"cmsis_device_{series}", *PARTS)
    skip_if_missing(arm_gcc, *(lambda name=name: tool(name) for name in parts))
    # The project itself chooses its toolchain.
    values = {"EPG_PATH": str(ROOT), "BOARD": board, "PLATFORM": platform, "MIDDLEWARE": middleware}
    return build(PROCESSORS["host"], PROJECT, **values)


def host() -> Path:
    """The folder with ``jiwy_host`` and ``librobot.so``: JIWY with the PWM's steps of the STM32H743."""
    values = "clocks.pwm=200 MHz;control.enable_at_start=true"
    skip_if_missing(lambda: PROCESSORS["host"].tool("gcc"))
    bindings = str(HERE / "robot.bindings.yaml")
    return build(PROCESSORS["host"], FIRMWARE / "robot", VALUES=values, PLANT_BINDINGS=bindings)
